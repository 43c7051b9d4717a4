"""Model: what a trial is made of, loaded from a preset or a file, overridden, checked, with clear errors."""

import json
from collections.abc import Mapping
from hashlib import sha256
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from tiswarm.scenario import checks, network
from tiswarm.scenario.agents import Predators, Prey, with_weights
from tiswarm.scenario.barrier import Barrier
from tiswarm.scenario.errors import ScenarioError, explained
from tiswarm.scenario.measures import Measure, Shown
from tiswarm.scenario.overrides import overridden
from tiswarm.scenario.parts import (
    Box,
    Count,
    NotNegative,
    Part,
    Point,
    Positive,
    is_number,
    leaves,
    plain,
)
from tiswarm.scenario.picture import card_of
from tiswarm.scenario.planning import Planning
from tiswarm.scenario.rewards import Rewards
from tiswarm.scenario.words import KINDS, Words, titled
from tiswarm.space import box
from tiswarm.space.box import Boundary
from tiswarm.strategies import registry


class Area(Part):
    """A labelled part of the world that a film tints, such as the thesis's danger area."""

    label: str  # what the film writes there
    region: Box  # m, what is tinted


class World(Part):
    """Size, time and edge of the world, and what a touch does; two sizes make it flat, three deep."""

    size: Annotated[tuple[Positive, ...], Field(min_length=2, max_length=3)] = (100.0, 50.0)  # m; a corner is the origin
    ticks: Annotated[int, Field(strict=True, ge=1, le=1_000_000)] = 250  # a trial ends here at the latest
    dt: Positive = 1.0  # s, how long a tick is
    # What gains, fields and strategies add to a velocity is meant a tick, however long, or a second: halving dt then converges.
    gains: Literal["per-tick", "per-second"] = "per-tick"
    scheme: Literal["euler", "verlet"] = "euler"  # semi-implicit Euler, or drift, kick, drift
    boundary: Boundary = "open"  # disc: the largest circle, or sphere, in the box reflects whoever comes to it
    wrap_sight: bool = True  # whether agents see across a periodic edge
    margin: NotNegative = 0.0  # nearer to a wall than this, agents turn away from it [m]
    turn_factor: NotNegative = 0.0  # velocity that a tick inside the margin adds [m/s]
    # What a touch does: predator and prey both die, only the prey does, prey bounce off each other, or nothing.
    contact: Literal["deadly", "eaten", "bounce", "none"] = "deadly"
    # When a touch counts: at places after a move, or wherever bodies come closest within a tick on straight ways.
    contact_test: Literal["places", "swept"] = "swept"
    # How agents find their neighbours: by comparing all pairs, through a grid, or whichever is faster for so many.
    neighbours: Literal["auto", "all-pairs", "grid"] = "auto"
    areas: tuple[Area, ...] = ()  # what films tint; no agent knows of them

    @property
    def dim(self) -> int:
        """Count the dimensions."""
        return len(self.size)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not box.walled(self.boundary) and (self.margin or self.turn_factor):
            raise ValueError("a world has margin and turn_factor only with boundary = 'walls'; drop them or set it")
        return self


class Target(Part):
    """The disc that prey want to reach."""

    present: bool = True  # whether there is one
    position: Point = (10.0, 25.0)  # m, of its centre
    radius: Positive = 4.0  # m, of the disc or sphere


class Obstacles(Part):
    """Discs or spheres; each trial has its own."""

    count: Count = 0  # how many a trial has
    radius: tuple[NotNegative, NotNegative] = (1.0, 2.0)  # m, uniform in this range
    region: Box = Box(low=(17.5, 0.0), high=(70.0, 50.0))  # m, where their centres lie
    clear: bool = False  # whether they keep off the target and the region where prey start
    contact: Literal["crash", "count"] = "crash"  # touching one kills, or is only counted (measure "hits")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.radius[0] > self.radius[1]:
            raise ValueError("radius must be [smallest, largest]")
        return self


class Coverage(Part):
    """The grid on which swept ground is counted."""

    cell: NotNegative = 0.0  # side of a cell [m]; 0: not counted
    tool: Positive = 0.1  # radius of the disc that an agent sweeps [m]


