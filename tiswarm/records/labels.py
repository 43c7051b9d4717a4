"""Labels: what agents are called at one tick: calm, alarmed, or a state of their strategy; and which sub-swarm they are of."""

from collections.abc import Mapping

import numpy as np

from tiswarm.scenario.model import Scenario
from tiswarm.space import box
from tiswarm.space.sight import in_view
from tiswarm.strategies import registry

Memories = Mapping[str, Mapping[str, np.ndarray]]

MOST_PAIRS = 10_000_000
"""With more pairs than this nobody is called alarmed: a picture of so many could not show it."""

_ROWS = 1_000_000  # pairs compared at once
_FIRST = 256  # others looked at before any more are: of a crowd, most see somebody among them


def named(
    scenario: Scenario,
    kind: registry.Kind,
    position: np.ndarray,
    velocity: np.ndarray,
    others: np.ndarray,
    memories: Memories,
) -> np.ndarray:
    """Name each agent's state: what its strategy says, else alarmed when it sees an opponent, else calm: [agent].

    position, velocity: [agent, dim], m and m/s, others: [other, dim], m, NaN for those who are gone.
    memories: strategy -> name -> [agent]; those of strategies that the scenario does not have name nobody.
    """
    agents = getattr(scenario, kind)
    state = np.full(len(position), "calm", dtype="<U12")
    if len(position) * len(others) <= MOST_PAIRS:
        period = box.period(scenario.world.size, scenario.world.boundary) * scenario.world.wrap_sight
        there = others[np.isfinite(others[:, 0])]
        state[_seen(position, velocity, there, agents.perception, agents.field_of_view, period)] = "alarmed"
    own = registry.parts(kind, agents.strategy)
    for name, memory in memories.items():
        if memory and name in own:
            for label, members in registry.load(kind, name).states(memory, agents.weights).items():
                state[members] = label
    state[np.isnan(position[:, 0])] = "calm"
    return state


def _seen(
    position: np.ndarray, velocity: np.ndarray, others: np.ndarray, perception: float, field_of_view: float, period: np.ndarray
) -> np.ndarray:
    """Tell who has any of the others in view and within perception, as the crow flies in the plane: [agent], bool."""
    found = np.zeros(len(position), bool)
    first, wide = 0, _FIRST
    while first < len(others):
        some, looking = others[first : first + wide], np.flatnonzero(~found)
        rows = max(_ROWS // len(some), 1)
        for own in (looking[begin : begin + rows] for begin in range(0, len(looking), rows)):
            away = box.displacement(position[own, None] - some[None], period)
            near = np.hypot(away[..., 0], away[..., 1]) <= perception
            found[own] = (near & in_view(-away, velocity[own], field_of_view)).any(axis=1)
        first, wide = first + wide, 4 * wide
    return found


def grouped(scenario: Scenario, kind: registry.Kind, count: int) -> np.ndarray:
    """Give each agent's sub-swarm where a strategy splits them up, else -1: [agent]."""
    group = np.full(count, -1, np.int32)
    for name in registry.parts(kind, getattr(scenario, kind).strategy):
        strategy = registry.load(kind, name)
        if hasattr(strategy, "group"):
            own = [strategy.group(number) for number in range(1, count + 1)]
            group = np.where(group < 0, own, group).astype(np.int32)
    return group
