"""Checks: whether the parts of a scenario go together, each complaint one line that names the mend."""

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from tiswarm.scenario.barrier import MOST_JOINT
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.measures import SWEPT
from tiswarm.space import box
from tiswarm.strategies import registry

if TYPE_CHECKING:  # the model asks for these checks
    from tiswarm.scenario.agents import Agents
    from tiswarm.scenario.model import Scenario
    from tiswarm.scenario.parts import Box


def check(scenario: "Scenario") -> None:
    """Raise ScenarioError where keys that are right each for itself contradict each other."""
    dim = scenario.world.dim
    for path, numbers in _vectors(scenario):
        if len(numbers) != dim:
            raise ScenarioError(f"{path}: {list(numbers)} has {len(numbers)} numbers, world.size has {dim}; write {dim}")
    for side, role, catalogue, name in registry.roles(scenario):
        able = registry.dimensions(catalogue, name)
        if dim not in able and (side == "prey" or scenario.predators.count):
            raise ScenarioError(f"{side}.{role}: '{name}' works in {_worlds(able)} only; world.size has {dim} numbers")
    kind: registry.Side
    for kind, agents in (("prey", scenario.prey), ("predators", scenario.predators)):
        _check_edges(kind, agents, scenario.world.boundary)
        _check_flat(kind, agents, dim)
        _check_whole(kind, agents)
        _check_needed(kind, agents)
        _check_most(kind, agents)
        if agents.drive == "unicycle" and dim != 2:
            raise ScenarioError(f"{kind}.drive: a unicycle needs a flat world, world.size has {dim} numbers; use 'point'")
        if agents.spawn.apart and agents.spawn.shape == "ball":
            raise ScenarioError(f"{kind}.spawn.apart: works for shape = 'box' only; set it to 0, or use that")
        if agents.min_speed > agents.max_speed:
            raise ScenarioError(f"{kind}.min_speed: {agents.min_speed:g} is above max_speed, {agents.max_speed:g}")
        _check_step(kind, agents, scenario.world.dt)
        if scenario.world.gains == "per-second" and (kind == "prey" or agents.count):
            _check_per_second(kind, agents, scenario.obstacles.count)
        if box.bounded(scenario.world.boundary) and agents.count:
            ball = agents.spawn.shape == "ball"
            _inside(f"{kind}.spawn.region", agents.spawn.region, scenario.world.size, scenario.world.boundary, ball)
        scenario.network(kind)
    _check_target(scenario)
    _check_planning(scenario)
    _check_barrier(scenario)
    _check_measures(scenario)


LONGEST_STEP = 1e6
"""Longest way of a tick [m]: squares and cubes of the distances of the longest trial still fit into single precision."""


def _check_step(kind: str, agents: "Agents", dt: float) -> None:
    """Refuse speeds that in one tick lead so far that numbers overflow and become none."""
    start = max(map(abs, (*agents.spawn.velocity.low, *agents.spawn.velocity.high)))
    for key, speed in (("max_speed", agents.max_speed), ("spawn.velocity", start)):
        if speed * dt > LONGEST_STEP:
            told = f"{speed:g} m/s are {speed * dt:g} m in a tick of {dt:g} s"
            raise ScenarioError(f"{kind}.{key}: {told}; lower it or world.dt to {LONGEST_STEP:g} m a tick or less")


def _check_target(scenario: "Scenario") -> None:
    """Refuse a target that no prey can reach."""
    target, world = scenario.target, scenario.world
    if target.present and box.rounded(world.boundary) and not box.inside(np.array(target.position), world.size, world.boundary):
        told = f"{list(target.position)} is outside the disc; move it within, or enlarge world.size"
        raise ScenarioError(f"target.position: {told}")


MOST_PLANNED = 100_000
"""Most cells of a grid on which ways are found: each trial looks at each of them a few times before it starts."""


