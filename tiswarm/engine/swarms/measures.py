"""Measures: what is measured of large swarms while they run, as measures/recorded.py defines it.

The kernels are in measured_agents.py and measured_pairs.py. Swarms know nothing of them: they look at a swarm's
arrays between two ticks.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from tiswarm.dynamics import views
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.choice import reach_of
from tiswarm.engine.swarms import initial, measured_agents, measured_pairs, transfer
from tiswarm.engine.swarms.simulation import Swarm
from tiswarm.measures.formulas import AHEAD, COUNT, ENERGY, SPEED
from tiswarm.measures.ground import free_cells, variation
from tiswarm.scenario.measures import COVERED, PEAKS, SETTLED, STILL, SWEPT, TRAPS
from tiswarm.scenario.model import Scenario
from tiswarm.simd import runtime
from tiswarm.simd.lanes import TINY
from tiswarm.simd.launch import prepared
from tiswarm.simd.runtime import EIGHT, LANES, Func
from tiswarm.space.cell_list import Grid

MOTION = {"polarisation", "milling", "speed", "settling-time", "kinetic"}
PAIRS = {"nearest", "least-distance", "overshoot", "potential"}

_built: dict[tuple[Any, ...], dict[str, Func]] = {}


class Measures:
    """What `scenario.measures` names, of the trials of a swarm: make it before the first tick, `take` every state once."""

    def __init__(self, swarm: Swarm) -> None:
        """Take the start."""
        scenario, types = swarm.scenario, runtime.types()
        self._swarm, self._scenario, self._names = swarm, scenario, set(scenario.measures.names)
        self._layout = ParameterTable(Specialisation.of([scenario], scenario.predators.count), types.lanes)
        self._numbers = initial.numbers_of(scenario, self._layout)
        self._search = _search_grid(scenario, swarm.grid) if "groups" in self._names else swarm.grid
        self._kernels = _kernels(self._layout, swarm.grid, self._search)
        self._ready: dict[str, Callable[..., None]] = {}
        trials, dim = swarm.trials, scenario.world.dim
        pieces = -(-swarm.grid.slots // measured_agents.PIECE)
        self._sums = {
            name: runtime.aligned((trials * pieces * columns, EIGHT), types.dtype)
            for name, columns in (("motion", AHEAD + 2 * dim), ("spin", 3), ("pairs", 3))
        }
        self._centres = np.zeros(trials * dim, types.dtype)
        # Of measures that are means: sum and number of states.
        self._totals: dict[str, np.ndarray] = {name: np.zeros((2, trials)) for name in scenario.measures.names}
        self._least = np.full(trials, np.inf)
        self._peaks = {name: np.zeros(trials) for name in PEAKS}
        self._changed = np.zeros(1, np.int32)
        self._slots = np.arange(swarm.grid.total, dtype=np.int32)
        self._labels = self._slots.copy()
        if self._names & set(TRAPS):
            self._scratch = runtime.aligned((transfer.CHUNKS * self._layout.agent_rows["prey"], LANES), types.dtype)
            rows = len(measured_agents.trap_rows(self._layout))
            self._traps = np.zeros((trials, max(swarm.grid.count, 1), rows), types.dtype)
        if self._names & set(SWEPT):
            self._ground = np.concatenate([self._free(trial) for trial in range(trials)])
            self._free_count = np.maximum((self._ground.reshape(trials, -1) >= 0).sum(axis=1), 1)
            self._clean = np.zeros(trials, np.int32)
            self._times = {name: np.full(trials, np.nan) for name in COVERED}
        self.take()

    def take(self) -> None:
        """Measure the state of now."""
        age, names = self._swarm.age, self._names
        if age >= min(self._scenario.measures.after, self._swarm.ticks):
            if names & MOTION:
                self._take_motion()
            if names & PAIRS:
                self._take_pairs()
            if names & {"stalled", "corrected"}:
                self._take_standing()
            if "groups" in names:
                self._take_groups()
        grid = self._swarm.grid
        if names & set(TRAPS):
            arrays = (grid.agents, grid.whole, self._numbers, self._scratch, self._traps.ravel())
            self._launch("watch", *arrays, grid.count, int(age == 0))
        if names & set(SWEPT):
            self._launch("sweep", grid.agents, grid.whole, self._numbers, self._ground, self._clean)
            for name, share in COVERED.items():
                passed = np.isnan(self._times[name]) & (self._share() >= share)
                self._times[name][passed] = age * self._scenario.world.dt

    def values(self) -> dict[str, np.ndarray]:
        """Give each measure as it stands now: [trial], NaN where no state has it; name -> values in the scenario's order."""
        return {name: self._value(name) for name in self._scenario.measures.names}

    def _value(self, name: str) -> np.ndarray:
        if name in COVERED:
            return self._times[name]
        if name == "coverage":
            return self._share()
        if name == "visit-variation":
            visits = np.maximum(self._ground.reshape(self._swarm.trials, -1), 0).astype(np.float64)
            return variation(visits.sum(axis=1), (visits**2).sum(axis=1), self._free_count)
        if name in TRAPS:
            return self._trapped(name)
        if name == "hits":
            ran = np.where(self._swarm.ended, self._swarm.ended_at, self._swarm.age)
            late = ran >= min(self._scenario.measures.after, self._swarm.ticks)
            return np.where(late, self._swarm.hits, np.nan)
        if name == "least-distance":
            return np.where(np.isfinite(self._least), self._least, np.nan)
        total, states = self._totals[name]
        return np.divide(total, states, out=np.full(len(total), np.nan), where=states > 0)

    def _take_motion(self) -> None:
        dim, trials = self._scenario.world.dim, self._swarm.trials
        self._centres[:] = self._origins().ravel()
        sums = self._summed("motion")
        count = sums[:, COUNT]
        share = 1.0 / np.maximum(count, 1.0)
        self._add("polarisation", share * np.linalg.norm(sums[:, AHEAD : AHEAD + dim], axis=1), count > 0)
        self._add("speed", share * sums[:, SPEED], count > 0)
        self._add("kinetic", sums[:, ENERGY], count > 0)
        if "settling-time" in self._names:
            pace, last = share * sums[:, SPEED], self._totals["settling-time"][0]
            moving = pace > SETTLED * self._peak("settling-time", pace, count > 0)
            now = self._swarm.age * self._scenario.world.dt
            self._keep("settling-time", np.where(moving, now, last), count > 0)
        if "milling" in self._names:
            self._centres[:] += (share[:, None] * sums[:, AHEAD + dim :]).reshape(trials * dim)
            self._add("milling", share * np.linalg.norm(self._summed("spin"), axis=1), count > 0)

    def _origins(self) -> np.ndarray:
        """Give from where places are counted: [trial, dim], m: the first living prey's place in a periodic world."""
        grid, dim = self._swarm.grid, self._scenario.world.dim
        if not grid.space.wraps:
            return np.zeros((grid.trials, dim))
        here = np.arange(grid.slots) < grid.alive()[:, None]
        first = np.where(here, grid.numbers, np.iinfo(np.int32).max).argmin(axis=1)
        return grid.agents[: grid.total].reshape(grid.trials, grid.slots, -1)[np.arange(grid.trials), first, :dim]

    def _take_pairs(self) -> None:
        prey, count = self._scenario.prey, self._swarm.grid.alive()
        pieces = self._pieces("pairs")
        nearest, energy = pieces[:, :, :2].sum(axis=(1, 3)).T
        with np.errstate(divide="ignore"):  # nobody is at an infinite distance
            self._least = np.where(count > 1, np.minimum(self._least, 1 / pieces[:, :, 2].max(axis=(1, 2))), self._least)
        apart = nearest / np.maximum(count, 1)
        self._add("nearest", apart, count > 1)
        self._keep("overshoot", self._peak("overshoot", apart, count > 1) / np.maximum(apart, TINY) - 1.0, count > 1)
        if "potential" in self._names:
            spacing2 = max(prey.spacing**2, TINY)
            rim = max(prey.perception**2, TINY) / spacing2  # all pairs have the energy of those at perception, and more
            rest = prey.spacing**2 * (1 / rim + np.log(rim))
            self._add("potential", energy + 0.5 * count * (count - 1) * rest, count > 0)

    def _take_standing(self) -> None:
        velocity, alive = self._swarm.velocity(), self._swarm.grid.alive()
        fastest2 = np.nan_to_num((velocity**2).sum(axis=-1)).max(axis=1)
        home = (self._swarm.fate() == "arrived").any(axis=1)
        still = fastest2 < (STILL * self._scenario.prey.max_speed) ** 2
        self._add("stalled", still & ~home, alive > 0)
        self._add("corrected", np.zeros(len(alive)), alive > 0)

    def _take_groups(self) -> None:
        grid, search = self._swarm.grid, self._search
        if search is not grid:
            self._launch("refile", grid.agents, grid.whole, search.agents, search.whole, search.reals)
            search.sort()
        self._labels[:] = self._slots
        self._changed[0] = 1
        while self._changed[0]:
            self._changed[0] = 0
            arrays = (search.agents, search.whole, search.reals, self._numbers)
            self._launch("join", *arrays, self._labels, self._changed)
            self._launch("shorten", self._labels, len(self._labels))
        first = (self._labels == self._slots).reshape(search.trials, search.slots)
        alive = search.alive()
        here = np.arange(search.slots) < alive[:, None]
        self._add("groups", (first & here).sum(axis=1), alive > 0)

    def _trapped(self, name: str) -> np.ndarray:
        rows, all_rows = self._layout.rows.trap, measured_agents.trap_rows(self._layout)
        time, spin, most = (
            self._traps[..., all_rows.index(row)].astype(np.float64) for row in (rows.time, rows.spin_sum, rows.most_sum)
        )
        if name == "trapped":
            return (time > 0).mean(axis=1)
        if name == "trapped-time":
            return time.mean(axis=1) * self._scenario.world.dt
        turned, turns = spin.sum(axis=1), most.sum(axis=1)
        return np.divide(turned, turns, out=np.full(len(turned), np.nan), where=turns > 0)

    def _share(self) -> np.ndarray:
        return self._clean / self._free_count

    def _free(self, trial: int) -> np.ndarray:
        """Give the visits of a trial's cells before the first: [cell], 0, or -1 where there is no ground."""
        place, size = self._swarm.position("obstacles")[trial], self._swarm.velocity("obstacles")[trial]
        here, world = np.isfinite(place[:, 0]), self._scenario.world
        free = free_cells(self._scenario.coverage.cell, world.size, world.boundary, place[here], size[here, 0])
        return np.where(free, 0, -1).astype(np.int32).ravel()

    def _add(self, name: str, values: np.ndarray, counted: np.ndarray) -> None:
        if name in self._totals:
            self._totals[name] += np.where(counted, values, 0.0), counted

    def _keep(self, name: str, values: np.ndarray, counted: np.ndarray) -> None:
        """Put values in the place of what was."""
        if name in self._totals:
            total, states = self._totals[name]
            total[counted], states[counted] = values[counted], 1.0

    def _peak(self, name: str, values: np.ndarray, counted: np.ndarray) -> np.ndarray:
        """Give the greatest value of each trial so far: [trial]."""
        self._peaks[name] = np.where(counted, np.maximum(self._peaks[name], values), self._peaks[name])
        return self._peaks[name]

    def _summed(self, name: str) -> np.ndarray:
        """Sum up over the prey of each trial, in one order: [trial, column]."""
        return self._pieces(name).sum(axis=(1, 3))

    def _pieces(self, name: str) -> np.ndarray:
        """Give the sums of each trial's pieces: [trial, piece, column, lane]."""
        grid, sums = self._swarm.grid, self._sums[name]
        self._launch(name, grid.agents, grid.whole, grid.reals, self._numbers, self._centres, sums)
        columns = {"motion": AHEAD + 2 * self._scenario.world.dim, "spin": 3, "pairs": 3}[name]
        return sums.reshape(grid.trials, -1, columns, EIGHT).astype(np.float64)

    def _launch(self, name: str, *arguments: np.ndarray | int) -> None:
        if name not in self._ready:
            self._ready[name] = prepared(self._kernels[name], *arguments, precision=self._swarm.grid.precision)
        self._ready[name](*(each for each in arguments if isinstance(each, int)))


