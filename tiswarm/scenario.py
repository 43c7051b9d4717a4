"""Scenario: what a trial is made of, loaded from a preset or a file, overridden, checked, with clear errors."""

import json
import os
import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from tiswarm import registry
from tiswarm.explain import ScenarioError, explained

LIMIT = 1e6
"""Largest magnitude of any length, speed or weight: products of a few of them still fit into single precision."""

Real = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LIMIT, le=LIMIT)]
NotNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0, le=LIMIT)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=1e-6, le=LIMIT)]
Count = Annotated[int, Field(strict=True, ge=0, le=10_000)]
Point = tuple[Real, Real]
Number = Annotated[float, BeforeValidator(lambda value: float(value) if isinstance(value, bool) else value), *Real.__metadata__]


class Part(BaseModel):
    """A frozen part of a scenario that knows no keys but its own."""

    model_config = ConfigDict(frozen=True, extra="forbid")


def _ordered(low: Sequence[float], high: Sequence[float], what: str) -> None:
    if any(a > b for a, b in zip(low, high, strict=True)):
        raise ValueError(f"{what} must run from a lower to an upper corner, [[x0, y0], [x1, y1]] with x0 <= x1 and y0 <= y1")


class Box(Part):
    """An axis-parallel rectangle, written as its two corners [[x0, y0], [x1, y1]]."""

    low: Point
    high: Point

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
    """Size, time and edge of the world."""

    size: tuple[Positive, Positive] = (100.0, 50.0)  # m
    ticks: Annotated[int, Field(strict=True, ge=1, le=1_000_000)] = 250  # a trial ends here at the latest
    dt: Positive = 1.0  # s
    boundary: Literal["open"] = "open"
    areas: tuple[Area, ...] = ()


class Target(Part):
    """The disc that prey want to reach."""

    position: Point = (10.0, 25.0)  # m
    radius: Positive = 4.0  # m


class Obstacles(Part):
    """Discs that kill; each trial has its own."""

    count: Count = 0
    radius: tuple[NotNegative, NotNegative] = (1.0, 2.0)  # m, uniform in this range
    region: Box = Box(low=(17.5, 0.0), high=(70.0, 50.0))

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.radius[0] > self.radius[1]:
            raise ValueError("radius must be [smallest, largest]")
        return self


class Spawn(Part):
    """Where agents start and how fast, uniform in both boxes."""

    region: Box
    velocity: Box = Box(low=(0.0, 0.0), high=(1.0, 1.0))


class Agents(Part):
    """What prey and predators have in common."""

    count: Count
    strategy: str
    avoidance: str
    radius: NotNegative  # m
    perception: NotNegative  # m
    spacing: NotNegative = 3.0  # m, closer mates are separated from
    max_speed: Positive = 1.0  # m/s
    cohesion: Real = 0.005  # 1/s
    separation: Real = 0.05  # 1/s
    alignment: Real = 0.05  # 1/s
    goal: Real = 0.1  # prey: pull of the target [1/s]; predators: pull of what they pursue
    spawn: Spawn
    weights: dict[str, Number] = {}  # numbers of the strategy and of the avoidance


def _with_weights(agents: dict[str, Any], kind: registry.Kind) -> dict[str, Any]:
    """Check both strategy names and fill in the weights that a scenario leaves at their defaults."""
    known: dict[str, float] = {}
    for key, where in (("strategy", kind), ("avoidance", "avoidance")):
        name = agents.get(key)
        if not isinstance(name, str):
            continue  # pydantic says what is wrong
        try:
            known.update(registry.defaults(where, name))
        except registry.UnknownStrategy as error:
            raise ScenarioError(f"{kind}.{key}: {error}") from None
    given = agents.get("weights", {})
    if not isinstance(given, Mapping):
        return agents
    for key in given:
        if key not in known:
            chosen = f"strategy '{agents.get('strategy')}' with avoidance '{agents.get('avoidance')}'"
            hint = registry.nearest(str(key), sorted(known)) if known else "they have none"
            raise ScenarioError(f"{kind}.weights.{key}: no weight of {chosen}; {hint}")
    return {**agents, "weights": {**known, **given}}


class Prey(Agents):
    """The swarm that wants to arrive."""

    count: Annotated[int, Field(strict=True, ge=1, le=10_000)] = 6
    strategy: str = "baseline"
    avoidance: str = "none"
    radius: NotNegative = 0.5
    perception: NotNegative = 30.0
    spawn: Spawn = Spawn(region=Box(low=(80.0, 30.0), high=(88.0, 38.0)))