def _check_planning(scenario: "Scenario") -> None:
    """Refuse planned ways where there is nothing to plan for, or no grid to plan on."""
    world, mend = scenario.world, "set it to 'line'"
    if scenario.prey.goal_by == "line":
        return
    if not scenario.target.present:
        raise ScenarioError(f"prey.goal_by: 'path' leads to a target, and there is none; set target.present, or {mend}")
    if world.dim != 2:
        raise ScenarioError(f"prey.goal_by: 'path' needs a flat world, world.size has {world.dim} numbers; {mend}")
    if world.boundary not in ("open", "walls"):
        raise ScenarioError(f"prey.goal_by: 'path' needs world.boundary 'open' or 'walls', not '{world.boundary}'; {mend}")
    across, up = scenario.planning.cells(world.size)
    if across * up > MOST_PLANNED:
        raise ScenarioError(f"planning.cell: {scenario.planning.cell:g} gives {across * up:,} cells; use a larger one")


def _check_barrier(scenario: "Scenario") -> None:
    """Refuse certificates where they would not hold."""
    world, prey, barrier, mend = scenario.world, scenario.prey, scenario.barrier, "set it to 'none'"
    if prey.safety == "none":
        return
    if world.dim != 2:
        raise ScenarioError(f"prey.safety: 'barrier' needs a flat world, world.size has {world.dim} numbers; {mend}")
    if box.rounded(world.boundary):
        raise ScenarioError(f"prey.safety: 'barrier' knows no edge that mirrors; use another world.boundary, or {mend}")
    if box.wraps(world.boundary) and not world.wrap_sight:
        raise ScenarioError(f"prey.safety: 'barrier' must see across a periodic edge; set world.wrap_sight, or {mend}")
    if world.scheme == "verlet":
        raise ScenarioError(
            f"prey.safety: 'barrier' bounds velocities, 'verlet' steps by two; use world.scheme 'euler', or {mend}"
        )
    if world.boundary != "open" and 2 * barrier.radius >= min(world.size):
        told = f"{barrier.radius:g} is half of world.size, {list(world.size)}, or more"
        raise ScenarioError(f"barrier.radius: {told}; lower it, or enlarge the world")
    if barrier.form == "joint" and prey.count > MOST_JOINT:
        told = f"'joint' works for {MOST_JOINT} prey at most, not for {prey.count:,}"
        raise ScenarioError(f"barrier.form: {told}; use 'shared', or fewer")


def _check_edges(kind: registry.Kind, agents: "Agents", boundary: str) -> None:
    """Refuse strategies that need a world with edges, or a point from which all places are counted, where there is none."""
    where: registry.Kind
    for key, where in (("strategy", kind), ("avoidance", "avoidance")):
        for part in registry.parts(where, getattr(agents, key)) if box.wraps(boundary) else ():
            if not registry.load(where, part).periodic and (kind == "prey" or agents.count):
                told = f"'{part}' has no meaning in a world without edges; use another, or world.boundary 'open' or 'walls'"
                raise ScenarioError(f"{kind}.{key}: {told}")


def _check_per_second(kind: str, agents: "Agents", obstacle_count: int) -> None:
    """Refuse what acts once a tick however long it is: under gains by the second, halving a tick would not converge."""
    mend = "use another, or world.gains = 'per-tick'"
    if agents.drive == "unicycle":
        raise ScenarioError(f"{kind}.drive: a unicycle takes a new course once a tick, not by the second; {mend}")
    for part in registry.parts("avoidance", agents.avoidance) if obstacle_count else ():
        if {"blocks", "deflect"} & vars(registry.load("avoidance", part)).keys():
            raise ScenarioError(f"{kind}.avoidance: '{part}' turns the course once a tick, not by the second; {mend}")


def _check_flat(kind: registry.Kind, agents: "Agents", dim: int) -> None:
    """Refuse choices of a strategy that have a meaning in the plane only."""
    for part in registry.parts(kind, agents.strategy) if dim != 2 else ():
        for key, word in getattr(registry.load(kind, part), "flat_only", ()):
            if agents.weights[key] == word:
                told = f"{agents.weights[key]!r} needs a flat world, world.size has {dim} numbers"
                raise ScenarioError(f"{kind}.weights.{key}: {told}")


