"""Choice: whether a scenario's agents find each other by comparing all pairs or through a grid, and how far they look."""

from math import hypot, prod
from typing import Any

from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.space import box
from tiswarm.strategies import registry

CROSSOVER = 400
"""With so many prey out of each other's reach a grid is faster than comparing all pairs (tests/benchmarks/crossover.py)."""

ALWAYS = 1600
"""With so many prey it is faster even where everybody is in reach: its lanes are one trial's agents."""

MOST_PAIRED = 10_000
"""Comparing all pairs of more agents than this takes longer than anybody waits."""


def engine_of(scenario: Scenario) -> str:
    """Name the engine that runs a scenario: "grid" or "all-pairs". Errors: as of by_grid."""
    return "grid" if by_grid(scenario) else "all-pairs"


def reason_of(scenario: Scenario) -> str:
    """Say in a few words why `engine_of` names that engine. Errors: as of by_grid."""
    gridded, refused = by_grid(scenario), _refused(scenario)
    if scenario.world.neighbours != "auto":
        return f"world.neighbours = '{scenario.world.neighbours}'"
    if gridded:
        most = max(scenario.prey.count, scenario.predators.count, scenario.obstacles.count)
        return f"{most:,} agents" if most >= ALWAYS else f"{most:,} agents, most of them out of each other's reach"
    if _pays(scenario):
        return f"{refused} = {_told(scenario, refused)!r} compares all pairs"
    return "few agents, or most in each other's reach"


def by_grid(scenario: Scenario) -> bool:
    """Tell whether a scenario runs on a grid of neighbours: the same for one trial and for many.

    Errors: ScenarioError where what is asked for cannot be.
    """
    chosen = scenario.world.neighbours
    if chosen == "grid":
        check(scenario)
        return True
    most = max(scenario.prey.count, scenario.predators.count, scenario.obstacles.count)
    if chosen == "auto" and (most > MOST_PAIRED or (_pays(scenario) and not _refused(scenario))):
        check(scenario)
        return True
    check_pairs(most)
    return False


def check_pairs(most: int) -> None:
    """Raise ScenarioError for more agents of a kind than anybody waits for."""
    if most > MOST_PAIRED:
        raise ScenarioError(f"world.neighbours: all pairs of {most:,} agents are too many to compare; set it to 'grid'")


def _pays(scenario: Scenario) -> bool:
    """Tell whether a grid is faster than comparing all pairs."""
    reach = reach_of(scenario, "prey")
    share = prod(min(1.0, 3 * reach / side) for side in scenario.world.size)  # of the world, in the cells that are visited
    return scenario.prey.count >= ALWAYS or scenario.prey.count * (1 - share) >= CROSSOVER


def check(scenario: Scenario) -> None:
    """Raise ScenarioError for what a grid of neighbours cannot do."""
    path = _refused(scenario)
    if path:
        told = _told(scenario, path)
        raise ScenarioError(
            f"{path}: a grid of neighbours cannot do {told!r}; change it, or set world.neighbours to 'all-pairs'"
        )


def _told(scenario: Scenario, path: str) -> Any:
    """Give the value of a key."""
    told: Any = scenario
    for key in path.split("."):
        told = getattr(told, key)
    return told


def _refused(scenario: Scenario) -> str:
    """Name the first key that only comparing all pairs can do, or nothing."""
    world, prey, predators = scenario.world, scenario.prey, scenario.predators
    hunters = registry.parts("predators", predators.strategy) if predators.count else ()
    refused = {
        "world.contact": world.contact == "bounce",
        "prey.goal_by": prey.goal_by == "path",
        "prey.safety": prey.safety == "barrier",
        "prey.spawn.apart": prey.spawn.apart > 0,
        "predators.spawn.apart": predators.count > 0 and predators.spawn.apart > 0,
        "world.wrap_sight": box.wraps(world.boundary) and not world.wrap_sight,
        "prey.strategy": any(registry.load("prey", name).networked for name in registry.parts("prey", prey.strategy)),
        "predators.strategy": any(registry.load("predators", name).networked for name in hunters)
        or any("survey" in vars(registry.load("predators", name)) for name in hunters),
    }
    return next((path for path, impossible in refused.items() if impossible), "")


def reach_of(scenario: Scenario, kind: str) -> float:
    """Give how far away agents of a kind, or obstacles, may matter to whoever visits them [m]."""
    prey, predators = scenario.prey, scenario.predators
    sights = [
        registry.load("prey", name).sight(prey.weights, prey.perception)
        for name in registry.parts("prey", prey.strategy)
        if {"observe", "beware"} & vars(registry.load("prey", name)).keys()
    ]
    way = {kind: _step_of(scenario, kind) for kind in ("prey", "predators")}
    touch = prey.radius + predators.radius + (way["prey"] + way["predators"] if _kills(scenario) else 0.0)
    if kind == "prey":
        return max([prey.perception, touch, *(mates for mates, _ in sights), 1e-6])
    if kind == "predators":
        return max([predators.perception, prey.perception, touch, *(hunters for _, hunters in sights), 1e-6])
    heeds = [
        registry.load("avoidance", name).sight(agents.weights)
        for agents in (prey, predators)
        for name in registry.parts("avoidance", agents.avoidance)
        if {"field", "blocks", "look", "deflect"} & vars(registry.load("avoidance", name)).keys()
    ]
    return scenario.obstacles.radius[1] + max([prey.radius + way["prey"], predators.radius + way["predators"], *heeds, 1e-6])


def sweeps(scenario: Scenario) -> bool:
    """Tell whether touches on the way count, and there is anything to touch."""
    anything = _kills(scenario) or scenario.obstacles.count > 0 or scenario.target.present
    return scenario.world.contact_test == "swept" and anything


def _kills(scenario: Scenario) -> bool:
    """Tell whether prey die of touching predators."""
    return scenario.predators.count > 0 and scenario.world.contact in ("deadly", "eaten")


def _step_of(scenario: Scenario, kind: str) -> float:
    """Give how far agents of a kind come in a tick at most [m], 0 where no touch on the way counts.

    A step of Verlet's takes half of the velocity at the start along, which no cap may have shortened yet.
    """
    if not sweeps(scenario):
        return 0.0
    agents = getattr(scenario, kind)
    fastest = max(agents.max_speed, agents.min_speed)
    if scenario.world.scheme == "verlet":
        corners = zip(agents.spawn.velocity.low, agents.spawn.velocity.high, strict=True)
        fastest = max(fastest, hypot(*(max(abs(low), abs(high)) for low, high in corners)))
    kicks = [
        registry.load("prey", name).kick_speed(agents.weights)
        for name in (registry.parts("prey", agents.strategy) if kind == "prey" else ())
        if "kick" in vars(registry.load("prey", name))
    ]
    return float(scenario.world.dt * (fastest + sum(kicks)))
