"""Grid: a spatial hash over (trial, cell); agents lie in cell order, so that neighbours are a few contiguous ranges.

Space is cut into boxes, half a reach wide along x and a reach along the other axes. A cell's place in the table is
x + stride_y y + stride_z z. Worlds with edges have a place for each cell. Open worlds take that sum modulo a power of two
above the number of agents, with strides such that the rows that one agent looks at lie far apart in the table: agents of
other rows may share a place, their distance tells them apart, and no agent is met twice.

Agents are sorted by place, stably: each chunk of them counts its own, a scan turns counts into places, each chunk moves its
own. No order depends on threads.
"""

from dataclasses import dataclass
from math import floor, prod
from types import SimpleNamespace
from typing import Any, Literal

import numpy as np
import taichi as ti

from tiswarm import runtime
from tiswarm.runtime import LANES, TASK

Boundary = Literal["open", "periodic", "walls"]

# What the head of the whole numbers holds, before the sections of slots: sizes, and places as described above.
SLOTS, TRIALS, CHUNKS, CELLS, MASK, LONGEST, COUNT_X, COUNT_Y, COUNT_Z = range(9)
STRIDE_Y, STRIDE_Z, REACH_X, REACH_Y, REACH_Z, SUMS = range(9, 15)
# What the head of the real numbers holds: cells per metre and the period, per axis.
PER_METRE, PERIOD = 0, 3

ALONE = 16_384
"""Up to so many agents are sorted by one thread: waking others takes longer."""

MOST_CHUNKS = 8
"""Each chunk counts in a table of its own; more of them cost memory."""

HEAD = SUMS + MOST_CHUNKS  # what the parts of the tables sum up to, during a scan

FAR_CELL = 2.0**29
"""Cells beyond this one are one cell: whole numbers end soon after."""

NOWHERE = -(2**31)
"""Stands for no cell."""

FAR = 1e15
"""Where lanes wait that do not walk: out of everyone's reach, and its square is still a number [m]."""

MOST_ENTRIES = 2**31 - 1


@dataclass(frozen=True)
class Space:
    """A world: its size along each axis (two or three) [m], and what its edge does."""

    size: tuple[float, ...]
    boundary: Boundary

    @property
    def dimensions(self) -> int:
        """Count the axes."""
        return len(self.size)


@dataclass(frozen=True)
class Plan:
    """How a space is cut into cells, per axis; the last of the `cells` of a trial holds those who are gone.

    narrow: periodic axes less than three cells long; they have one cell, and images are compared pair by pair.
    """

    per_metre: tuple[float, ...]
    counts: tuple[int, ...]
    strides: tuple[int, ...]
    reach: tuple[int, ...]
    narrow: tuple[bool, ...]
    mask: int
    longest: int
    cells: int


def plan(space: Space, reach: float, count: int, epsilon: float) -> Plan:
    """Cut a space into cells for a number of agents, each of which sees as far as `reach` [m].

    epsilon: relative spacing of the reals that positions are stored in; cells are wider by what rounding may shift.
    """
    if not reach > 0:
        raise ValueError(f"reach: {reach} is not possible; use a positive number")
    if reach == float("inf"):
        return _everybody(space)
    wide = reach * (1 + 1e-5 + 16 * epsilon)
    most = 4 * count + 64
    if space.boundary == "open" or (space.boundary == "walls" and prod(max(1, side / wide) for side in space.size) > most):
        return _hashed(space.dimensions, wide, count)
    widths = [wide / 2] + [wide] * (space.dimensions - 1)
    excess = prod(max(1.0, side / width) for side, width in zip(space.size, widths, strict=True)) / most
    while excess > 1:  # a sparse world has few, large cells
        widths = [width * max(excess ** (1 / space.dimensions), 1.01) for width in widths]
        excess = prod(max(1.0, side / width) for side, width in zip(space.size, widths, strict=True)) / most
    counts = [max(1, floor(side / width)) for side, width in zip(space.size, widths, strict=True)]
    reaches = [1 if side >= wide * number else 2 for side, number in zip(space.size, counts, strict=True)]
    narrow = [space.boundary == "periodic" and number < 2 * k + 1 for number, k in zip(counts, reaches, strict=True)]
    counts = [1 if thin else number for number, thin in zip(counts, narrow, strict=True)]
    reaches = [0 if number == 1 else k for number, k in zip(counts, reaches, strict=True)]
    return Plan(
        per_metre=tuple(number / side for number, side in zip(counts, space.size, strict=True)),
        counts=tuple(counts),
        strides=tuple(prod(counts[:axis]) for axis in range(1, space.dimensions)),
        reach=tuple(reaches),
        narrow=tuple(narrow),
        mask=-1,
        longest=counts[0] if space.boundary == "periodic" and not narrow[0] else 2**30,
        cells=prod(counts) + 1,
    )