class Measures(Part):
    """What is measured while a trial runs, beyond who arrived: see `recorded.py`, and `deadlocks.py` for who is trapped."""

    names: tuple[Measure, ...] = ()  # what is measured
    after: Annotated[int, Field(strict=True, ge=0)] = 0  # means are over the states from this tick on, the last one at least
    distance: Positive = 1.0  # agents nearer than this are of one group [m]
    # Trapped is who for `window` ticks stays `within` a distance of where it was [m] on a way of `path` metres or more.
    window: Annotated[int, Field(strict=True, ge=1, le=1_000_000)] = 40
    within: Positive = 4.0  # m, see `window`
    path: Positive = 20.0  # m, see `window`


class Film(Part):
    """What a film says beyond who lives."""

    measures: Annotated[tuple[Shown, ...], Field(max_length=3)] = ()  # what its caption tells, up to three


class Showcase(Part):
    """The trial that `tiswarm demo` films."""

    seed: Annotated[int, Field(strict=True, ge=0)] = 0  # of all its random numbers
    trial: Annotated[int, Field(strict=True, ge=0)] = 0  # its number


UNCOUNTED = ("preset", "title", "source", "words", "film", "showcase", "rewards")
"""Keys of a scenario that change nothing of what it computes."""


class Scenario(Part):
    """A whole scenario: everything that a trial needs but its seed and number."""

    preset: str = ""  # what it was loaded from; a file's name without its folder
    template: str = Field("Untitled", alias="title", description="what it is, in a line that may count its agents")
    source: str = ""  # where it comes from
    words: Words = Words()
    film: Film = Film()
    showcase: Showcase = Showcase()
    world: World = World()
    target: Target = Target()
    obstacles: Obstacles = Obstacles()
    prey: Prey = Prey()
    predators: Predators = Predators()
    planning: Planning = Planning()
    barrier: Barrier = Barrier()
    coverage: Coverage = Coverage()
    measures: Measures = Measures()
    rewards: Rewards = Rewards()

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
                filled[kind] = with_weights({**chosen, **given}, kind)  # type: ignore[arg-type]
        return filled

    @model_validator(mode="after")
    def _fits_the_world(self) -> Self:
        checks.check(self)
        assert self.title is not None  # one that cannot be filled in is told now
        return self

    @property
    def title(self) -> str:
        """Give the title, its counts filled in."""
        return titled(self.template, self.words, {kind: getattr(self, kind).count for kind in KINDS})

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> dict[str, Any]:
        """Let presets take from a base, and name the strategies that there are."""
        schema = super().__get_pydantic_json_schema__(core_schema, handler)
        schema["properties"]["base"] = {"type": "string", "description": "A preset that this one changes."}
        return schema

    def to_json(self) -> str:
        """Write the scenario as JSON, keys in a fixed order."""
        return json.dumps(plain(self), sort_keys=True)

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

        return tomlkit.dumps(plain(self))

    def hash(self) -> str:
        """Name the scenario by what it computes: its preset, title and the like do not count."""
        told = {key: value for key, value in plain(self).items() if key not in UNCOUNTED}
        for kind in ("prey", "predators"):
            steered = self.network(kind)
            if steered is not None:
                told[kind]["weights"]["network"] = steered.digest
        return sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:16]

    def network(self, kind: str) -> network.Network | None:
        """Give the network that steers the prey or the predators, None without one. Errors: ScenarioError."""
        agents = self.prey if kind == "prey" else self.predators
        side: registry.Kind = "prey" if kind == "prey" else "predators"
        if not any(registry.load(side, part).networked for part in registry.parts(side, agents.strategy)):
            return None
        try:
            return network.read(str(agents.weights["network"]))
        except ScenarioError as error:
            raise ScenarioError(f"{kind}.weights.network: {error}") from None

    def numbers(self) -> dict[str, float]:
        """Map the path of each number to it: "prey.weights.evade", "target.position.0", ...; a choice is its place."""
        found = {path: float(value) for path, value in leaves(plain(self)) if is_number(path, value)}
        for side, _, catalogue, name in registry.roles(self):
            weights = getattr(self, side).weights
            words = registry.choices(catalogue, name)
            found |= {f"{side}.weights.{key}": float(known.index(weights[key])) for key, known in words.items()}
        return found

    def _repr_html_(self) -> str:
        return card_of(self)

    def replaced(self, overrides: Mapping[str, Any]) -> "Scenario":
        """Give the scenario with some keys changed. Errors: ScenarioError."""
        return validated(overridden(plain(self), overrides))


def validated(table: dict[str, Any]) -> Scenario:
    """Build a scenario from a table as presets write it. Errors: ScenarioError."""
    try:
        return Scenario.model_validate(table)
    except ValidationError as error:
        raise ScenarioError(explained(error, Scenario)) from None
