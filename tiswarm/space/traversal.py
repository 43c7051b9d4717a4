"""Traversal: lanes that follow each other in a row of cells meet everybody within reach.

The rows above and below are walked with their own in one loop, three ranges of agents that follow each other: a loop's end is
a branch that no processor foresees, and what it costs is paid once instead of three times.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.simd.runtime import LANES, Func, Types
from tiswarm.space.cell_index import CellIndex
from tiswarm.space.cells import (
    CELLS,
    CHUNKS,
    COUNT_X,
    COUNT_Y,
    COUNT_Z,
    HEAD,
    LONGEST,
    MASK,
    ONE,
    REACH_X,
    REACH_Y,
    REACH_Z,
    SLOTS,
    STRIDE_Y,
    STRIDE_Z,
    TABLE,
    TRIALS,
)

NOWHERE = -(2**31)
"""Stands for no cell."""

FAR = 1e15
"""Where lanes wait that do not walk: out of everyone's reach, and its square is still a number [m]."""


@dataclass(frozen=True)
class Walks:
    """Walks that meet all within reach."""

    box: Func
    around: Func


@dataclass(frozen=True)
class Traversal:
    """What builds walks."""

    walks: Func
    alive_end: Func  # give the slot behind a trial's last agent that is not gone
    fits: Func


@ti.func
def table_of(whole: ti.template()):
    """Give where the last chunk's table begins: entry k is the first slot of place k."""
    return HEAD + 3 * whole[SLOTS] * whole[TRIALS] + (whole[CHUNKS] - 1) * whole[TABLE]


@ti.func
def alive_end(whole: ti.template(), trial):
    """Give the slot behind a trial's last agent that is not gone."""
    return whole[table_of(whole) + (trial + 1) * whole[CELLS] - 1]


@ti.func
def fits(whole: ti.template(), low, high):
    """Tell whether lanes from cell `low` to `high` can walk together: no place may come twice."""
    return high - low + 2 * whole[REACH_X] < whole[LONGEST]


def _row_walk(meet: Callable[..., Any]) -> Func:
    """Build the walk along up to three rows of cells."""

    @ti.func
    def walk_rows(
        sums: ti.template(),
        here,
        agents: ti.template(),
        whole: ti.template(),
        reals: ti.template(),
        table,
        first,
        rows,
        more,
    ):
        """Meet the agents of up to three rows of cells: those from place `first[k]` to `more` places further."""
        begin = whole[table + first[0]]
        upto = whole[table + first[0] + more + 1] - begin  # how many agents there are up to the end of each row
        begin_1 = whole[table + first[1]] - upto
        upto_1 = upto + ti.select(rows > 1, whole[table + first[1] + more + 1] - begin_1 - upto, 0)
        begin_2 = whole[table + first[2]] - upto_1
        upto_2 = upto_1 + ti.select(rows > 2, whole[table + first[2] + more + 1] - begin_2 - upto_1, 0)
        n = 0
        while n < upto_2:
            j = n + ti.select(n < upto, begin, ti.select(n < upto_1, begin_1, begin_2))
            meet(sums, here, agents, j, reals)
            n += whole[ONE]  # with a step that it cannot know LLVM leaves the loop alone; unrolled it runs out of registers

    return walk_rows


def _box_walk(dimensions: int, periodic: bool, hashed: bool, at: CellIndex, walk_rows: Func) -> Func:
    """Build the walk through a box of cells."""
    image_of, shift = at.image_of, at.shift

    @ti.func
    def walk_box(sums: ti.template(), p, agents: ti.template(), whole: ti.template(), reals: ti.template(), trial, low, high):
        """Meet every agent of a trial in the box of cells `low` to `high` once. p: positions of the lanes, a list."""
        # Deep: loops over planes, rows and cells with their images; each body works on the numbers of the loops around it.
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
            if ti.static(dimensions == 3):
                image = image_of(cell_z, 2, whole)
                plane = (cell_z - image * whole[COUNT_Z]) * whole[STRIDE_Z]
                here[2] = p[2]
                if image != 0:
                    here[2] = p[2] - shift(image, 2, reals)
            cell_y = least[1]
            while cell_y <= most[1]:  # once, or more where images meet
                image = image_of(cell_y, 1, whole)
                rows = ti.min(most[1] - cell_y + 1, 3)
                row = plane + cell_y * whole[STRIDE_Y]
                here[1] = p[1]
                if ti.static(periodic):
                    rows = ti.min(rows, whole[COUNT_Y] * (1 + image) - cell_y)
                    if image != 0:
                        row -= image * whole[COUNT_Y] * whole[STRIDE_Y]
                        here[1] = p[1] - shift(image, 1, reals)
                row_1 = row + ti.select(rows > 1, whole[STRIDE_Y], 0)
                row_2 = row_1 + ti.select(rows > 2, whole[STRIDE_Y], 0)
                cell_x = least[0]
                while cell_x <= most[0]:  # once, or more where rows wrap
                    first = [row + cell_x, row_1 + cell_x, row_2 + cell_x]
                    more = most[0] - cell_x
                    here[0] = p[0]
                    if ti.static(hashed):
                        for k in ti.static(range(3)):
                            first[k] = first[k] & whole[MASK]
                            more = ti.min(more, whole[MASK] - first[k])
                    elif ti.static(periodic):
                        image = image_of(cell_x, 0, whole)
                        more = ti.min(more, whole[COUNT_X] * (1 + image) - 1 - cell_x)
                        if image != 0:
                            here[0] = p[0] - shift(image, 0, reals)
                            for k in ti.static(range(3)):
                                first[k] -= image * whole[COUNT_X]
                    walk_rows(sums, here, agents, whole, reals, table, first, rows, more)
                    cell_x += more + 1
                cell_y += rows

    return walk_box


def _around_walk(types: Types, dimensions: int, hashed: bool, at: CellIndex, walk_box: Func) -> Func:
    """Build the walk around a block of a grid's own agents."""
    lanes, real, cells_of = types.lanes, types.real, at.cells_of

    @ti.func
    def in_row(agent, cells, whole: ti.template(), reals: ti.template()):
        """Give the cell of an agent along x if it lies in the same row as some cells, else NOWHERE."""
        mine = cells_of(agent, whole, reals)
        return ti.select(mine[1] == cells[1] and mine[2] == cells[2], mine[0], NOWHERE)

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

    return walk_around


def build(types: Types, dimensions: int, periodic: bool, hashed: bool, at: CellIndex) -> Traversal:
    """Build the walks for a kind of grid; `at` are its funcs of places."""

    def walks(meet: Callable[..., Any]) -> Walks:
        """Build walks over all agents within reach; `meet(sums, p, agents, j, reals)` sees agent j from lanes at p."""
        walk_box = _box_walk(dimensions, periodic, hashed, at, _row_walk(meet))
        return Walks(box=walk_box, around=_around_walk(types, dimensions, hashed, at, walk_box))

    return Traversal(walks=walks, alive_end=alive_end, fits=fits)
