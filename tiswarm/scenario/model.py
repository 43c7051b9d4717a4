"""Model: what a trial is made of, loaded from a preset or a file, overridden, checked, with clear errors."""

import json
from collections.abc import Mapping, Sequence
from copy import deepcopy
from hashlib import sha256
from typing import Annotated, Any, Literal, NoReturn, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from tiswarm.scenario import checks
from tiswarm.scenario.errors import ScenarioError, explained
from tiswarm.scenario.measures import Measure
from tiswarm.strategies import registry
from tiswarm.system.words import did_you_mean

MOST_AGENTS = 4_000_000

LIMIT = 1e6
"""Largest magnitude of any length, speed or weight: products of a few of them still fit into single precision."""

Real = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LIMIT, le=LIMIT)]
NotNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0, le=LIMIT)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=1e-6, le=LIMIT)]
Count = Annotated[int, Field(strict=True, ge=0, le=MOST_AGENTS)]
Point = Annotated[tuple[Real, ...], Field(min_length=2, max_length=3)]


def _one_of(kind: registry.Kind) -> Any:
    """Let the schema name the strategies that there are; an unknown one gets its own complaint elsewhere."""
    return Field(json_schema_extra=lambda schema: schema.update(enum=list[Any](registry.names(kind))))


PreyStrategy = Annotated[str, _one_of("prey")]
PredatorsStrategy = Annotated[str, _one_of("predators")]
Avoidance = Annotated[str, _one_of("avoidance")]
Number = Annotated[Real, BeforeValidator(lambda value: float(value) if isinstance(value, bool) else value)]


class Weights(dict[str, float | str]):
    """A dictionary that never changes, so that a scenario is what it was when it was checked."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("weights are frozen; use scenario.replaced({'prey.weights.NAME': number})")

    __setitem__ = __delitem__ = update = setdefault = pop = popitem = clear = __ior__ = _refuse

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(sorted(self.items())))

    def __reduce__(self) -> tuple[Any, ...]:
        return Weights, (dict(self),)


class Part(BaseModel):
    """A frozen part of a scenario that knows no keys but its own."""

    model_config = ConfigDict(frozen=True, extra="forbid")


def _ordered(low: Sequence[float], high: Sequence[float], what: str) -> None:
    if any(a > b for a, b in zip(low, high, strict=False)):
        raise ValueError(f"{what} must run from a lower to an upper corner, [[x0, y0], [x1, y1]] with x0 <= x1 and y0 <= y1")
    if len(low) != len(high):
        raise ValueError(f"{what} has corners of {len(low)} and {len(high)} numbers")


class Box(Part):
    """An axis-parallel rectangle or cuboid, written as its two corners [[x0, y0], [x1, y1]]."""

    low: Point
    high: Point

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> dict[str, Any]:
        corner = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 3}
        return {"title": "Box", "description": cls.__doc__, "type": "array", "items": corner, "minItems": 2, "maxItems": 2}

    @model_validator(mode="before")
    @classmethod
    def _from_corners(cls, value: Any) -> Any:
        if isinstance(value, Sequence) and not isinstance(value, str):
            if len(value) != 2:
                raise ValueError("a region is two corners, [[x0, y0], [x1, y1]]")
            return {"low": value[0], "high": value[1]}
        return value

    @model_validator(mode="after")
    def _check(self) -> Self:
        _ordered(self.low, self.high, "a region")
        return self


class Area(Part):
    """A labelled part of the world that a film tints, such as the thesis's danger area."""

    label: str
    region: Box


