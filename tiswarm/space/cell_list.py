"""Cell list: agents of one or many trials in cell order, so that neighbours are a few contiguous ranges."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import taichi as ti

from tiswarm.simd import launch, runtime
from tiswarm.simd.runtime import LANES, TASK, Func, Types
from tiswarm.space import box, cell_index, counting_sort, traversal
from tiswarm.space.cells import (
    CELLS,
    CHUNKS,
    COUNT_X,
    COUNT_Y,
    COUNT_Z,
    HEAD,
    LONGEST,
    MASK,
    MOST_CHUNKS,
    ONE,
    PER_METRE,
    PERIOD,
    REACH_X,
    REACH_Y,
    REACH_Z,
    SLOTS,
    STRIDE_Y,
    STRIDE_Z,
    TABLE,
    TRIALS,
    CellGrid,
    Space,
    plan,
)
from tiswarm.space.counting_sort import Sorts
from tiswarm.space.traversal import Traversal

ALONE = 16_384
"""Up to so many agents are sorted by one thread: waking others takes longer."""

MOST_ENTRIES = 2**31 - 1


class Grid:
    """Agents of one kind, of one or many trials, in cell order; owns their arrays.

    agents: [2 * slot, number], positions first, then velocities: the agents in cell order, then room for the moved ones.
    whole: head, then per slot the place in the table, the agent's number, the number's copy; then the tables of counts.
    reals: cells per metre and period per axis.
    A trial has `slots` slots, a multiple of LANES; slots without an agent, and agents that are gone, come last.
    """

    def __init__(self, space: Space, reach: float, count: int, trials: int = 1, extra: int = 0) -> None:
        """Allocate a grid for `count` agents in each of `trials`, who see as far as `reach` [m], inf for any distance.

        extra: how many numbers an agent shows to others beyond position and velocity.

        Errors: ValueError for what does not fit into memory.
        """
        types = runtime.types()
        settings = runtime.start()
        self.space, self.count, self.trials, self.precision = space, count, trials, settings.precision
        self.slots = -(-max(count, 1) // LANES) * LANES
        self.plan = plan(space, reach, count, float(np.finfo(types.dtype).eps))
        self.total = self.slots * trials
        self.chunks = 1 if self.total <= ALONE else min(settings.threads, MOST_CHUNKS)
        table = -(-(self.plan.cells * trials + 1) // LANES) * LANES
        entries = HEAD + 3 * self.total + self.chunks * table
        if max(entries, 2 * self.total * 12) > MOST_ENTRIES:
            raise ValueError(f"{trials:,} trials of {count:,} agents are more than a grid can number; use fewer")
        self.funcs = funcs(space, self.plan, extra)
        self.agents = runtime.aligned((2 * self.total, self.funcs.width), types.dtype)
        self.whole = runtime.aligned((entries,), np.int32)
        self.rows = self.whole.reshape(-1, LANES)
        self.reals = np.zeros(6, np.float64)
        flat = space.dimensions == 2
        plan_z = (1, 0, 0) if flat else (self.plan.counts[2], self.plan.strides[1], self.plan.reach[2])
        head = {
            SLOTS: self.slots,
            TRIALS: trials,
            CHUNKS: self.chunks,
            CELLS: self.plan.cells,
            MASK: self.plan.mask,
            LONGEST: self.plan.longest,
            COUNT_X: self.plan.counts[0],
            COUNT_Y: self.plan.counts[1],
            COUNT_Z: plan_z[0],
            STRIDE_Y: self.plan.strides[0],
            STRIDE_Z: plan_z[1],
            REACH_X: self.plan.reach[0],
            REACH_Y: self.plan.reach[1],
            REACH_Z: plan_z[2],
            TABLE: table,
            ONE: 1,
        }
        self.whole[list(head)] = list(head.values())
        self.reals[PER_METRE : PER_METRE + space.dimensions] = self.plan.per_metre
        self.reals[PERIOD : PERIOD + space.dimensions] = space.size
        if self.chunks == 1:
            self._sort = launch.prepared(self.funcs.sort_alone, self.agents, self.whole, self.rows, precision=self.precision)
        else:
            self._sort = launch.prepared(
                self.funcs.sort, self.agents, self.whole, self.rows, self.chunks * TASK, precision=self.precision
            )

    @property
    def nbytes(self) -> int:
        """Count the bytes of all arrays."""
        return self.agents.nbytes + self.whole.nbytes + self.reals.nbytes

    @property
    def numbers(self) -> np.ndarray:
        """Give the agent in each slot, from 0 within its trial: [trial, slot]."""
        return self.whole[HEAD + self.total : HEAD + 2 * self.total].reshape(self.trials, self.slots)

    def place(self, position: np.ndarray, velocity: np.ndarray) -> None:
        """Put agents in: [trial, agent, dim], m and m/s; NaN in both a position and a velocity means gone.

        Errors: ValueError for other numbers that are not finite, or shapes that do not fit.
        """
        dimensions = self.space.dimensions
        shape = (self.trials, self.count, dimensions)
        state = np.concatenate([np.asarray(position, np.float64), np.asarray(velocity, np.float64)], axis=-1)
        if state.shape != (*shape[:2], 2 * dimensions):
            raise ValueError(f"start: positions and velocities need the shape {shape}")
        gone = np.isnan(state).all(axis=-1)
        if not np.isfinite(state[~gone]).all():
            raise ValueError("start: a position or velocity is not finite")
        agents = self.agents[self.total :].reshape(self.trials, self.slots, -1)
        agents[...] = 0
        agents[:, : self.count, : 2 * dimensions] = np.where(gone[..., None], 0, state)
        period = box.period(self.space.size, self.space.boundary).astype(agents.dtype)
        agents[:, : self.count, :dimensions] = box.wrap(agents[:, : self.count, :dimensions], period)
        self.whole[HEAD + 2 * self.total : HEAD + 3 * self.total] = np.tile(np.arange(self.slots, dtype=np.int32), self.trials)
        here = np.zeros((self.trials, self.slots), np.int32)
        here[:, : self.count] = ~gone
        self.whole[HEAD : HEAD + self.total] = here.ravel()
        launch.run(self.funcs.find, self.agents, self.whole, self.reals, self.total, precision=self.precision)
        self.sort()

    def show(self, told: np.ndarray) -> None:
        """Write what agents show beyond position and velocity: [trial, agent, number], by their numbers."""
        agents = self.agents[: self.total].reshape(self.trials, self.slots, -1)
        every = np.zeros((self.trials, self.slots, told.shape[-1]))
        every[:, : self.count] = told
        agents[..., 2 * self.space.dimensions :] = np.take_along_axis(every, self.numbers[..., None].astype(np.int64), axis=1)

    def sort(self) -> None:
        """Bring the moved agents into cell order: their places in the table are known."""
        self._sort()

    def gathered(self, columns: slice) -> np.ndarray:
        """Give some numbers of all agents in the order of their numbers, NaN for those who are gone: [trial, agent, column]."""
        rows = self.agents[: self.total].reshape(self.trials, self.slots, -1)[..., columns].astype(np.float64)
        gone = np.arange(self.slots)[None, :] >= self.alive()[:, None]
        rows[gone] = np.nan
        out = np.empty_like(rows)
        np.put_along_axis(out, self.numbers[..., None].astype(np.int64), rows, axis=1)
        return out[:, : self.count]

    def alive(self) -> np.ndarray:
        """Count the agents that are there: [trial]."""
        table = self.whole[-self.whole[TABLE] :]
        return table[self.plan.cells - 1 :: self.plan.cells][: self.trials] - np.arange(self.trials) * self.slots


@dataclass(frozen=True)
class CellFuncs(Traversal, Sorts):
    """The kernels and funcs for a kind of cell list, the types of its arrays, and what else its users ask."""

    width: int  # numbers of an agent's record
    record: Any
    agent_array: Any
    whole_array: Any
    row_array: Any
    real_array: Any
    find: Func  # replace the marks of the moved agents by their places in the table
    put: Func  # write a block's moved agents behind the sorted ones
    hashed: bool  # whether the table has no end: an open world
    periodic: bool
    count_x: int  # the head's entry with the number of cells along x
    across: Func  # the way between two coordinates, across a periodic edge where that is shorter
    cells_of: Func
    lane_cells: Func
    place_of: Func


def funcs(space: Space, cut: CellGrid, extra: int = 0) -> CellFuncs:
    """Give the kernels and funcs for a kind of grid, built once per runtime."""
    width = 4 * -(-(2 * space.dimensions + extra) // 4)
    kind = (space.dimensions, space.wraps, cut.mask >= 0, cut.narrow, width)
    return runtime.kept(("grid", *kind), lambda: _build(runtime.types(), *kind))


def _build(types: Types, dimensions: int, periodic: bool, hashed: bool, narrow: tuple[bool, ...], width: int) -> CellFuncs:
    record, row = ti.types.vector(width, types.real), ti.types.vector(LANES, ti.i32)
    agent_array = ti.types.ndarray(dtype=record, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)
    row_array = ti.types.ndarray(dtype=row, ndim=1)
    real_array = ti.types.ndarray(dtype=ti.f64, ndim=1)
    at = cell_index.build(types, dimensions, periodic, hashed, narrow)
    order = list(range(LANES))

    @ti.kernel
    def find(agents: agent_array, whole: whole_array, reals: real_array, total: ti.i32):
        """Replace the marks of the moved agents, 1 for those who are there, by their places in the table."""
        for slot in range(total):
            trial = slot // whole[SLOTS]
            place = whole[CELLS] - 1
            if whole[HEAD + slot] == 1:
                place = at.place_of(agents[total + slot], whole, reals)
            whole[HEAD + slot] = trial * whole[CELLS] + place

    @ti.func
    def put(agents: ti.template(), whole: ti.template(), rows: ti.template(), reals: ti.template(), told, block, end):
        """Write a block's moved agents behind the sorted ones; those from slot `end` on are gone.

        told: lanes, a list: positions, velocities, and what else agents show.
        """
        total = whole[SLOTS] * whole[TRIALS]
        first = block * LANES
        agent = rows[(HEAD + total) // LANES + block]
        found = ti.select(row(order) < end - first, at.places_of(told, whole, reals), whole[CELLS] - 1)
        rows[HEAD // LANES + block] = found + first // whole[SLOTS] * whole[CELLS]
        rows[(HEAD + 2 * total) // LANES + block] = agent
        for k in ti.static(range(LANES)):
            state = [numbers[k] for numbers in ti.static(told)]
            agents[total + first + k] = record(state + [types.real(0.0)] * ti.static(width - len(told)))

    return CellFuncs(
        width=width,
        record=record,
        agent_array=agent_array,
        whole_array=whole_array,
        row_array=row_array,
        real_array=real_array,
        find=find,
        put=put,
        hashed=hashed,
        periodic=periodic,
        count_x=COUNT_X,
        across=at.across,
        cells_of=at.cells_of,
        lane_cells=at.lane_cells,
        place_of=at.place_of,
        **vars(traversal.build(types, dimensions, periodic, hashed, at)),
        **vars(counting_sort.build(row, agent_array, whole_array, row_array)),
    )
