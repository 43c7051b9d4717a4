"""Agents: what prey and predators have, where they start, and the weights of their strategies."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.parts import (
    MOST_AGENTS,
    Box,
    Count,
    Degrees,
    Nearest,
    NotNegative,
    Number,
    Part,
    Positive,
    Real,
    Weights,
)
from tiswarm.strategies import registry
from tiswarm.system.words import did_you_mean


def _one_of(kind: registry.Kind) -> Any:
    """Let the schema name the strategies that there are; an unknown one gets its own complaint elsewhere."""
    return Field(json_schema_extra=lambda schema: schema.update(enum=list[Any](registry.names(kind))))


PreyStrategy = Annotated[str, _one_of("prey")]
PredatorsStrategy = Annotated[str, _one_of("predators")]
Avoidance = Annotated[str, _one_of("avoidance")]


class Spawn(Part):
    """Where agents start and how fast, uniform in both boxes."""

    region: Box  # m, where they start
    velocity: Box = Box(low=(0.0, 0.0), high=(1.0, 1.0))  # m/s, how fast
    shape: Literal["box", "ball"] = "box"  # ball: in the largest ellipsoid inside the region
    capped: bool = False  # whether max_speed holds from the start
    apart: NotNegative = 0.0  # m, the least distance of two at the start, where so many find room


class Agents(Part):
    """What prey and predators have in common."""

    count: Count  # how many
    strategy: str  # how they steer, a name from `tiswarm presets`
    avoidance: Avoidance  # how they keep off obstacles, a name from `tiswarm presets`
    radius: NotNegative  # m, of a body
    perception: NotNegative  # m, how far they see
    field_of_view: Degrees = 360.0  # centred on the velocity; mates and opponents outside it are not seen
    nearest: Nearest = "all"  # how many of the mates in sight count, the nearest ones
    spacing: NotNegative = 3.0  # m, closer mates are separated from
    max_speed: Positive = 1.0  # m/s, nobody is faster
    min_speed: NotNegative = 0.0  # m/s, nobody is slower
    drive: Literal["point", "unicycle"] = "point"  # unicycle: a point `ahead` of the axle follows the commanded velocity
    ahead: Positive = 0.05  # m, from the axle to the point that follows
    max_turn: Positive = 3.636  # rad/s, no unicycle turns faster
    # Gains add to the velocity in every tick; under world.gains = "per-second" they are divided by s once more.
    cohesion: Real = 0.005  # of the way to the mates' centre [1/s a tick]
    separation: Real = 0.05  # of the sum of ways from mates within `spacing` [1/s a tick]
    alignment: Real = 0.05  # of the difference to the mates' velocity [1/tick]
    goal: Real = 0.1  # prey: of the way to the target; predators: of the way to what they pursue [1/s a tick]
    spawn: Spawn  # where they start, and how fast
    weights: Annotated[dict[str, Number | str], AfterValidator(Weights)] = Field(
        default_factory=Weights
    )  # of the strategy and of the avoidance


def with_weights(agents: dict[str, Any], kind: registry.Side) -> dict[str, Any]:
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
        filed = isinstance(known[key], str) and key not in words  # the name of a file
        if filed and not isinstance(given[key], str):
            raise ScenarioError(f"{kind}.weights.{key}: {given[key]!r} is not allowed; name a file")
        if key not in words and not filed and isinstance(given[key], str):
            raise ScenarioError(f"{kind}.weights.{key}: {given[key]!r} is not allowed; use a number")
    return {**agents, "weights": {**known, **given}}


class Prey(Agents):
    """The swarm that wants to arrive."""

    count: Annotated[int, Field(strict=True, ge=1, le=MOST_AGENTS)] = 6
    strategy: PreyStrategy = "baseline"
    avoidance: Avoidance = "none"
    # What `goal` weighs: the whole straight way to the target [1/s a tick], or a planned way's direction [m/s a tick].
    goal_by: Literal["line", "path"] = "line"
    safety: Literal["none", "barrier"] = "none"  # barrier: commands are corrected so that nobody comes too near another
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