class World(Part):
    """Size, time and edge of the world, and what a touch does; two sizes make it flat, three deep."""

    size: Annotated[tuple[Positive, ...], Field(min_length=2, max_length=3)] = (100.0, 50.0)  # m; a corner is the origin
    ticks: Annotated[int, Field(strict=True, ge=1, le=1_000_000)] = 250  # a trial ends here at the latest
    dt: Positive = 1.0  # s
    scheme: Literal["euler", "verlet"] = "euler"  # semi-implicit Euler, or drift, kick, drift
    boundary: Literal["open", "periodic", "walls"] = "open"
    wrap_sight: bool = True  # whether agents see across a periodic edge
    margin: NotNegative = 0.0  # nearer to a wall than this, agents turn away from it [m]
    turn_factor: NotNegative = 0.0  # velocity that a tick inside the margin adds [m/s]
    # What a touch does: predator and prey both die, only the prey does, prey bounce off each other, or nothing.
    contact: Literal["deadly", "eaten", "bounce", "none"] = "deadly"
    # How agents find their neighbours: by comparing all pairs, through a grid, or whichever is faster for so many.
    neighbours: Literal["auto", "all-pairs", "grid"] = "auto"
    areas: tuple[Area, ...] = ()

    @property
    def dim(self) -> int:
        """Count the dimensions."""
        return len(self.size)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.boundary != "walls" and (self.margin or self.turn_factor):
            raise ValueError("a world has margin and turn_factor only with boundary = 'walls'; drop them or set it")
        return self


class Target(Part):
    """The disc that prey want to reach."""

    present: bool = True
    position: Point = (10.0, 25.0)  # m
    radius: Positive = 4.0  # m


class Obstacles(Part):
    """Discs or spheres; each trial has its own."""

    count: Count = 0
    radius: tuple[NotNegative, NotNegative] = (1.0, 2.0)  # m, uniform in this range
    region: Box = Box(low=(17.5, 0.0), high=(70.0, 50.0))
    clear: bool = False  # whether they keep off the target and the region where prey start
    contact: Literal["crash", "count"] = "crash"  # touching one kills, or is only counted (measure "hits")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.radius[0] > self.radius[1]:
            raise ValueError("radius must be [smallest, largest]")
        return self


class Spawn(Part):
    """Where agents start and how fast, uniform in both boxes."""

    region: Box
    velocity: Box = Box(low=(0.0, 0.0), high=(1.0, 1.0))
    shape: Literal["box", "ball"] = "box"  # ball: in the largest ellipsoid inside the region
    capped: bool = False  # whether max_speed holds from the start


class Agents(Part):
    """What prey and predators have in common."""

    count: Count
    strategy: str
    avoidance: Avoidance
    radius: NotNegative  # m
    perception: NotNegative  # m
    spacing: NotNegative = 3.0  # m, closer mates are separated from
    max_speed: Positive = 1.0  # m/s
    min_speed: NotNegative = 0.0  # m/s
    drive: Literal["point", "unicycle"] = "point"  # unicycle: a point `ahead` of the axle follows the commanded velocity
    ahead: Positive = 0.05  # m
    max_turn: Positive = 3.636  # rad/s
    cohesion: Real = 0.005  # 1/s
    separation: Real = 0.05  # 1/s
    alignment: Real = 0.05  # 1/s
    goal: Real = 0.1  # prey: pull of the target [1/s]; predators: pull of what they pursue
    spawn: Spawn
    weights: Annotated[dict[str, Number | str], AfterValidator(Weights)] = Field(
        default_factory=Weights
    )  # of the strategy and of the avoidance


def _with_weights(agents: dict[str, Any], kind: registry.Side) -> dict[str, Any]:
    """Check both strategy names and fill in the weights that a scenario leaves at their defaults."""
    known: dict[str, float | str] = {}
    words: dict[str, tuple[Any, ...]] = {}
    for key, where in registry.catalogues(kind):
        name = agents.get(key)
        if not isinstance(name, str):
            continue  # pydantic says what is wrong
        try:
            known.update(registry.defaults(where, name))
            words.update(registry.choices(where, name))
        except registry.UnknownStrategy as error:
            raise ScenarioError(f"{kind}.{key}: {error}") from None
    given = agents.get("weights", {})
    if not isinstance(given, Mapping):
        return agents
    for key in given:
        if key not in known:
            chosen = f"strategy '{agents.get('strategy')}' with avoidance '{agents.get('avoidance')}'"
            hint = did_you_mean(str(key), sorted(known)) if known else "they have none"
            raise ScenarioError(f"{kind}.weights.{key}: no weight of {chosen}; {hint}")
        if key in words and given[key] not in words[key]:
            hint = " or ".join(repr(word) for word in words[key])
            raise ScenarioError(f"{kind}.weights.{key}: {given[key]!r} is not allowed; use {hint}")
        if key not in words and isinstance(given[key], str):
            raise ScenarioError(f"{kind}.weights.{key}: {given[key]!r} is not allowed; use a number")
    return {**agents, "weights": {**known, **given}}


