"""Trial: one trial in one lane, tick by tick, with the same kernel and so the same bits as in a batch."""

from operator import index
from typing import Any

import numpy as np

from tiswarm.dynamics.rows import AGE, DONE, ON
from tiswarm.engine import finite
from tiswarm.engine.trials.batch import Blocks
from tiswarm.engine.trials.kernel import OUTCOMES
from tiswarm.records.recording import FATES, Recording
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.start import Start
from tiswarm.space import box


class Single:
    """A trial that pauses after every tick."""

    def __init__(self, scenario: Scenario, seed: int, trial: int, start: Start | None = None, *, terms: bool = False) -> None:
        """Draw the start from seed and trial number, or take an explicit one. terms: for `courses`.

        start: where the prey were then, [agent, dim], m.
        """
        trial, seed = index(trial), index(seed)
        if not 0 <= trial < 1 << 31:
            raise ValueError(f"trial: {trial} is not possible; use 0 to {(1 << 31) - 1}")
        if start is not None:
            scenario = start.applied(scenario)
        self.scenario = scenario
        self.seed = seed
        self._blocks = Blocks([scenario], 1, terms=terms)
        surveying = self._blocks.layout.parts("predators", "strategy", "survey")
        self._live = [p for p in surveying if p.strategy.live and scenario.predators.weights.get(p.strategy.live)]
        self._table = self._blocks.layout.table([scenario]).astype(self._blocks.dtype)
        self._trial = trial
        self._jobs = np.array([[0, trial]], np.int32)
        self._queue = np.array([0, 1], np.int32)
        self._results, self._measured = self._blocks.outcomes(1)
        arrays = (self._table, self._jobs, self._queue, self._results, self._measured)
        self._advance = self._blocks.prepared(*arrays, seed)
        self._advance(0)
        if start is not None:
            self._obstacles()[:] = np.vstack([start.obstacle_position.T, start.obstacle_radius])
            self.place("prey", start.prey_position, start.prey_velocity)
            self.place("predators", start.predator_position, start.predator_velocity)
        self.start = self.position("prey")

    def step(self, ticks: int = 1) -> None:
        """Run so many ticks, fewer when the trial ends before; in one launch, unless a strategy asks programs outside it."""
        while ticks > 0 and not self.ended:  # the kernel would take the lane of a trial that is over for a free one
            if self._live:
                self._consult()
            ticks -= self._run(1 if self._live else ticks)

    def _run(self, moves: int) -> int:
        """Make so many moves, fewer when the trial ends before, and look at the state; give how many were made."""
        age, before = self.age, self._kept() if moves > 1 else []
        self._advance(moves)
        if self._blocks.clock[0, ON, 0] < 0.5:  # it ended on the way, and its lane was given away
            moves = int(self._results[0, list(OUTCOMES).index("ticks")]) - age
            self._restore(before)
            self._advance(moves)
        try:
            self._check()
        except finite.NotFiniteError:
            if not before:
                raise
            self._restore(before)
            for _ in range(moves):  # the first tick of it is the one to name
                self._advance(1)
                self._check()
        return moves

    def _check(self) -> None:
        """Errors: NotFiniteError if anyone is at no finite place or velocity."""
        for kind in ("prey", "predators"):
            rows, own = self._agents(kind), self._rows
            alive = rows[own.alive] > 0.5
            finite.check(self.scenario, self._trial, self.age, kind, rows[[*own.place, *own.motion]].T, alive)

    def _kept(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Copy the whole state, each array beside its copy."""
        return [(each, each.copy()) for each in vars(self._blocks).values() if isinstance(each, np.ndarray)]

    def _restore(self, kept: list[tuple[np.ndarray, np.ndarray]]) -> None:
        """Go back to a state that was kept."""
        for each, copy in kept:
            each[...] = copy

    def _consult(self) -> None:
        """Let strategies that ask programs outside the kernel see the prey where this tick will have moved them."""
        before = self._kept()
        here = self._agents("prey")[self._rows.alive] > 0.5
        self._advance(1)
        position = self._agents("prey")[self._rows.place].T.astype(np.float64)
        position[~here] = np.nan
        world = self.scenario.world
        if world.wrap_sight:
            position = box.about_first(position, box.period(world.size, world.boundary))
        self._restore(before)
        predators, key = self._agents("predators"), (self.seed, self._trial, self.age)
        for part in self._live:
            memory = {name: predators[row] for name, row in zip(part.memory, part.memory_rows, strict=True)}
            part.strategy.consult(self._board(part), memory, position, self.scenario.predators.weights, key)

    def _board(self, part: Any) -> np.ndarray:
        """Give a view of what a predator strategy's survey wrote in lane 0: [row]."""
        rows, count = self._blocks.layout.board, self.scenario.prey.count
        return self._blocks.board[part.board.fixed + part.board.each * count : rows.fixed + rows.each * count, 0]

    def groups(self, kind: str) -> np.ndarray | None:
        """Give the sub-swarms of the last move, [agent], -1 for none; None when predators do not split up."""
        for part in self._blocks.layout.parts("predators", "strategy", "survey"):
            if self.age == 0:
                return np.full(getattr(self.scenario, kind).count, -1)
            if kind == "predators":
                found = part.strategy.groups(self.memory(kind)[part.part.name])
            else:
                found = part.strategy.prey_groups(self._board(part), self.scenario.prey.count, self.scenario.world.dim)
            if found is not None:
                return np.asarray(found)
        return None

    def plan(self) -> np.ndarray:
        """Give the code of the step out of each cell (planning.py), once the first move has planned: [column, row]."""
        grid = self._blocks.layout.plan
        codes = self._blocks.board[grid.next : grid.next + grid.cells, 0].reshape(grid.across + 2, grid.up + 2)
        return codes[1:-1, 1:-1].astype(int)

    @property
    def ended(self) -> bool:
        """Tell whether the trial is over."""
        return bool(self._blocks.clock[0, DONE, 0] > 0.5)

    @property
    def age(self) -> int:
        """Count the ticks run."""
        return int(self._blocks.clock[0, AGE, 0])

    def _agents(self, kind: str) -> np.ndarray:
        """Give a view of lane 0: [row, agent]."""
        rows, count = self._blocks.layout.agent_rows[kind], getattr(self.scenario, kind).count
        return getattr(self._blocks, kind)[: count * rows, 0].reshape(count, rows).T

    def _obstacles(self) -> np.ndarray:
        """Give a view of lane 0: [row, obstacle]."""
        count, rows = self.scenario.obstacles.count, self._blocks.layout.obstacle_rows
        return self._blocks.obstacles[: count * rows, 0].reshape(count, rows).T

    def position(self, kind: str) -> np.ndarray:
        """Give where the prey or predators are: [agent, dim], m, NaN for those who are gone."""
        return self._vectors(kind, self._rows.place)

    def velocity(self, kind: str) -> np.ndarray:
        """Give their velocity: [agent, dim], m/s, NaN for those who are gone."""
        return self._vectors(kind, self._rows.motion)

    @property
    def _rows(self) -> Any:
        return self._blocks.layout.rows

    def _vectors(self, kind: str, places: list[int]) -> np.ndarray:
        rows = self._agents(kind)
        vectors = rows[places].T.astype(np.float64)
        vectors[rows[self._rows.alive] < 0.5] = np.nan
        return vectors

    def last(self, kind: str) -> tuple[np.ndarray, np.ndarray]:
        """Give where all agents are, or were judged to be gone, and how far they came in that tick: [agent, dim], m.

        Zeros for the way where contact is judged after the move, and nobody asks.
        """
        rows = self._agents(kind)
        place = rows[self._rows.place].T.astype(np.float64)
        return place, rows[self._rows.travel].T.astype(np.float64) if self._rows.travel else np.zeros_like(place)

    def pull(self, kind: str) -> np.ndarray:
        """Give what the obstacles' fields add to each agent's velocity: [agent, dim], m/s."""
        return self._agents(kind)[self._rows.field].T.astype(np.float64)

    def fate(self, kind: str) -> np.ndarray:
        """Name what became of each agent so far: [agent]."""
        return np.array(FATES)[self._agents(kind)[self._rows.fate].astype(int)]

    def memory(self, kind: str) -> dict[str, dict[str, np.ndarray]]:
        """Give the agents' memory: strategy -> name -> [agent]."""
        parts = self._blocks.layout.parts(kind, "strategy")
        rows = self._agents(kind)
        return {p.part.name: {name: rows[row].copy() for name, row in zip(p.memory, p.memory_rows, strict=True)} for p in parts}

    def courses(self, kind: str) -> dict[str, np.ndarray]:
        """Give the velocity behind each term of the last move, in their order: name -> [agent, dim], m/s."""
        rows = self._agents(kind)
        return {name: rows[places].T.astype(np.float64) for name, places in self._blocks.layout.courses[kind].items()}

    def obstacles(self) -> tuple[np.ndarray, np.ndarray]:
        """Give the obstacles' centres and radii: [obstacle, dim] and [obstacle], m."""
        rows = self._obstacles().astype(np.float64)
        return rows[:-1].T.copy(), rows[-1].copy()

    def renumber(self, scenario: Scenario) -> None:
        """Take over the numbers of a scenario of the same structure and counts; they judge the state of now."""
        self.scenario = scenario
        self._table[:] = self._blocks.layout.table([scenario])
        self._blocks.numbers[: self._table.shape[1], 0] = self._table[0]
        self._advance(0)

    def place(self, kind: str, position: np.ndarray, velocity: np.ndarray) -> None:
        """Put agents somewhere, their memory untouched; NaN in a position means gone."""
        rows = self._agents(kind)
        here = np.isfinite(position[:, 0])
        rows[self._rows.alive] = here
        for row, values in zip([*self._rows.place, *self._rows.motion], np.hstack([position, velocity]).T, strict=True):
            rows[row] = np.where(here, values, rows[row])
        rows[self._rows.travel] = 0  # nobody came from anywhere
        self._advance(0)  # the fields at the new places


def field(recording: Recording, across: int = 72) -> tuple[np.ndarray, np.ndarray]:
    """Sample the prey's obstacle avoidance on a square lattice over a flat world: points and arrows, [point, 2], m and m/s.

    The engine itself computes it, on prey at rest at the lattice's points; avoidances that turn the course instead have none.

    Errors: ValueError for a deep world.
    """
    scenario = recording.scenario
    if recording.dim != 2:
        raise ValueError("field: only a flat world has a field to draw; leave the overlay out")
    side = max(scenario.world.size) / across
    axes = [np.arange(0.5 * side, length, side) for length in scenario.world.size]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    none = np.zeros((0, 2))
    probes = Start(points, np.zeros_like(points), none, none, recording.obstacle_position, recording.obstacle_radius)
    alone = {"predators.count": 0, "measures.names": [], "coverage.cell": 0}
    pull = Single(scenario.replaced(alone), recording.seed, recording.trial, probes).pull("prey")
    away = np.linalg.norm(recording.shortest(points[:, None] - recording.obstacle_position), axis=2)
    pull[(away < recording.obstacle_radius).any(axis=1)] = 0  # nobody is there to feel it
    return points, pull