def _everybody(space: Space) -> Plan:
    """Plan one cell, so that everybody meets everybody."""
    ones = (1,) * space.dimensions
    narrow = (space.boundary == "periodic",) * space.dimensions
    return Plan((0.0,) * space.dimensions, ones, ones[1:], (0,) * space.dimensions, narrow, mask=-1, longest=2**30, cells=2)


def _hashed(dimensions: int, wide: float, count: int) -> Plan:
    """Plan a table for a world without end: rows start at multiples of an irrational share of it."""
    size = 1 << max(6 if dimensions == 2 else 9, (2 * count - 1).bit_length())
    shares = [0.6180339887498949] if dimensions == 2 else [0.7548776662466927, 0.5698402909980532]
    strides = [int(share * size) | 1 for share in shares]
    steps = range(-2, 3)
    rows = [(a, b) for a in steps for b in (steps if dimensions == 3 else (0,)) if (a, b) != (0, 0)]
    offsets = [(a * strides[0] + b * strides[-1]) % size for a, b in rows]
    return Plan(
        per_metre=(2 / wide,) + (1 / wide,) * (dimensions - 1),
        counts=(size,) * dimensions,
        strides=tuple(strides),
        reach=(2,) + (1,) * (dimensions - 1),
        narrow=(False,) * dimensions,
        mask=size - 1,
        longest=min(min(offset, size - offset) for offset in offsets),
        cells=size + 1,
    )


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
        self.space, self.count, self.trials = space, count, trials
        self.slots = -(-max(count, 1) // LANES) * LANES
        self.plan = plan(space, reach, count, float(np.finfo(types.dtype).eps))
        self.total = self.slots * trials
        self.chunks = 1 if self.total <= ALONE else min(settings.threads, MOST_CHUNKS)
        entries = HEAD + 3 * self.total + self.chunks * (self.plan.cells * trials + 1)
        if max(entries, 2 * self.total * 12) > MOST_ENTRIES:
            raise ValueError(f"{trials:,} trials of {count:,} agents are more than a grid can number; use fewer")
        self.funcs = funcs(space, self.plan, extra)
        self.agents = runtime.aligned((2 * self.total, self.funcs.width), types.dtype)
        self.whole = runtime.aligned((entries,), np.int32)
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
        }
        self.whole[list(head)] = list(head.values())
        self.reals[PER_METRE : PER_METRE + space.dimensions] = self.plan.per_metre
        self.reals[PERIOD : PERIOD + space.dimensions] = space.size

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
        if self.space.boundary == "periodic":
            wrapped = agents[:, : self.count, :dimensions] % np.asarray(self.space.size, agents.dtype)
            wrapped[wrapped >= np.asarray(self.space.size, agents.dtype)] = 0
            agents[:, : self.count, :dimensions] = wrapped
        self.whole[HEAD + 2 * self.total : HEAD + 3 * self.total] = np.tile(np.arange(self.slots, dtype=np.int32), self.trials)
        here = np.zeros((self.trials, self.slots), np.int32)
        here[:, : self.count] = ~gone
        self.whole[HEAD : HEAD + self.total] = here.ravel()
        self.funcs.find(self.agents, self.whole, self.reals, self.total)
        self.sort()

    def sort(self) -> None:
        """Bring the moved agents into cell order: their places in the table are known."""
        if self.chunks == 1:
            self.funcs.sort_alone(self.agents, self.whole)
        else:
            self.funcs.sort(self.agents, self.whole, self.chunks * TASK)

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
        table = self.whole[-(self.plan.cells * self.trials + 1) :]
        return table[self.plan.cells - 1 :: self.plan.cells][: self.trials] - np.arange(self.trials) * self.slots


_built: dict[tuple[Any, ...], SimpleNamespace] = {}