class Prey(Agents):
    """The swarm that wants to arrive."""

    count: Annotated[int, Field(strict=True, ge=1, le=MOST_AGENTS)] = 6
    strategy: PreyStrategy = "baseline"
    avoidance: Avoidance = "none"
    radius: NotNegative = 0.5
    perception: NotNegative = 30.0
    spawn: Spawn = Spawn(region=Box(low=(80.0, 30.0), high=(88.0, 38.0)))


class Predators(Agents):
    """The swarm that crashes into prey."""

    count: Count = 0
    strategy: PredatorsStrategy = "centre"
    avoidance: Avoidance = "repel"
    radius: NotNegative = 0.25
    perception: NotNegative = 5.0
    spawn: Spawn = Spawn(region=Box(low=(10.0, -7.5), high=(18.0, 0.5)))


class Coverage(Part):
    """The grid on which swept ground is counted."""

    cell: NotNegative = 0.0  # side of a cell [m]; 0: not counted
    tool: Positive = 0.1  # radius of the disc that an agent sweeps [m]


class Measures(Part):
    """What is measured while a trial runs, beyond who arrived: see `recorded.py`, and `deadlocks.py` for who is trapped."""

    names: tuple[Measure, ...] = ()
    after: Annotated[int, Field(strict=True, ge=0)] = 0  # means are over the states from this tick on, the last one at least
    distance: Positive = 1.0  # agents nearer than this are of one group [m]
    # Trapped is who for `window` ticks stays `within` a distance of where it was [m] on a way of `path` metres or more.
    window: Annotated[int, Field(strict=True, ge=1, le=1_000_000)] = 40
    within: Positive = 4.0
    path: Positive = 20.0


class Showcase(Part):
    """The trial that `tiswarm demo` films."""

    seed: Annotated[int, Field(strict=True, ge=0)] = 0
    trial: Annotated[int, Field(strict=True, ge=0)] = 0


class Scenario(Part):
    """A whole scenario: everything that a trial needs but its seed and number."""

    preset: str = ""  # what it was loaded from; a file's name without its folder
    title: str = "Untitled"
    source: str = ""
    showcase: Showcase = Showcase()
    world: World = World()
    target: Target = Target()
    obstacles: Obstacles = Obstacles()
    prey: Prey = Prey()
    predators: Predators = Predators()
    coverage: Coverage = Coverage()
    measures: Measures = Measures()

    @model_validator(mode="before")
    @classmethod
    def _fill_weights(cls, value: Any) -> Any:
        if not isinstance(value, Mapping):
            return value
        filled = dict(value)
        for kind, model in (("prey", Prey), ("predators", Predators)):
            given = filled.get(kind, {})
            if isinstance(given, Mapping):
                chosen = {key: model.model_fields[key].default for key in ("strategy", "avoidance")}
                filled[kind] = _with_weights({**chosen, **given}, kind)  # type: ignore[arg-type]
        return filled

    @model_validator(mode="after")
    def _fits_the_world(self) -> Self:
        checks.check(self)
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> dict[str, Any]:
        """Let presets take from a base, and name the strategies that there are."""
        schema = handler.resolve_ref_schema(handler(core_schema))
        schema["properties"]["base"] = {"type": "string", "description": "A preset that this one changes."}
        return schema

    def to_json(self) -> str:
        """Write the scenario as JSON, keys in a fixed order."""
        return json.dumps(_plain(self), sort_keys=True)

    @classmethod
    def from_json(cls, text: str) -> "Scenario":
        """Read what `to_json` wrote. Errors: ScenarioError."""
        try:
            return validated(json.loads(text))
        except (json.JSONDecodeError, RecursionError) as error:
            raise ScenarioError(f"scenario: not valid JSON: {error}") from None

    def to_toml(self) -> str:
        """Write the scenario as a preset, defaults filled in."""
        import tomlkit

        return tomlkit.dumps(_plain(self))

    def hash(self) -> str:
        """Name the scenario by what it computes: its preset, title, source and showcase do not count."""
        plain = {key: value for key, value in _plain(self).items() if key not in ("preset", "title", "source", "showcase")}
        return sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()[:16]

    def numbers(self) -> dict[str, float]:
        """Map the path of each number to it: "prey.weights.evade", "target.position.0", ...; a choice is its place."""
        found = {path: float(value) for path, value in _leaves(_plain(self)) if _is_number(path, value)}
        for side, _, catalogue, name in registry.roles(self):
            weights = getattr(self, side).weights
            words = registry.choices(catalogue, name)
            found |= {f"{side}.weights.{key}": float(known.index(weights[key])) for key, known in words.items()}
        return found

    def replaced(self, overrides: Mapping[str, Any]) -> "Scenario":
        """Give the scenario with some keys changed. Errors: ScenarioError."""
        return validated(overridden(_plain(self), overrides))