def _check_whole(kind: registry.Kind, agents: "Agents") -> None:
    """Refuse weights that must be whole numbers within bounds and are not."""
    for part in registry.parts(kind, agents.strategy):
        for key, (least, most) in getattr(registry.load(kind, part), "whole", {}).items():
            value = float(agents.weights[key])
            if value != round(value) or not least <= value <= most:
                told = f"{value:g} is not allowed; use a whole number from {least} to {most}"
                raise ScenarioError(f"{kind}.weights.{key}: {told}")


def _check_needed(kind: registry.Kind, agents: "Agents") -> None:
    """Refuse weights that contradict a word which was chosen."""
    for part in registry.parts(kind, agents.strategy):
        for key, (other, word) in getattr(registry.load(kind, part), "needed", {}).items():
            if agents.weights[key] and agents.weights[other] != word:
                told = f"needs {kind}.weights.{other} = '{word}', not '{agents.weights[other]}'; set it, or {key} to 0"
                raise ScenarioError(f"{kind}.weights.{key}: {told}")


def _check_most(kind: registry.Kind, agents: "Agents") -> None:
    """Refuse more agents than a strategy works for."""
    for part in registry.parts(kind, agents.strategy):
        most = getattr(registry.load(kind, part), "most", 0)
        if most and agents.count > most:
            raise ScenarioError(f"{kind}.count: '{part}' works for {most} agents at most; lower it, or use another strategy")


def _vectors(scenario: "Scenario") -> list[tuple[str, tuple[float, ...]]]:
    """List what needs as many numbers as the world has dimensions, where it matters."""
    found = [("prey.spawn.region", scenario.prey.spawn.region), ("prey.spawn.velocity", scenario.prey.spawn.velocity)]
    if scenario.predators.count:
        spawn = scenario.predators.spawn
        found += [("predators.spawn.region", spawn.region), ("predators.spawn.velocity", spawn.velocity)]
    if scenario.obstacles.count:
        found.append(("obstacles.region", scenario.obstacles.region))
    vectors = [(path, box.low) for path, box in found]
    return [*vectors, ("target.position", scenario.target.position)] if scenario.target.present else vectors


def _inside(path: str, region: "Box", size: tuple[float, ...], boundary: str, ball: bool) -> None:
    low, high = np.array(region.low), np.array(region.high)
    corners = np.array(list(product(*zip(low, high, strict=True))))
    kept = box.inside(corners, size, boundary).all()
    if ball and box.rounded(boundary):  # the farthest point of an ellipsoid is no farther than its longest axis
        centre, radius = box.disc(size)
        kept = np.linalg.norm((low + high) / 2 - centre) + (high - low).max() / 2 <= radius
    if not kept and box.rounded(boundary):
        centre, radius = box.disc(size)
        told = f"within {radius:g} m of {centre.tolist()}"
        raise ScenarioError(f"{path}: reaches out of the disc; keep its corners {told}, or use shape = 'ball'")
    if not kept:
        raise ScenarioError(f"{path}: reaches out of a world with edges; keep it within 0 and world.size, {list(size)}")


def _worlds(dimensions: tuple[int, ...]) -> str:
    return " and ".join(f"{dim}-D worlds" for dim in dimensions)


CELLS = 1_000_000
"""Most cells of a coverage grid: each is counted for every lane of a thread."""


def _check_measures(scenario: "Scenario") -> None:
    swept = [name for name in scenario.measures.names if name in SWEPT]
    if swept and not scenario.coverage.cell:
        raise ScenarioError(f"measures.names: '{swept[0]}' needs a grid; set coverage.cell")
    if "trapped-milling" in scenario.measures.names and scenario.world.dim != 2:
        raise ScenarioError("measures.names: 'trapped-milling' needs a flat world, where one circles left or right; drop it")
    if scenario.coverage.cell:
        if scenario.world.dim != 2:
            raise ScenarioError("coverage.cell: only a flat world has ground to sweep; set it to 0")
        cells = 1.0
        for length in scenario.world.size:
            cells *= length / scenario.coverage.cell
        if cells > CELLS:
            raise ScenarioError(f"coverage.cell: {scenario.coverage.cell:g} gives {cells:,.0f} cells; use a larger one")
