"""State: prey, predators and obstacles of large swarms in grids of their own, and what happens to them in a tick."""

from collections.abc import Callable
from typing import Any

import numpy as np

from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine import finite
from tiswarm.engine.choice import reach_of
from tiswarm.engine.swarms import clock, compiled, initial, means, transfer
from tiswarm.engine.swarms.compiled import SwarmKernels
from tiswarm.engine.swarms.population import Population, space_of
from tiswarm.scenario.model import Scenario
from tiswarm.simd import philox, runtime
from tiswarm.simd.launch import prepared
from tiswarm.simd.runtime import EIGHT, LANES
from tiswarm.space.cell_list import Grid

SMALL = 2_048
"""Up to so many agents one thread is done before a second one has woken."""

ALIVE, ARRIVED, CAPTURED, CRASHED = range(4)


class SwarmState:
    """Trials of a scenario with any number of agents, tick by tick.

    age: moves made so far. ticks: how many it may make. counts: [trial, (alive, arrived, captured, crashed)] of the prey.
    ended: [trial], bool; ended_at, first_arrival, last_arrival: [trial], ticks, 0 where that has not happened yet.
    """

    def __init__(self, scenario: Scenario, layout: ParameterTable, seed: int, trial: int, states: initial.States) -> None:
        """Put everybody into grids. trial: number of the first trial. Errors: ValueError for numbers that are not finite."""
        types, trials = runtime.types(), states["prey"][0].shape[0]
        self.scenario, self.seed, self.trial = scenario, seed, trial
        self.ticks, self.age = scenario.world.ticks, 0
        self._layout = layout
        self._crowds = {}
        for kind, (position, velocity) in states.items():
            grid = self._grid(kind, position, velocity)
            kept = transfer.kept_rows(layout, kind) if kind != "obstacles" else []
            cold = runtime.aligned((trials, max(position.shape[1], 1), len(kept)), types.dtype)
            self._crowds[kind] = Population(grid, cold, kept)
        self._prey, self._predators, self._obstacles = (self._crowds[kind] for kind in ("prey", "predators", "obstacles"))
        self._numbers = initial.numbers_of(scenario, layout)
        self._kernels = self._built()
        own = self._kernels.contacts
        self._judged_by = initial.numbers_of(scenario, own.layout) if own else self._numbers
        self._scratch = runtime.aligned((transfer.CHUNKS * transfer.scratch_rows(layout), LANES), types.dtype)
        prey = self._prey.grid
        dim, pieces = scenario.world.dim, -(-prey.slots // EIGHT // means.PIECE)
        self._sums = runtime.aligned((pieces * trials * (2 * dim + 1), EIGHT), types.dtype)
        self._means = np.zeros(trials * (2 * dim + 2), types.dtype)
        self._order = np.zeros(trials * max(prey.count, 1), np.int32)
        self._marks = [np.zeros(crowd.grid.total, types.dtype) for crowd in (self._prey, self._predators)]
        self._tally = np.zeros((prey.total // LANES, 4), np.int32)
        self.counts = np.zeros((trials, 4), np.int64)
        self.counts[:, ALIVE] = prey.alive()
        self.ended = np.zeros(trials, bool)
        self.ended_at, self.first_arrival, self.last_arrival = np.zeros((3, trials), np.int64)
        alive = layout.rows.alive
        if self.mortal:
            for crowd in (self._prey, self._predators):
                crowd.row(alive)[:] = 1
                crowd.row(alive)[:, : crowd.grid.count] = np.isfinite(crowd.grid.gathered(slice(0, 1))[..., 0])
        self._clock = np.zeros(clock.CLOCK, np.int32)
        self._seen = np.zeros(trials, types.dtype)
        self._clock[[clock.FIRST, clock.KEY_LOW, clock.KEY_HIGH]] = np.array(
            [self.trial, *philox.seed_words(self.seed)], np.uint32
        ).view(np.int32)
        self._ready: dict[str, Callable[..., None]] = {}
        self._begin()
        self._judge(0)

    def _grid(self, kind: str, position: np.ndarray, velocity: np.ndarray) -> Grid:
        """Give a grid with the agents of a kind in it: [trial, agent, dim], m and m/s."""
        trials, count = position.shape[:2]
        extra = len(self._layout.shown(kind)) if kind != "obstacles" else 0
        grid = Grid(space_of(self.scenario, kind), reach_of(self.scenario, kind), count, trials, extra)
        grid.place(position, velocity)
        return grid

    @property
    def mortal(self) -> bool:
        """Tell whether anybody may die or arrive."""
        return self._layout.structure.mortal

    def _built(self) -> SwarmKernels:
        return compiled.of(self._layout, {kind: crowd.grid for kind, crowd in self._crowds.items()})

    def _begin(self) -> None:
        """Give memories their first values, and headings to unicycles."""
        if self._kernels.tick.starts:
            self._revise("begin", self._prey)
        if "predators" in self._layout.structure.frame.unicycles and self._layout.structure.hunted:
            self._revise("face", self._predators)

    def renumber(self, scenario: Scenario) -> None:
        """Take over the numbers of a scenario of the same structure and counts; they judge the state of now.

        Where agents now look farther or less far, or the world has another size, they are put into cells anew, in the order
        of their numbers; everywhere else no array changes but the numbers.
        """
        before, self.scenario = self.scenario, scenario
        self.ticks = scenario.world.ticks
        self._numbers[:] = initial.numbers_of(scenario, self._layout)
        for kind, crowd in self._crowds.items():
            if (space_of(before, kind), reach_of(before, kind)) != (space_of(scenario, kind), reach_of(scenario, kind)):
                self._regrid(kind, crowd)
        self._kernels = self._built()
        if self._kernels.contacts:
            self._judged_by[:] = initial.numbers_of(scenario, self._kernels.contacts.layout)
        if self.age == 0:
            self._begin()
        self._judge(min(self.age, 1))

    def _regrid(self, kind: str, crowd: Population) -> None:
        dim = self.scenario.world.dim
        state = crowd.grid.gathered(slice(0, None))
        crowd.grid = self._grid(kind, state[..., :dim], state[..., dim : 2 * dim])
        crowd.grid.show(np.nan_to_num(state[..., 2 * dim :]))
        self._ready.clear()

    @property
    def _tools(self) -> tuple[np.ndarray, np.ndarray]:
        return self._scratch, self._numbers

    @property
    def grid(self) -> Grid:
        """Give the prey's grid."""
        return self._prey.grid

    @property
    def trials(self) -> int:
        """Count the trials."""
        return self._prey.grid.trials

    @property
    def nbytes(self) -> int:
        """Count the bytes of all agents' arrays."""
        return sum(crowd.grid.nbytes + crowd.cold.nbytes for crowd in self._crowds.values())

    def step(self, ticks: int = 1) -> None:
        """Run some ticks; small swarms that meet nobody run them in one go, which costs much less than one by one."""
        grid = self._prey.grid
        if not self._plain:
            for _ in range(ticks):
                self._tick()
            return
        arrays = (*self._prey.arrays, grid.rows, *self._tools, self._means, self._clock)
        self._clock[clock.AGE] = self.age
        if grid.total <= SMALL:
            self._launch("run_plain", *arrays, ticks)
            self.age += ticks
        else:
            for _ in range(ticks):
                self._launch("move_plain", *arrays)
                grid.sort()
                self.age += 1
                self._clock[clock.AGE] = self.age
        self._judge(1)

    @property
    def _plain(self) -> bool:
        """Tell whether prey meet nobody but each other, look for nobody else and remember nothing."""
        own, verlet = self._kernels.tick, self._layout.structure.frame.verlet
        return not (self.mortal or self._prey.kept or verlet or own.averages or own.ranks or own.scans)

    def _tick(self) -> None:
        """Let the prey move, then the predators, then judge: as kernel.py does."""
        own, verlet = self._kernels.tick, self._layout.structure.frame.verlet
        hunted = self._layout.structure.hunted
        counts = (self._prey.grid.count, self._predators.grid.count)
        self._clock[clock.AGE] = self.age
        if verlet:
            self._drift("prey")
        self._average()
        if own.ranks:
            self._launch("rank", self._prey.grid.whole, self._order, self._prey.grid.count)
        self._launch("move_prey", *self._everything("prey"), *self._tools, self._means, self._clock, *counts)
        self._prey.grid.sort()
        if own.remembers:
            self._remember()
        if hunted:
            if verlet:
                self._drift("predators")
            self._average()
            if own.ranks:
                self._launch("rank", self._prey.grid.whole, self._order, self._prey.grid.count)
            self._launch("move_predators", *self._everything("predators"), *self._tools, self._means, self._clock, *counts)
            self._predators.grid.sort()
        self.age += 1
        self._judge(1)

    def _kernel(self, name: str) -> Any:
        kind = self._kernels.contacts if name in ("judge", "cull_prey", "cull_predators") else self._kernels.tick
        return getattr(kind, name)

    def _launch(self, name: str, *arguments: np.ndarray | int) -> None:
        """Run a kernel on arrays that stay where they are, and whole numbers behind them: the call is made ready once."""
        if name not in self._ready:
            self._ready[name] = prepared(self._kernel(name), *arguments, precision=self._prey.grid.precision)
        self._ready[name](*(each for each in arguments if isinstance(each, int)))

    def _everything(self, moving: str) -> tuple[np.ndarray, ...]:
        prey, predators = self._prey, self._predators
        return (
            *prey.arrays,
            prey.cold.ravel(),
            self._order,
            *predators.arrays,
            predators.cold.ravel(),
            self._crowds[moving].grid.rows,
            *self._obstacles.arrays,
        )

    def _drift(self, kind: str) -> None:
        grid = self._crowds[kind].grid
        self._launch(f"drift_{kind}", grid.agents, grid.whole, grid.reals, self._numbers)
        grid.sort()

    def _average(self) -> None:
        if self._kernels.tick.averages:
            grid = self._prey.grid
            self._launch("average", grid.agents, grid.whole, self._sums, self._means, self._numbers)

    def _remember(self) -> None:
        prey, rows = self._prey, self._layout.rows
        if rows.seen in prey.kept:
            self._seen[:] = (prey.row(rows.seen) * prey.row(rows.alive)).sum(axis=1)
        self._revise("remember", prey)

    def _revise(self, name: str, crowd: Population) -> None:
        arrays = (crowd.grid.agents, crowd.grid.whole, crowd.cold.ravel())
        self._launch(name, *arrays, *self._tools, self._seen, crowd.grid.count)

    def _judge(self, moved: int) -> None:
        """Let agents die and arrive, and take them out of their cells."""
        before = self.counts[:, ALIVE].copy()
        if self.mortal:
            prey, predators = self._prey, self._predators
            hunters = predators.row(self._layout.rows.alive).sum()
            self._clock[clock.MOVED] = moved
            self._launch(
                "judge",
                *prey.arrays,
                prey.cold.ravel(),
                *predators.arrays,
                predators.cold.ravel(),
                *self._obstacles.arrays,
                self._scratch,
                self._judged_by,
                *self._marks,
                self._tally.ravel(),
                self._clock,
                prey.grid.count,
                predators.grid.count,
                len(prey.kept),
                len(predators.kept),
            )
            tally = self._tally.reshape(self.trials, -1, 4).sum(axis=1)
            self.counts[:, ALIVE] = tally[:, ALIVE]
            self.counts[:, ARRIVED:] += tally[:, ARRIVED:]
            arrived = tally[:, ARRIVED] > 0
            self.first_arrival[arrived & (self.first_arrival == 0)] = self.age
            self.last_arrival[arrived] = self.age
            if (self.counts[:, ALIVE] != before).any():
                self._cull("prey")
            if predators.row(self._layout.rows.alive).sum() != hunters:
                self._cull("predators")
        over = (self.counts[:, ALIVE] == 0) | (self.age >= self.ticks)
        self.ended_at[over & ~self.ended] = min(self.age, self.ticks)
        for trial in np.flatnonzero(over & ~self.ended):
            self._check_finite(int(trial))
        self.ended |= over

    def _check_finite(self, trial: int) -> None:
        """Raise NotFiniteError if anybody of a trial that ends is nowhere."""
        for kind in ("prey", "predators"):
            grid = self._crowds[kind].grid
            own = slice(trial * grid.slots, trial * grid.slots + int(grid.alive()[trial]))
            state = np.full((grid.slots, 2 * self.scenario.world.dim), 0.0)
            state[grid.numbers[trial, : own.stop - own.start]] = grid.agents[own, : state.shape[1]]
            finite.check(self.scenario, self.trial + trial, self.age, kind, state, np.ones(len(state), bool))

    def _cull(self, kind: str) -> None:
        crowd = self._crowds[kind]
        self._launch(f"cull_{kind}", *crowd.arrays, crowd.cold.ravel(), crowd.grid.count, len(crowd.kept))
        crowd.grid.sort()