def funcs(space: Space, cut: Plan, extra: int = 0) -> SimpleNamespace:
    """Give the kernels and funcs for a kind of grid, built once per runtime."""
    width = 4 * -(-(2 * space.dimensions + extra) // 4)
    key = (runtime.generation(), space.dimensions, space.boundary == "periodic", cut.mask >= 0, cut.narrow, width)
    if key not in _built:
        _built[key] = _build(runtime.types(), *key[1:])
    return _built[key]


def _build(
    types: SimpleNamespace, dimensions: int, periodic: bool, hashed: bool, narrow: tuple[bool, ...], width: int
) -> SimpleNamespace:
    solid = dimensions == 3
    lanes, real = types.lanes, types.real
    record = ti.types.vector(width, real)
    agent_array = ti.types.ndarray(dtype=record, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)
    real_array = ti.types.ndarray(dtype=ti.f64, ndim=1)

    @ti.func
    def cell_of(x, axis: ti.template(), whole: ti.template(), reals: ti.template()):
        """Give the cell along an axis, in double precision: cells then never shift against reach, however far away."""
        cell = ti.cast(x, ti.f64) * reals[PER_METRE + axis]
        if ti.static(hashed):
            cell = ti.floor(ti.select(cell < FAR_CELL, ti.select(cell > -FAR_CELL, cell, -FAR_CELL), FAR_CELL))
        else:
            last = ti.cast(whole[COUNT_X + axis] - 1, ti.f64)
            cell = ti.select(cell < last, ti.select(cell > 0.0, cell, 0.0), last)
        return ti.cast(cell, ti.i32)

    @ti.func
    def place_of(p, whole: ti.template(), reals: ti.template()):
        """Give the place of a position in its trial's table."""
        place = cell_of(p[0], 0, whole, reals) + cell_of(p[1], 1, whole, reals) * whole[STRIDE_Y]
        if ti.static(solid):
            place += cell_of(p[2], 2, whole, reals) * whole[STRIDE_Z]
        if ti.static(hashed):
            place = place & whole[MASK]
        return place

    @ti.func
    def table_of(whole: ti.template()):
        """Give where the last chunk's table begins: entry k is the first slot of place k."""
        return HEAD + 3 * whole[SLOTS] * whole[TRIALS] + (whole[CHUNKS] - 1) * (whole[CELLS] * whole[TRIALS] + 1)

    @ti.func
    def turns(cell, axis: ti.template(), whole: ti.template()):
        """Tell in which image of a periodic world a cell lies: -1, 0 or 1."""
        image = 0
        if ti.static(periodic):
            if cell < 0:
                image = -1
            elif cell >= whole[COUNT_X + axis]:
                image = 1
        return image

    @ti.func
    def image_of(cell, axis: ti.template(), whole: ti.template()):
        """Tell in which image of a periodic world a cell lies: -1, 0 or 1."""
        image = 0
        if ti.static(periodic):
            if cell < 0:
                image = -1
            elif cell >= whole[COUNT_X + axis]:
                image = 1
        return image

    @ti.func
    def shift(image, axis: ti.template(), reals: ti.template()):
        """Give how far an image lies off [m]."""
        return ti.cast(ti.cast(image, ti.f64) * reals[PERIOD + axis], real)

    @ti.func
    def across(difference, axis: ti.template(), reals: ti.template()):
        """Give the difference of two coordinates to the nearest image along a narrow axis; elsewhere images are walked."""
        if ti.static(narrow[axis]):
            period = ti.cast(reals[PERIOD + axis], real)
            difference = ti.select(difference > 0.5 * period, difference - period, difference)
            difference = ti.select(difference < -0.5 * period, difference + period, difference)
        return difference

    def walks(meet):
        """Build walks over all agents within reach; `meet(sums, p, agents, j, reals)` sees agent j from lanes at p."""

        @ti.func
        def walk_box(
            sums: ti.template(), p, agents: ti.template(), whole: ti.template(), reals: ti.template(), trial, low, high
        ):
            """Meet every agent of a trial in the box of cells `low` to `high` once. p: positions of the lanes, a list."""
            table = table_of(whole) + trial * whole[CELLS]
            least = low
            most = high
            if ti.static(not (periodic or hashed)):
                for axis in ti.static(range(3)):
                    least[axis] = ti.max(low[axis], 0)
                    most[axis] = ti.min(high[axis], whole[COUNT_X + axis] - 1)
            here = [p[axis] + 0.0 for axis in ti.static(range(dimensions))]
            for cell_z in range(least[2], most[2] + 1):
                plane = 0
                if ti.static(solid):
                    image = image_of(cell_z, 2, whole)
                    plane = cell_z * whole[STRIDE_Z]
                    here[2] = p[2]
                    if image != 0:
                        plane -= image * whole[COUNT_Z] * whole[STRIDE_Z]
                        here[2] = p[2] - shift(image, 2, reals)
                for cell_y in range(least[1], most[1] + 1):
                    image = image_of(cell_y, 1, whole)
                    row = plane + cell_y * whole[STRIDE_Y]
                    here[1] = p[1]
                    if image != 0:
                        row -= image * whole[COUNT_Y] * whole[STRIDE_Y]
                        here[1] = p[1] - shift(image, 1, reals)
                    cell_x = least[0]
                    while cell_x <= most[0]:  # once, or twice where a row wraps
                        begin = row + cell_x
                        more = most[0] - cell_x
                        here[0] = p[0]
                        if ti.static(hashed):
                            begin = begin & whole[MASK]
                            more = ti.min(more, whole[MASK] - begin)
                        elif ti.static(periodic):
                            image = image_of(cell_x, 0, whole)
                            more = ti.min(more, whole[COUNT_X] * (1 + image) - 1 - cell_x)
                            if image != 0:
                                begin -= image * whole[COUNT_X]
                                here[0] = p[0] - shift(image, 0, reals)
                        j = whole[table + begin]
                        end = whole[table + begin + more + 1]
                        while j < end:
                            meet(sums, here, agents, j, reals)
                            j += 1
                        cell_x += more + 1

        @ti.func
        def walk_around(
            sums: ti.template(), p, agents: ti.template(), whole: ti.template(), reals: ti.template(), trial, block, end
        ):
            """Let the lanes of a block of this grid's own agents meet all within reach, themselves included.

            Lanes that share a row of cells walk together while the others wait FAR away.
            """
            first = block * LANES
            while first < end:
                cells = cells_of(agents[first], whole, reals)
                low = cells[0]
                high = low
                last = end - 1
                if ti.static(hashed):  # neighbours in the table may come from anywhere
                    last = first
                    going = 1
                    while going == 1 and last + 1 < end:
                        cell = in_row(agents[last + 1], cells, whole, reals)
                        if cell > NOWHERE and fits(whole, ti.min(low, cell), ti.max(high, cell)):
                            low = ti.min(low, cell)
                            high = ti.max(high, cell)
                            last += 1
                        else:
                            going = 0
                else:  # cells rise along a row
                    high = in_row(agents[last], cells, whole, reals)
                    while not (high > NOWHERE and fits(whole, low, high)):
                        last -= 1
                        high = in_row(agents[last], cells, whole, reals)
                here = p[0]
                if last - first < LANES - 1:
                    lane = lanes([float(number) for number in ti.static(range(LANES))])
                    walking = (lane >= ti.cast(first - block * LANES, real)) & (lane <= ti.cast(last - block * LANES, real))
                    here = ti.select(walking, p[0], FAR)
                places = [here] + [p[axis] for axis in ti.static(range(1, dimensions))]
                lowest = ti.Vector([low - whole[REACH_X], cells[1] - whole[REACH_Y], cells[2] - whole[REACH_Z]])
                highest = ti.Vector([high + whole[REACH_X], cells[1] + whole[REACH_Y], cells[2] + whole[REACH_Z]])
                walk_box(sums, places, agents, whole, reals, trial, lowest, highest)
                first = last + 1

        return SimpleNamespace(box=walk_box, around=walk_around)

    @ti.func
    def cells_of(agent, whole: ti.template(), reals: ti.template()):
        cell_z = 0
        if ti.static(solid):
            cell_z = cell_of(agent[2], 2, whole, reals)
        return ti.Vector([cell_of(agent[0], 0, whole, reals), cell_of(agent[1], 1, whole, reals), cell_z])

    @ti.func
    def in_row(agent, cells, whole: ti.template(), reals: ti.template()):
        """Give the cell of an agent along x if it lies in the same row as some cells, else NOWHERE."""
        same = cell_of(agent[1], 1, whole, reals) == cells[1]
        if ti.static(solid):
            same = same and cell_of(agent[2], 2, whole, reals) == cells[2]
        return ti.select(same, cell_of(agent[0], 0, whole, reals), NOWHERE)

    @ti.func
    def fits(whole: ti.template(), low, high):
        """Tell whether lanes from cell `low` to `high` can walk together: no place may come twice."""
        return high - low + 2 * whole[REACH_X] < whole[LONGEST]

    @ti.func
    def alive_end(whole: ti.template(), trial):
        """Give the slot behind a trial's last agent that is not gone."""
        return whole[table_of(whole) + (trial + 1) * whole[CELLS] - 1]

    @ti.func
    def count(whole: ti.template(), chunk):
        """Count the moved agents of a chunk by place."""
        total = whole[SLOTS] * whole[TRIALS]
        entries = whole[CELLS] * whole[TRIALS] + 1
        table = HEAD + 3 * total + chunk * entries
        share = (total + whole[CHUNKS] - 1) // whole[CHUNKS]
        for k in range(table, table + entries):
            whole[k] = 0
        for slot in range(chunk * share, ti.min(total, (chunk + 1) * share)):
            at = table + 1 + whole[HEAD + slot]
            whole[at] = whole[at] + 1

    @ti.func
    def total_of(whole: ti.template(), part):
        """Sum up a part of the counts."""
        entries = whole[CELLS] * whole[TRIALS] + 1
        tables = HEAD + 3 * whole[SLOTS] * whole[TRIALS]
        share = (entries + whole[CHUNKS] - 1) // whole[CHUNKS]
        every = 0
        for table in range(whole[CHUNKS]):
            at = tables + table * entries
            for k in range(at + part * share, at + ti.min(entries, (part + 1) * share)):
                every += whole[k]
        whole[SUMS + part] = every

    @ti.func
    def scan(whole: ti.template(), part):
        """Turn a part of the counts into the slots where each chunk's agents of each place begin."""
        entries = whole[CELLS] * whole[TRIALS] + 1
        tables = HEAD + 3 * whole[SLOTS] * whole[TRIALS]
        chunks = whole[CHUNKS]
        share = (entries + chunks - 1) // chunks
        before = 0
        for other in range(part):
            before += whole[SUMS + other]
        for k in range(tables + part * share, tables + ti.min(entries, (part + 1) * share)):
            for table in range(chunks):
                at = k + table * entries
                here = whole[at]
                whole[at] = before
                before += here

    @ti.func
    def scatter(agents: ti.template(), whole: ti.template(), chunk):
        """Move a chunk's agents to their slots; each place's entry ends up behind its last agent."""
        total = whole[SLOTS] * whole[TRIALS]
        table = HEAD + 3 * total + chunk * (whole[CELLS] * whole[TRIALS] + 1) + 1
        share = (total + whole[CHUNKS] - 1) // whole[CHUNKS]
        for slot in range(chunk * share, ti.min(total, (chunk + 1) * share)):
            at = table + whole[HEAD + slot]
            to = whole[at]
            whole[at] = to + 1
            agents[to] = agents[total + slot]
            whole[HEAD + total + to] = whole[HEAD + 2 * total + slot]

    @ti.kernel
    def sort(agents: agent_array, whole: whole_array, iterations: ti.i32):
        for index in range(iterations):
            if index % TASK == 0:
                count(whole, index // TASK)
        for index in range(iterations):
            if index % TASK == 0:
                total_of(whole, index // TASK)
        for index in range(iterations):
            if index % TASK == 0:
                scan(whole, index // TASK)
        for index in range(iterations):
            if index % TASK == 0:
                scatter(agents, whole, index // TASK)

    @ti.func
    def arrange(agents: ti.template(), whole: ti.template()):
        """Sort all agents as one chunk."""
        count(whole, 0)
        scan(whole, 0)
        scatter(agents, whole, 0)

    @ti.kernel
    def sort_alone(agents: agent_array, whole: whole_array):
        ti.loop_config(serialize=True)
        for _ in range(1):
            arrange(agents, whole)

    @ti.kernel
    def find(agents: agent_array, whole: whole_array, reals: real_array, total: ti.i32):
        """Replace the marks of the moved agents, 1 for those who are there, by their places in the table."""
        for slot in range(total):
            trial = slot // whole[SLOTS]
            place = whole[CELLS] - 1
            if whole[HEAD + slot] == 1:
                place = place_of(agents[total + slot], whole, reals)
            whole[HEAD + slot] = trial * whole[CELLS] + place

    return SimpleNamespace(
        width=width,
        record=record,
        agent_array=agent_array,
        whole_array=whole_array,
        real_array=real_array,
        walks=walks,
        across=across,
        cells_of=cells_of,
        fits=fits,
        hashed=hashed,
        periodic=periodic,
        count_x=COUNT_X,
        place_of=place_of,
        alive_end=alive_end,
        arrange=arrange,
        sort=sort,
        sort_alone=sort_alone,
        find=find,
    )
