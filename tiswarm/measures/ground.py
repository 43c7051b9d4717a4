"""Ground: which cells can be swept, how evenly they were, and what a recording swept of it, in NumPy."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil

import numpy as np

from tiswarm.records.recording import Recording
from tiswarm.scenario.model import World
from tiswarm.space import box


def free_cells(cell: float, size: tuple[float, ...], boundary: str, centre: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Tell which cells' centres lie inside a flat world and outside obstacles: [row, column].

    cell: side of a cell [m]; centre: [obstacle, 2], radius: [obstacle], m.
    """
    x, y = ((np.arange(ceil(length / cell)) + 0.5) * cell for length in size)
    places = np.stack(np.meshgrid(x, y), axis=-1)
    free = box.inside(places, size, boundary)
    for own, r in zip(centre, radius, strict=True):
        free &= (box.displacement(places - own, box.period(size, boundary)) ** 2).sum(axis=-1) >= r**2
    return free


def variation(total: np.ndarray, squares: np.ndarray, count: int) -> np.ndarray:
    """Give the coefficient of variation of `count` cells' visits from their sum and sum of squares, NaN before the first."""
    mean = total / count
    spread = np.sqrt(np.maximum(squares / count - mean**2, 0.0))
    return np.divide(spread, mean, out=np.full(np.shape(mean), np.nan), where=mean > 0)


def states(recording: Recording, least: int = 1) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Give tick, who is alive [agent], and their places [alive, dim], of the states in which at least so many are."""
    for tick, here in enumerate(recording.prey.alive):
        if here.sum() >= least:
            yield tick, here, recording.prey.position[tick, here]


class Sweep:
    """A flat world's grid under the tools of prey: a cell is swept when a tool lies on its centre.

    free: [row, column], the cells that can be swept.
    """

    def __init__(self, cell: float, tool: float, world: World, centre: np.ndarray, radius: np.ndarray):
        """Take a cell's side and a tool's radius [m], a world, and obstacles: centre [obstacle, 2], radius [obstacle], m."""
        size = world.size[:2]
        self.free = free_cells(cell, size, world.boundary, centre, radius)
        self._cell, self._reach = cell, tool / cell
        self._period = box.period(size, world.boundary)
        self._window = np.arange(min(int(2 * self._reach) + 2, max(self.free.shape)))

    def under(self, places: np.ndarray) -> np.ndarray:
        """Give the numbers, row by row, of the free cells under tools at places [tool, 2]: a cell once for each tool on it."""
        down, across = self.free.shape
        x, y = (box.images(places, self._period) / self._cell - 0.5).T[:, :, None]  # in cells, whole numbers at their centres
        columns, rows = (np.maximum(np.ceil(each - self._reach), 0).astype(int) + self._window for each in (x, y))
        off = ((columns - x) ** 2)[:, None, :] + ((rows - y) ** 2)[:, :, None]
        if self._period.any():  # a tool wider than the world is under a cell but once
            half_x, half_y = self._period / self._cell / 2
            near_x, near_y = ((way <= half) & (-half < way) for way, half in ((columns - x, half_x), (rows - y, half_y)))
            off[~(near_x[:, None, :] & near_y[:, :, None])] = np.inf
        lies = (off <= self._reach**2) & (columns < across)[:, None, :] & (rows < down)[:, :, None]
        cells = (rows[:, :, None] * across + columns[:, None, :])[lies]
        return cells[self.free.flat[cells]]


@dataclass(frozen=True)
class Ground:
    """The ground that prey swept with their tools.

    share: [tick], how much of it has been swept; variation: [tick], coefficient of variation of the cells' visits, NaN before
    the first; visits: [row, column], in how many states how many tools lay on a cell's centre, -1 where there is no ground.
    """

    share: np.ndarray
    variation: np.ndarray
    visits: np.ndarray


def ground(recording: Recording) -> Ground:
    """Sweep the grid of scenario.coverage. Errors: ValueError when the scenario has none."""
    side = recording.scenario.coverage.cell
    if not side:
        raise ValueError("coverage: the scenario has no grid; set coverage.cell")
    world = recording.scenario.world
    sweep = Sweep(side, recording.scenario.coverage.tool, world, recording.obstacle_position, recording.obstacle_radius)
    visits = np.zeros(sweep.free.size)
    swept, total, squares = np.zeros((3, recording.ticks + 1))
    for tick, _, places in states(recording):
        cells, times = np.unique(sweep.under(places), return_counts=True)
        swept[tick] = (visits[cells] == 0).sum()
        total[tick] = times.sum()
        squares[tick] = (times * (2 * visits[cells] + times)).sum()
        visits[cells] += times
    count = max(int(sweep.free.sum()), 1)
    spread = variation(total.cumsum(), squares.cumsum(), count)
    visited = np.where(sweep.free, visits.reshape(sweep.free.shape), -1).astype(np.int64)
    return Ground(swept.cumsum() / count, spread, visited)


def coverage(recording: Recording) -> np.ndarray:
    """Give the share of the ground that has been swept: [tick], 0 to 1."""
    return ground(recording).share


def visit_variation(recording: Recording) -> np.ndarray:
    """Give the coefficient of variation of how often cells were visited: [tick], NaN before the first visit."""
    return ground(recording).variation


def time_to(recording: Recording, share: float) -> float:
    """Give when this share of the ground had been swept [s], NaN when it never was."""
    ticks = np.flatnonzero(coverage(recording) >= share)
    return float(ticks[0] * recording.scenario.world.dt) if len(ticks) else float("nan")
