"""Swarm: large swarms, one or many at once; eight agents that follow each other in cell order are the lanes of one thread."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from operator import index
from types import SimpleNamespace
from typing import Any

import numpy as np

from tiswarm import carry, observe, registry, rng, runtime, seeds, spawn, stride, verdict, visit
from tiswarm.cells import Boundary, Space
from tiswarm.grid import Grid
from tiswarm.launch import prepared
from tiswarm.layout import Layout, Structure
from tiswarm.neighbours import check, reach_of
from tiswarm.recording import FATES, Recording
from tiswarm.recording import Swarm as Moment
from tiswarm.runtime import LANES
from tiswarm.scenario import Scenario
from tiswarm.start import Start
from tiswarm.states import grouped, named

SMALL = 2_048
"""Up to so many agents one thread is done before a second one has woken."""

AT_ONCE = 262_144
"""Agents of trials that run at once: they fill both cores, and not the memory."""

ALIVE, ARRIVED, CAPTURED, CRASHED = range(4)

Paths = tuple[np.ndarray, np.ndarray]

_built: dict[tuple[Any, ...], SimpleNamespace] = {}


@dataclass
class _Crowd:
    """Agents of one kind: their grid, and cold rows by number: [trial, agent, column], see carry.py."""

    grid: Grid
    cold: np.ndarray
    kept: list[int]

    @property
    def arrays(self) -> tuple[np.ndarray, ...]:
        return self.grid.agents, self.grid.whole, self.grid.reals

    def row(self, row: int) -> np.ndarray:
        """Give a view of a row of the agents by number: [trial, agent]."""
        return self.cold[..., self.kept.index(row)]


class Swarm:
    """Trials of a scenario with any number of agents, tick by tick; positions are read when they are asked for.

    A single trial can be filmed while it runs (`render.film(Swarm(scenario), path)`).

    age: moves made so far. ticks: how many it may make. counts: [trial, (alive, arrived, captured, crashed)] of the prey.
    ended, first_arrival, last_arrival: [trial], ticks; 0 before anybody arrived.
    """

    def __init__(
        self, scenario: Scenario, seed: int = 0, trials: int = 1, trial: int = 0, start: Start | Paths | None = None
    ) -> None:
        """Draw the starts of `trials` trials from number `trial` on, the same as in a batch, or take an explicit one.

        start: one for all trials; or positions and velocities of prey alone, [trial, agent, dim] each, m and m/s, NaN for those
        who are not there: trials and agents are then counted there.

        Errors: ScenarioError for what needs the trials of few agents (`neighbours = "all-pairs"`); ValueError for numbers that
        are not finite.
        """
        self.seed, self.trial, self.age = index(seed), index(trial), 0
        if isinstance(start, tuple):
            start = tuple(np.asarray(each, np.float64) for each in start)
            if start[0].ndim != 3 or start[0].shape != start[1].shape or start[0].shape[2] != scenario.world.dim:
                told = " and ".join(str(each.shape) for each in start)
                raise ValueError(f"start: positions and velocities {told} need [trial, agent, dim]")
            trials = start[0].shape[0]
        elif start is not None:
            counts = (len(start.prey_position), len(start.predator_position), len(start.obstacle_radius))
            paths = ("prey.count", "predators.count", "obstacles.count")
            scenario = scenario.replaced(dict(zip(paths, counts, strict=True)))
        check(scenario)
        self.scenario, self.ticks = scenario, scenario.world.ticks
        structure = Structure.of([scenario], scenario.predators.count)
        self._layout = Layout(structure, runtime.types().lanes)
        self._mortal = bool(structure.hunted or scenario.obstacles.count or scenario.target.present)
        self._prepare(index(trials), start)

    def _states(self, trials: int, start: Start | Paths | None) -> seeds.States:
        """Give where everybody starts."""
        if isinstance(start, Start):
            return seeds.given(start, trials)
        states = seeds.drawn(self.scenario, self._layout, self.seed, self.trial, trials)
        return states if start is None else {**states, "prey": start}

    def _prepare(self, trials: int, start: Start | Paths | None) -> None:
        scenario, layout, types = self.scenario, self._layout, runtime.types()
        states = self._states(trials, start)
        self._crowds = {}
        for kind, (position, velocity) in states.items():
            extra = len(layout.shown(kind)) if kind != "obstacles" else 0
            grid = Grid(space_of(scenario, kind), reach_of(scenario, kind), position.shape[1], trials, extra)
            grid.place(position, velocity)
            kept = carry.kept_rows(layout, kind, mortal=self._mortal) if kind != "obstacles" else []
            cold = runtime.aligned((trials, max(position.shape[1], 1), len(kept)), types.dtype)
            self._crowds[kind] = _Crowd(grid, cold, kept)
        self._prey, self._predators, self._obstacles = (self._crowds[kind] for kind in ("prey", "predators", "obstacles"))
        self._kernels = _kernels(layout, {kind: crowd.grid for kind, crowd in self._crowds.items()}, self._mortal)
        row = layout.table([scenario])[0].astype(types.dtype)
        self._numbers = runtime.aligned((len(row), LANES), types.dtype)
        self._numbers[:] = row[:, None]
        deepest = max(layout.agent_rows.values())
        self._scratch = runtime.aligned((carry.CHUNKS * deepest, LANES), types.dtype)
        prey = self._prey.grid
        dim, pieces = scenario.world.dim, -(-prey.slots // LANES // stride.PIECE)
        self._sums = runtime.aligned((pieces * trials * (2 * dim + 1), LANES), types.dtype)
        self._means = np.zeros(trials * (2 * dim + 2), types.dtype)
        self._order = np.zeros(trials * max(prey.count, 1), np.int32)
        self._marks = [np.zeros(crowd.grid.total, types.dtype) for crowd in (self._prey, self._predators)]
        self._tally = np.zeros((prey.total // LANES, 4), np.int32)
        self.counts = np.zeros((trials, 4), np.int64)
        self.counts[:, ALIVE] = prey.alive()
        self.ended = np.zeros(trials, bool)
        self.ended_at, self.first_arrival, self.last_arrival = np.zeros((3, trials), np.int64)
        alive = layout.rows.alive
        if self._mortal:
            for crowd in (self._prey, self._predators):
                crowd.row(alive)[:] = 1
                crowd.row(alive)[:, : crowd.grid.count] = np.isfinite(crowd.grid.gathered(slice(0, 1))[..., 0])
        if self._kernels.starts:
            at = self._prey
            self._kernels.begin(at.grid.agents, at.grid.whole, at.cold.ravel(), *self._tools, at.grid.count)
        if "predators" in layout.structure.frame.unicycles and layout.structure.hunted:
            at = self._predators
            self._kernels.face(at.grid.agents, at.grid.whole, at.cold.ravel(), *self._tools, at.grid.count)
        self._clock = np.zeros(stride.CLOCK, np.int32)
        self._seen = np.zeros(trials, types.dtype)
        self._clock[[stride.FIRST, stride.KEY_LOW, stride.KEY_HIGH]] = np.array(
            [self.trial, *rng.seed_words(self.seed)], np.uint32
        ).view(np.int32)
        self._ready: dict[str, Callable[..., None]] = {}
        self._judge(0)

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
        arrays = (*self._prey.arrays, grid.rows, *self._tools)
        if grid.total <= SMALL:
            self._launch("run_plain", *arrays, ticks)
        else:
            for _ in range(ticks):
                self._launch("move_plain", *arrays)
                grid.sort()
        self.age += ticks
        self._judge(1)

    @property
    def _plain(self) -> bool:
        """Tell whether prey meet nobody but each other and remember nothing."""
        verlet = self._layout.structure.frame.verlet
        return not (self._mortal or self._prey.kept or verlet or self._kernels.averages)

    def _tick(self) -> None:
        """Let the prey move, then the predators, then judge: as trials.py does."""
        kernels, verlet = self._kernels, self._layout.structure.frame.verlet
        hunted = self._layout.structure.hunted
        counts = (self._prey.grid.count, self._predators.grid.count)
        self._clock[stride.AGE] = self.age
        if verlet:
            self._drift("prey")
        self._average()
        if kernels.ranks:
            self._launch("rank", self._prey.grid.whole, self._order, self._prey.grid.count)
        self._launch("move_prey", *self._everything("prey"), *self._tools, self._means, self._clock, *counts)
        self._prey.grid.sort()
        if kernels.remembers:
            self._remember()
        if hunted:
            if verlet:
                self._drift("predators")
            self._average()
            if kernels.ranks:
                self._launch("rank", self._prey.grid.whole, self._order, self._prey.grid.count)
            self._launch("move_predators", *self._everything("predators"), *self._tools, self._means, self._clock, *counts)
            self._predators.grid.sort()
        self.age += 1
        self._judge(1)

    def _launch(self, name: str, *arguments: np.ndarray | int) -> None:
        """Run a kernel on arrays that stay where they are, and whole numbers behind them: the call is made ready once."""
        if name not in self._ready:
            self._ready[name] = prepared(getattr(self._kernels, name), *arguments)
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
        if self._kernels.averages:
            grid = self._prey.grid
            self._launch("average", grid.agents, grid.whole, self._sums, self._means)

    def _remember(self) -> None:
        prey, rows = self._prey, self._layout.rows
        if rows.seen in prey.kept:
            self._seen[:] = (prey.row(rows.seen) * prey.row(rows.alive)).sum(axis=1)
        arrays = (prey.grid.agents, prey.grid.whole, prey.cold.ravel())
        self._launch("remember", *arrays, *self._tools, self._seen, prey.grid.count)

    def _judge(self, moved: int) -> None:
        """Let agents die and arrive, and take them out of their cells."""
        before = self.counts[:, ALIVE].copy()
        if self._mortal:
            prey, predators = self._prey, self._predators
            hunters = predators.row(self._layout.rows.alive).sum()
            self._clock[stride.MOVED] = moved
            self._launch(
                "judge",
                *prey.arrays,
                prey.cold.ravel(),
                *predators.arrays,
                predators.cold.ravel(),
                *self._obstacles.arrays,
                *self._tools,
                *self._marks,
                self._tally.ravel(),
                self._clock,
                prey.grid.count,
                predators.grid.count,
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
        self.ended_at[over & ~self.ended] = self.age
        self.ended |= over

    def _cull(self, kind: str) -> None:
        crowd = self._crowds[kind]
        self._launch(f"cull_{kind}", *crowd.arrays, crowd.cold.ravel(), crowd.grid.count)
        crowd.grid.sort()

    def position(self, kind: str = "prey") -> np.ndarray:
        """Give where the agents are: [trial, agent, dim], m, NaN for those who are gone."""
        return self._crowds[kind].grid.gathered(slice(0, self.scenario.world.dim))

    def velocity(self, kind: str = "prey") -> np.ndarray:
        """Give their velocity: [trial, agent, dim], m/s, NaN for those who are gone."""
        dim = self.scenario.world.dim
        return self._crowds[kind].grid.gathered(slice(dim, 2 * dim))

    def fate(self, kind: str = "prey") -> np.ndarray:
        """Name what became of each agent so far: [trial, agent]."""
        crowd = self._crowds[kind]
        if not self._mortal:
            return np.full((self.trials, crowd.grid.count), FATES[0])
        return np.array(FATES)[crowd.row(self._layout.rows.fate)[:, : crowd.grid.count].astype(int)]

    def memory(self, kind: str) -> dict[str, dict[str, np.ndarray]]:
        """Give the agents' memory: strategy -> name -> [trial, agent]."""
        crowd = self._crowds[kind]
        rows = {
            p.part.name: {
                name: crowd.row(row)[:, : crowd.grid.count] for name, row in zip(p.memory, p.memory_rows, strict=True)
            }
            for p in self._layout.parts(kind, "strategy")
        }
        return {name: memory for name, memory in rows.items() if memory}

    @property
    def obstacle_position(self) -> np.ndarray:
        """Give the centres of the first trial's obstacles: [obstacle, dim], m."""
        here = self.position("obstacles")[0]
        return here[np.isfinite(here[:, 0])]

    @property
    def obstacle_radius(self) -> np.ndarray:
        """Give their radii: [obstacle], m."""
        radii = self.velocity("obstacles")[0, :, 0]
        return radii[np.isfinite(radii)]

    def moment(self, kind: registry.Kind) -> Moment:
        """Give the agents of the first trial as they are now, as one tick of a recording: arrays [agent, ...]."""
        other = "predators" if kind == "prey" else "prey"
        position = self.position(kind)[0]
        memories = {name: {key: rows[0] for key, rows in each.items()} for name, each in self.memory(kind).items()}
        state = named(self.scenario, kind, position, self.position(other)[0], memories)
        return Moment(position, self.velocity(kind)[0], self.fate(kind)[0], state, grouped(self.scenario, kind, len(position)))

    def record(self) -> Recording:
        """Run the first trial to its end and keep its path."""
        paths = [
            Moment(
                np.stack([each.position for each in own]),
                np.stack([each.velocity for each in own]),
                own[-1].fate,
                np.stack([each.state for each in own]),
                np.stack([each.group for each in own]),
            )
            for own in zip(*self, strict=True)
        ]
        return Recording(self.scenario, self.seed, self.trial, *paths, self.obstacle_position, self.obstacle_radius)

    def __iter__(self) -> Iterator[tuple[Moment, Moment]]:
        """Run the first trial to its end: give prey and predators now, then after each tick."""
        yield self.moment("prey"), self.moment("predators")
        while not self.ended[0]:
            self.step()
            yield self.moment("prey"), self.moment("predators")