class Predators(Agents):
    """The swarm that crashes into prey."""

    count: Count = 0
    strategy: str = "centre"
    avoidance: str = "repel"
    radius: NotNegative = 0.25
    perception: NotNegative = 5.0
    spawn: Spawn = Spawn(region=Box(low=(10.0, -7.5), high=(18.0, 0.5)))


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

    def to_json(self) -> str:
        """Write the scenario as JSON, keys in a fixed order."""
        return json.dumps(_plain(self), sort_keys=True)

    @classmethod
    def from_json(cls, text: str) -> "Scenario":
        """Read what `to_json` wrote. Errors: ScenarioError."""
        return _validated(json.loads(text))

    def to_toml(self) -> str:
        """Write the scenario as a preset, defaults filled in."""
        import tomlkit

        return tomlkit.dumps(_plain(self))

    def hash(self) -> str:
        """Name the scenario by what it computes: its preset, title, source and showcase do not count."""
        plain = {key: value for key, value in _plain(self).items() if key not in ("preset", "title", "source", "showcase")}
        return sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()[:16]

    def numbers(self) -> dict[str, float]:
        """Map the path of each numeric key to its value: "prey.weights.evade", "target.position.0", ..."""
        return {path: float(value) for path, value in _leaves(_plain(self)) if _is_number(path, value)}

    def replaced(self, overrides: Mapping[str, Any]) -> "Scenario":
        """Give the scenario with some keys changed. Errors: ScenarioError."""
        return _validated(_overridden(_plain(self), overrides))


def _plain(value: Any) -> Any:
    """Turn parts into the lists and tables that a preset writes."""
    if isinstance(value, Box):
        return [list(value.low), list(value.high)]
    if isinstance(value, Part):
        return {key: _plain(getattr(value, key)) for key in type(value).model_fields}
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    return value


def _is_number(path: str, value: Any) -> bool:
    return isinstance(value, int | float) and not path.startswith(("showcase.", "world.areas."))


def _leaves(value: Any, path: str = "") -> list[tuple[str, Any]]:
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if items is None:
        return [(path, value)]
    return [leaf for key, each in items for leaf in _leaves(each, f"{path}.{key}" if path else str(key))]


def load(preset: str | os.PathLike, overrides: Mapping[str, Any] | None = None) -> Scenario:
    """Load a preset by name or a TOML file by path, and change some of its keys.

    overrides: dotted path -> value, as in {"prey.strategy": "evasive", "obstacles.region.0.0": 20}.

    Errors: ScenarioError, one line that names the key, the value and what is allowed.
    """
    name = os.fspath(preset)
    file = find(name)
    known = {path: each for each, path in presets().items()}
    return _validated(_overridden({**_table(name), "preset": known.get(file, file.name)}, overrides or {}))


def _validated(table: dict[str, Any]) -> Scenario:
    try:
        return Scenario.model_validate(table)
    except ValidationError as error:
        raise ScenarioError(explained(error, Scenario)) from None


def _table(preset: str, above: tuple[str, ...] = ()) -> dict[str, Any]:
    """Read a preset's TOML, with what it takes from its base."""
    if preset in above:
        raise ScenarioError(f"base: {' -> '.join((*above, preset))} is a circle; drop one 'base' key")
    table = read_toml(find(preset))
    base = table.pop("base", None)
    if base is None:
        return table
    if not isinstance(base, str):
        raise ScenarioError(f"base: {base!r} is not a preset's name")
    return _merged(_table(base, (*above, preset)), table)


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file. Errors: ScenarioError."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"{path}: not valid TOML: {error}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: cannot be read: {error}") from None


def _merged(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    out = dict(below)
    for key, value in above.items():
        both = isinstance(value, dict) and isinstance(out.get(key), dict)
        out[key] = _merged(out[key], value) if both else value
    return out


def _overridden(table: dict[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    out = json.loads(json.dumps(table))
    for path, value in overrides.items():
        *above, last = path.split(".")
        place: Any = out
        for key in above:
            place = place[_index(place, key, path)] if isinstance(place, list) else place.setdefault(key, {})
            if not isinstance(place, dict | list):
                raise ScenarioError(f"{path}: '{key}' holds a value, not a table")
        place[_index(place, last, path) if isinstance(place, list) else last] = value
    return out


def _index(items: list[Any], key: str, path: str) -> int:
    if not key.isdigit() or int(key) >= len(items):
        raise ScenarioError(f"{path}: '{key}' is no place in a list of {len(items)}; use 0 to {len(items) - 1}")
    return int(key)


def preset_folder() -> Path:
    """Find the presets: inside an installed wheel, or beside the package in a checkout."""
    package = Path(__file__).parent
    inside = package / "presets"
    return inside if inside.is_dir() else package.parent / "presets"


@cache
def presets() -> dict[str, Path]:
    """Map preset names (studies left out) to their files."""
    folder = preset_folder()
    found = {file.relative_to(folder).with_suffix("").as_posix(): file for file in sorted(folder.glob("*/*.toml"))}
    return {name: file for name, file in found.items() if not name.startswith("studies/")}


def study_names() -> list[str]:
    """List the studies that ship with tiswarm."""
    return sorted(file.stem for file in (preset_folder() / "studies").glob("*.toml"))


def find(preset: str) -> Path:
    """Find a preset's file: a path, a full name, or the plain name of a demo. Errors: ScenarioError."""
    if preset.endswith(".toml"):
        return Path(preset)
    known = presets()
    file = known.get(preset) or known.get(f"demo/{preset}")
    if file is None:
        hint = registry.nearest(preset, list(known))
        raise ScenarioError(f"preset: unknown '{preset}'; {hint} (list them with 'tiswarm presets')")
    return file
