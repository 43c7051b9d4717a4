"""Ways: the planned ways of one trial as NumPy arrays: to draw them, to test them, and to tell who found none."""

from dataclasses import dataclass

import numpy as np

from tiswarm.dynamics.planning import STEPS
from tiswarm.engine.trials.trial import Single
from tiswarm.records.recording import Recording
from tiswarm.scenario.start import Start

_MOVES = np.zeros((9, 2), int)
for _across, _up, _code in STEPS:
    _MOVES[_code] = _across, _up


@dataclass(frozen=True)
class Ways:
    """Which neighbour each cell of the grid leads to.

    step: [column, row, 2], cells across and up to the next cell, 0 where there is none; side: of a cell [m].
    """

    step: np.ndarray
    side: float

    @classmethod
    def of(cls, single: Single) -> "Ways":
        """Read the plan of a trial that has moved once, or more often."""
        return cls(_MOVES[single.plan()], single.scenario.planning.cell)

    def cell(self, place: np.ndarray) -> np.ndarray:
        """Give the cells [..., 2] of places [..., 2], the nearest ones to places off the map."""
        return np.clip(np.floor(np.asarray(place) / self.side).astype(int), 0, np.array(self.step.shape[:2]) - 1)

    def centre(self, cell: np.ndarray) -> np.ndarray:
        """Give where the centres of cells are [m]."""
        return self.side * (np.asarray(cell) + 0.5)

    def chain(self, place: np.ndarray) -> np.ndarray:
        """List the cells of the way from a place, its own first: [cell, 2]."""
        cells = [self.cell(place)]
        while self.step[tuple(cells[-1])].any():
            cells.append(cells[-1] + self.step[tuple(cells[-1])])
        return np.array(cells)

    def leads(self, place: np.ndarray, target: np.ndarray) -> bool:
        """Tell whether the way from a place ends at the target."""
        return bool((self.chain(place)[-1] == self.cell(target)).all())


def notes(single: Single) -> tuple[str, ...]:
    """Tell which prey found no way to the target when a trial began, in a line each."""
    if single.scenario.prey.goal_by == "line" or single.age == 0:
        return ()
    ways, target = Ways.of(single), np.array(single.scenario.target.position)
    lost = [k + 1 for k, place in enumerate(single.start) if np.isfinite(place[0]) and not ways.leads(place, target)]
    return tuple(f"prey {number} found no way to the target and went straight: obstacles close its start in" for number in lost)


def planned(recording: Recording, across: int = 50) -> tuple[np.ndarray, np.ndarray]:
    """Sample the planned ways of a trial: points and directions, [point, 2], m.

    From cells all over the world where every prey knows its way from wherever it is, else along each prey's list.

    Errors: ValueError for prey that do not plan.
    """
    scenario = recording.scenario
    if scenario.prey.goal_by == "line":
        raise ValueError("plan: only prey with goal_by = 'path' have a plan to draw; set it, or leave the overlay out")
    places = recording.prey.position[0]
    none = np.zeros((0, 2))
    start = Start(places, np.zeros_like(places), none, none, recording.obstacle_position, recording.obstacle_radius)
    alone = {"predators.count": 0, "measures.names": [], "coverage.cell": 0}
    single = Single(scenario.replaced(alone), recording.seed, recording.trial, start)
    single.step()
    ways = Ways.of(single)
    if scenario.planning.plan == "list":
        cells = np.concatenate([ways.chain(place)[:-1] for place in places])
    else:
        every = max(1, round(ways.step.shape[0] / across))
        cells = np.stack(np.meshgrid(*(np.arange(every // 2, n, every) for n in ways.step.shape[:2])), axis=-1).reshape(-1, 2)
    steps = ways.step[cells[:, 0], cells[:, 1]].astype(float)
    return ways.centre(cells), steps / np.maximum(np.linalg.norm(steps, axis=1, keepdims=True), 1e-9)
