"""Session: many trials side by side, tick by tick, whose agents obey what they are told before each move."""

from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from tiswarm.dynamics.rows import AGE, DONE, JOB, ON
from tiswarm.engine.choice import engine_of
from tiswarm.engine.trials.batch import Blocks
from tiswarm.records.labels import grouped, named
from tiswarm.records.recording import FATES
from tiswarm.records.recording import Swarm as Moment
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.simd.runtime import LANES
from tiswarm.strategies import registry

Kind = Literal["prey", "predators"]


class Session:
    """Trials in lanes of their own, each until it ends; then another trial may begin in its place.

    Attributes: scenario; blocks: the arrays; slots: [place], the lane of each place, block * 8 + lane; trial: [place], the
    number of the trial that runs there. A trial's bits depend on its number, the seed and what it was told, on nothing else.
    """

    def __init__(self, scenario: Scenario, places: int, commanded: dict[Kind, str]) -> None:
        """Allocate lanes for so many trials. commanded: what agents of a kind are told (commands.py).

        Errors: ScenarioError for a scenario that cannot be stepped so.
        """
        _check(scenario)
        self.scenario = scenario.replaced({"measures.names": [], "coverage.cell": 0.0})
        self.places = places
        self.blocks = Blocks([self.scenario], -(-places // LANES), commanded=tuple(sorted(commanded.items())))
        self._table = self.blocks.layout.table([self.scenario]).astype(self.blocks.dtype)
        self._results, self._measured = self.blocks.outcomes(places)
        self._seed, self._move = 0, self._moving(0)
        self.slots = np.full(places, -1, np.int32)
        self.trial = np.full(places, -1, np.int64)

    def begin(self, where: np.ndarray, trial: np.ndarray, seed: int) -> None:
        """Begin trials at some places, [n], with numbers [n], whatever ran there; other places keep their state.

        All trials have one seed: to begin with another, begin all of them.
        """
        clock = self._clock
        if len(where) == self.places:
            clock[ON], clock[DONE] = 0.0, 0.0
        else:
            clock[DONE][self._lanes(where)] = 1.0  # the kernel gives lanes of ended trials away
        if seed != self._seed:
            self._seed, self._move = seed, self._moving(seed)
        free = (clock[ON] < 0.5) | (clock[DONE] > 0.5)
        jobs = np.stack([np.zeros(len(where), np.int32), trial.astype(np.int32)], axis=1)
        queue = np.array([0, len(jobs)], np.int32)
        self.blocks.advance(self._table, jobs, queue, self._results, self._measured, seed, 0)
        taken = np.flatnonzero((free & (clock[ON] > 0.5)).ravel())
        place = where[self.blocks.integer[:, JOB].ravel()[taken]]  # which lane takes which trial depends on the threads
        self.slots[place], self.trial[where] = taken, trial

    def step(self) -> None:
        """Make one move in every trial that runs."""
        self._move(1)

    def _moving(self, seed: int) -> Callable[[int], None]:
        """Give what moves trials of a seed on; none begins meanwhile."""
        jobs, queue = np.zeros((1, 2), np.int32), np.zeros(2, np.int32)
        return self.blocks.prepared(self._table, jobs, queue, self._results, self._measured, seed)

    @property
    def _clock(self) -> np.ndarray:
        """Give a view of the blocks' clocks: [row, block, lane]."""
        return self.blocks.clock.transpose(1, 0, 2)

    def _lanes(self, where: Any) -> tuple[np.ndarray, np.ndarray]:
        slots = self.slots[where]
        return slots // LANES, slots % LANES

    def age(self) -> np.ndarray:
        """Count each trial's ticks: [place]."""
        return self._clock[AGE][self._lanes(slice(None))].astype(np.int64)

    def ended(self) -> np.ndarray:
        """Tell which trials have just ended: [place], bool."""
        return self._clock[DONE][self._lanes(slice(None))] > 0.5

    def count(self, kind: Kind) -> int:
        """Count the agents of a kind in a trial."""
        return int(getattr(self.scenario, kind).count)

    def _view(self, kind: Kind) -> np.ndarray:
        """Give a view of a kind's agents: [block, agent, row, lane]."""
        rows, count = self.blocks.layout.agent_rows[kind], self.count(kind)
        return getattr(self.blocks, kind)[: self.blocks.blocks * count * rows].reshape(-1, count, rows, LANES)

    def tell(self, kind: Kind, orders: np.ndarray) -> None:
        """Write down what agents are told: [place, agent, number]."""
        blocks, count = self.blocks.blocks, self.count(kind)
        told = np.zeros((blocks * LANES, count, orders.shape[-1]), self.blocks.dtype)
        told[self.slots] = orders
        first = self.blocks.layout.commands[kind][0]
        by_block = told.reshape(blocks, LANES, count, -1).transpose(0, 2, 3, 1)
        self._view(kind)[:, :, first : first + orders.shape[-1]] = by_block

    def rows(self, kind: Kind, rows: list[int]) -> np.ndarray:
        """Copy numbers of all agents of a kind: [place, agent, row]."""
        block, lane = self._lanes(slice(None))
        return self._view(kind)[block, :, :, lane][:, :, rows]

    def row(self, kind: Kind, row: int) -> np.ndarray:
        """Copy one number of all agents of a kind: [place, agent]."""
        block, lane = self._lanes(slice(None))
        return self._view(kind)[:, :, row][block, :, lane]

    def moments(self, place: int) -> tuple[Moment, Moment]:
        """Give prey and predators of one trial as they are now, as one tick of a recording."""
        block, lane = divmod(int(self.slots[place]), LANES)
        own, layout = self.blocks.layout.rows, self.blocks.layout
        now: dict[Kind, np.ndarray] = {kind: self._view(kind)[block, :, :, lane].T for kind in ("prey", "predators")}

        def vectors(kind: Kind, places: list[int]) -> np.ndarray:
            told = now[kind][places].T.astype(np.float64)
            told[now[kind][own.alive] < 0.5] = np.nan
            return told

        def moment(kind: Kind, other: Kind) -> Moment:
            memory = {p.part.name: _memory(p, now[kind]) for p in layout.parts(kind, "strategy")}
            position, velocity = vectors(kind, own.place), vectors(kind, own.motion)
            state = named(self.scenario, kind, position, velocity, vectors(other, own.place), memory)
            fate = np.array(FATES)[now[kind][own.fate].astype(int)]
            return Moment(position, velocity, fate, state, grouped(self.scenario, kind, self.count(kind)))

        return moment("prey", "predators"), moment("predators", "prey")

    def obstacles(self, place: int) -> tuple[np.ndarray, np.ndarray]:
        """Give the obstacles' centres and radii of one trial: [obstacle, dim] and [obstacle], m."""
        block, lane = divmod(int(self.slots[place]), LANES)
        count, rows = self.scenario.obstacles.count, self.blocks.layout.obstacle_rows
        own = self.blocks.obstacles[: self.blocks.blocks * count * rows].reshape(-1, count, rows, LANES)
        numbers = own[block, :, :, lane].astype(np.float64) if count else np.zeros((0, rows))
        return numbers[:, :-1], numbers[:, -1]


def _memory(part: Any, rows: np.ndarray) -> dict[str, np.ndarray]:
    return {name: rows[row].copy() for name, row in zip(part.memory, part.memory_rows, strict=True)}


def _check(scenario: Scenario) -> None:
    """Refuse what is not run tick by tick in lanes. Errors: ScenarioError."""
    if engine_of(scenario) == "grid":
        raise ScenarioError("world.neighbours: an environment compares all pairs; set it to 'all-pairs', with fewer agents")
    if scenario.prey.goal_by == "path":
        raise ScenarioError("prey.goal_by: an environment has no planned ways; set it to 'line'")
    for name in registry.parts("predators", scenario.predators.strategy) if scenario.predators.count else ():
        live = registry.load("predators", name).live
        if live and scenario.predators.weights[live]:
            raise ScenarioError(f"predators.weights.{live}: works in single trials and films only; set it to 0")
