"""Counting sort: agents brought into the order of their places in the table, stably, by counting.

Each chunk of the agents counts its own places in a table of its own; a scan turns the counts into slots; each chunk moves its
own agents there. No order depends on threads.

    chunk 0   | agents 0 ...  |  count   | 2 0 1 ... |  scan   | first slot of its agents of place 0, 1, 2, ... |
    chunk 1   | ... agents n  |  =====>  | 0 3 1 ... |  ====>  | the same, behind those of chunk 0              |

Tables are cleared, summed up and scanned a vector at a time: after a store Taichi reads the address of an array anew, which
costs as much as the work on one number. That is why moves load a whole group of agents before they store the first.
"""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.simd.runtime import LANES, TASK, Func
from tiswarm.space.cells import CHUNKS, HEAD, SLOTS, SUMS, TABLE, TRIALS


@dataclass(frozen=True)
class Sorts:
    """The sort's kernels."""

    arrange: Func
    sort: Func
    sort_alone: Func


@ti.func
def share_of(whole: ti.template(), chunk):
    """Give the first slot of a chunk's agents; chunks are whole groups."""
    groups = whole[SLOTS] * whole[TRIALS] // LANES
    return ti.min(chunk * ((groups + whole[CHUNKS] - 1) // whole[CHUNKS]), groups) * LANES


@ti.func
def part_of(whole: ti.template(), part):
    """Give the first row of a part of a table."""
    rows = whole[TABLE] // LANES
    return ti.min(part * ((rows + whole[CHUNKS] - 1) // whole[CHUNKS]), rows)


@ti.func
def tables_of(whole: ti.template()):
    """Give where the first chunk's table begins."""
    return HEAD + 3 * whole[SLOTS] * whole[TRIALS]


@ti.func
def count(whole: ti.template(), chunk):
    """Count the moved agents of a chunk by place."""
    table = tables_of(whole) + chunk * whole[TABLE] + 1
    for group in range(share_of(whole, chunk) // LANES, share_of(whole, chunk + 1) // LANES):
        places = [whole[HEAD + group * LANES + k] for k in ti.static(range(LANES))]
        for k in ti.static(range(LANES)):
            whole[table + places[k]] = whole[table + places[k]] + 1


@ti.func
def scatter(agents: ti.template(), whole: ti.template(), chunk):
    """Move a chunk's agents to their slots; each place's entry ends up behind its last agent."""
    total = whole[SLOTS] * whole[TRIALS]
    table = tables_of(whole) + chunk * whole[TABLE] + 1
    for group in range(share_of(whole, chunk) // LANES, share_of(whole, chunk + 1) // LANES):
        first = group * LANES
        places = [whole[HEAD + first + k] for k in ti.static(range(LANES))]
        numbers = [whole[HEAD + 2 * total + first + k] for k in ti.static(range(LANES))]
        moved = [agents[total + first + k] for k in ti.static(range(LANES))]
        for k in ti.static(range(LANES)):
            to = whole[table + places[k]]
            whole[table + places[k]] = to + 1
            whole[HEAD + total + to] = numbers[k]
            agents[to] = moved[k]


@ti.func
def arrange(agents: ti.template(), whole: ti.template()):
    """Sort all agents as one chunk inside a kernel that has the whole numbers only one by one."""
    table = tables_of(whole)
    for k in range(table, table + whole[TABLE]):
        whole[k] = 0
    count(whole, 0)
    before = 0
    for k in range(table, table + whole[TABLE]):
        here = whole[k]
        whole[k] = before
        before += here
    scatter(agents, whole, 0)


@dataclass(frozen=True)
class _Tables:
    """What clears, sums up and scans tables, a row at a time."""

    clear: Func
    total_of: Func
    scan: Func


def _tables(row: Any) -> _Tables:
    @ti.func
    def clear(whole: ti.template(), rows: ti.template(), chunk):
        """Forget what a chunk counted."""
        table = tables_of(whole) // LANES + chunk * (whole[TABLE] // LANES)
        for k in range(table, table + whole[TABLE] // LANES):
            rows[k] = row(0)

    @ti.func
    def total_of(whole: ti.template(), rows: ti.template(), part):
        """Sum up a part of the counts."""
        every = row(0)
        for table in range(whole[CHUNKS]):
            at = (tables_of(whole) + table * whole[TABLE]) // LANES
            for k in range(at + part_of(whole, part), at + part_of(whole, part + 1)):
                every += rows[k]
        whole[SUMS + part] = every.sum()

    @ti.func
    def running(counts):
        """Give the sum of each number and those before it."""
        sums = counts
        for step in ti.static([1 << k for k in range(LANES.bit_length() - 1)]):
            sums += row([0] * step + [sums[k] for k in ti.static(range(LANES - step))])
        return sums

    @ti.func
    def scan(whole: ti.template(), rows: ti.template(), part):
        """Turn a part of the counts into the slots where each chunk's agents of each place begin."""
        tables = tables_of(whole) // LANES
        length = whole[TABLE] // LANES
        before = 0
        for other in range(part):
            before += whole[SUMS + other]
        for k in range(tables + part_of(whole, part), tables + part_of(whole, part + 1)):
            every = rows[k]
            for table in range(1, whole[CHUNKS]):
                every += rows[k + table * length]
            upto = running(every)
            begin = upto - every + before
            before += upto[LANES - 1]
            for table in range(whole[CHUNKS]):
                at = k + table * length
                here = rows[at]
                rows[at] = begin
                begin += here

    return _Tables(clear=clear, total_of=total_of, scan=scan)


def build(row: Any, agent_array: Any, whole_array: Any, row_array: Any) -> Sorts:
    """Build the kernels that sort. They get the whole numbers twice: one by one, and a row (a vector) at a time."""
    tables = _tables(row)
    clear, total_of, scan = tables.clear, tables.total_of, tables.scan

    @ti.kernel
    def sort(agents: agent_array, whole: whole_array, rows: row_array, iterations: ti.i32):
        for index in range(iterations):
            if index % TASK == 0:
                clear(whole, rows, index // TASK)
                count(whole, index // TASK)
        for index in range(iterations):
            if index % TASK == 0:
                total_of(whole, rows, index // TASK)
        for index in range(iterations):
            if index % TASK == 0:
                scan(whole, rows, index // TASK)
        for index in range(iterations):
            if index % TASK == 0:
                scatter(agents, whole, index // TASK)

    @ti.kernel
    def sort_alone(agents: agent_array, whole: whole_array, rows: row_array):
        ti.loop_config(serialize=True)
        for _ in range(1):
            clear(whole, rows, 0)
            count(whole, 0)
            scan(whole, rows, 0)
            scatter(agents, whole, 0)

    return Sorts(arrange=arrange, sort=sort, sort_alone=sort_alone)