def space_of(scenario: Scenario, kind: str) -> Space:
    """Give the space of a kind's grid. In open worlds prey fly anywhere; of the few others, those outside are in edge cells."""
    world = scenario.world
    boundary: Boundary = world.boundary
    return Space(tuple(world.size), "walls" if boundary == "open" and kind != "prey" else boundary)


def _kernels(layout: Layout, grids: dict[str, Grid], mortal: bool) -> SimpleNamespace:
    """Give the kernels for a structure and kinds of grids, built once per runtime."""
    near = SimpleNamespace(**{kind: grid.funcs for kind, grid in grids.items()})
    key = (runtime.generation(), layout.structure, mortal, *(id(funcs) for funcs in vars(near).values()))
    if key not in _built:
        types = runtime.types()
        see = observe.build(layout, types)
        senses = visit.build(layout, types, see, near)
        uniform = spawn.build(layout, types).uniform
        kernels = stride.build(layout, types, see, senses, near, uniform, mortal)
        kernels.ranks = any(p.strategy.leads for p in layout.parts("prey", "strategy")) or any(
            "observe" in p.own for p in layout.parts("predators", "strategy")
        )
        strategies = layout.parts("prey", "strategy")
        kernels.averages = layout.structure.hunted or any({"steer", "integrate"} & set(p.own) for p in strategies)
        if mortal:
            judging = verdict.build(layout, types, see, senses, near)
            vars(kernels).update(vars(judging))
        _built[key] = kernels
    return _built[key]


def outcomes(scenario: Scenario, trials: int, seed: int, report: Callable[[int], None]) -> dict[str, np.ndarray]:
    """Run trials 0, 1, ... through a grid to their ends: name of an outcome (trials.OUTCOMES) -> [trial].

    report: called with the number of trials done.
    """
    at_once = max(AT_ONCE // max(scenario.prey.count, scenario.predators.count, scenario.obstacles.count, 1), 1)
    found: list[dict[str, np.ndarray]] = []
    for first in range(0, trials, at_once):
        swarm = Swarm(scenario, seed, min(at_once, trials - first), first)
        while not swarm.ended.all():
            swarm.step()
        names = ("alive", "arrived", "captured", "crashed")
        counted = {name: swarm.counts[:, k] for k, name in enumerate(names)}
        times = {"ticks": swarm.ended_at, "first_arrival": swarm.first_arrival, "last_arrival": swarm.last_arrival}
        found.append(counted | times)
        report(first + swarm.trials)
    return {name: np.concatenate([each[name] for each in found]).astype(np.int32) for name in found[0]}