def _plain(value: Any) -> Any:
    """Turn parts into the lists and tables that a preset writes."""
    if isinstance(value, Box):
        return [list(value.low), list(value.high)]
    if isinstance(value, Part):
        return {key: _plain(getattr(value, key)) for key in type(value).model_fields}
    if isinstance(value, Weights):
        return dict(value)
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    return value


def _is_number(path: str, value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and not path.startswith(("showcase.", "world.areas."))


def _leaves(value: Any, path: str = "") -> list[tuple[str, Any]]:
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if items is None:
        return [(path, value)]
    return [leaf for key, each in items for leaf in _leaves(each, f"{path}.{key}" if path else str(key))]


def validated(table: dict[str, Any]) -> Scenario:
    """Build a scenario from a table as presets write it. Errors: ScenarioError."""
    try:
        return Scenario.model_validate(table)
    except ValidationError as error:
        raise ScenarioError(explained(error, Scenario)) from None


def overridden(table: dict[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Change keys of a table; with another strategy or avoidance, weights that it does not know go.

    Errors: ScenarioError.
    """
    out = deepcopy(table)
    for path, value in overrides.items():
        *above, last = path.split(".")
        place: Any = out
        for key in above:
            place = place[_index(place, key, path)] if isinstance(place, list) else place.setdefault(key, {})
            if not isinstance(place, dict | list):
                raise ScenarioError(f"{path}: '{key}' holds a value, not a table")
        plain = value.tolist() if hasattr(value, "tolist") else value  # NumPy's numbers and arrays
        place[_index(place, last, path) if isinstance(place, list) else last] = plain
    kind: registry.Side
    for kind in ("prey", "predators"):
        if f"{kind}.strategy" in overrides or f"{kind}.avoidance" in overrides:
            _drop_stale_weights(out, kind, overrides)
    return out


def _drop_stale_weights(table: dict[str, Any], kind: registry.Side, overrides: Mapping[str, Any]) -> None:
    agents = table.get(kind)
    if not isinstance(agents, dict):
        return  # the check of the whole scenario says what is wrong
    weights = agents.get("weights")
    chosen = [(catalogue, agents.get(role, "")) for role, catalogue in registry.catalogues(kind)]
    known = all(name in registry.names(catalogue) for catalogue, name in chosen)
    if isinstance(weights, dict) and known and f"{kind}.weights" not in overrides:
        kept = {key for catalogue, name in chosen for key in registry.defaults(catalogue, name)}
        agents["weights"] = {
            key: value for key, value in weights.items() if key in kept or f"{kind}.weights.{key}" in overrides
        }


def _index(items: list[Any], key: str, path: str) -> int:
    if not (key.isascii() and key.isdecimal()) or int(key) >= len(items):
        places = f"use 0 to {len(items) - 1}" if items else "it is empty"
        raise ScenarioError(f"{path}: '{key}' is no place in a list of {len(items)}; {places}")
    return int(key)
