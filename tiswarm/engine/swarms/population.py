"""Population: the agents of one kind of a large swarm: their grid, and what of them no neighbour sees."""

from dataclasses import dataclass

import numpy as np

from tiswarm.scenario.model import Scenario
from tiswarm.space import box
from tiswarm.space.cell_list import Grid
from tiswarm.space.cells import Space


@dataclass
class Population:
    """Agents of one kind: their grid, and cold rows by number: [trial, agent, column], see transfer.py."""

    grid: Grid
    cold: np.ndarray
    kept: list[int]

    @property
    def arrays(self) -> tuple[np.ndarray, ...]:
        """Give what kernels take of the grid."""
        return self.grid.agents, self.grid.whole, self.grid.reals

    def row(self, row: int) -> np.ndarray:
        """Give a view of a row of the agents by number: [trial, agent]."""
        return self.cold[..., self.kept.index(row)]


def space_of(scenario: Scenario, kind: str) -> Space:
    """Give the space of a kind's grid. In open worlds prey fly anywhere; of the few others, those outside are in edge cells."""
    world = scenario.world
    boundary = world.boundary
    return Space(tuple(world.size), boundary if box.bounded(boundary) or kind == "prey" else "walls")