def _search_grid(scenario: Scenario, grid: Grid) -> Grid:
    """Give the grid in which groups are found: the prey's own, or one with larger cells where their distance needs it."""
    if scenario.measures.distance <= reach_of(scenario, "prey"):
        return grid
    return Grid(grid.space, scenario.measures.distance, grid.count, grid.trials)


def _kernels(layout: ParameterTable, grid: Grid, search: Grid) -> dict[str, Func]:
    """Give the kernels for what a structure measures, by name, built once per runtime."""
    key = (runtime.generation(), layout.structure, id(grid.funcs), id(search.funcs))
    if key not in _built:
        types, names = runtime.types(), set(layout.structure.frame.measures)
        near, dim = grid.funcs, len(layout.axes)
        sums = measured_agents.build_pieces(layout, types, near)
        own = {"motion": sums.motion, "spin": sums.spin}
        if names & PAIRS:
            own["pairs"] = measured_pairs.build_pairs(layout, types, near, sums.pieces)
        if "groups" in names:
            own.update(vars(measured_pairs.build_groups(layout, types, search.funcs, sums.body_of)))
            own["refile"] = measured_pairs.build_refile(near, search.funcs, dim)
        if names & set(TRAPS):
            own["watch"] = measured_agents.build_watch(layout, types, views.build(layout, types), near, sums.body_of)
        if names & set(SWEPT):
            own["sweep"] = measured_agents.build_sweep(layout, types, near)
        _built[key] = own
    return _built[key]
