"""Batch: run trials of a large swarm to their ends, as many at once as fit, and measure what the scenario asks for."""

from collections.abc import Callable

import numpy as np

from tiswarm.engine.swarms.measures import Measures
from tiswarm.engine.swarms.simulation import Swarm
from tiswarm.scenario.model import Scenario

AT_ONCE = 262_144
"""Agents of trials that run at once: they fill both cores, and not the memory."""

CELLS_AT_ONCE = 16_777_216
"""Cells of coverage grids that trials which run at once may have together."""

Found = dict[str, np.ndarray]


def outcomes(scenario: Scenario, trials: int, seed: int, report: Callable[[int], None], begin: int = 0) -> tuple[Found, Found]:
    """Run trials begin, begin + 1, ... : what became of them (kernel.OUTCOMES), what was measured, name -> [trial].

    report: called with how many of the trials are done.
    """
    agents = max(scenario.prey.count, scenario.predators.count, scenario.obstacles.count, 1)
    at_once = max(AT_ONCE // agents, 1)
    if scenario.coverage.cell:
        width, height = scenario.world.size
        at_once = max(min(at_once, int(CELLS_AT_ONCE * scenario.coverage.cell**2 / (width * height))), 1)
    found: list[Found] = []
    measured: list[Found] = []
    for first in range(0, trials, at_once):
        swarm = Swarm(scenario, seed, min(at_once, trials - first), begin + first)
        measures = Measures(swarm) if scenario.measures.names else None
        while not swarm.ended.all():
            swarm.step()
            if measures is not None:
                measures.take()
        names = ("alive", "arrived", "captured", "crashed")
        counted = {name: swarm.counts[:, k] for k, name in enumerate(names)}
        times = {"ticks": swarm.ended_at, "first_arrival": swarm.first_arrival, "last_arrival": swarm.last_arrival}
        found.append(counted | times)
        measured.append(measures.values() if measures is not None else {})
        report(first + swarm.trials)
    return (
        {name: np.concatenate([each[name] for each in found]).astype(np.int32) for name in found[0]},
        {name: np.concatenate([each[name] for each in measured]) for name in measured[0]},
    )
