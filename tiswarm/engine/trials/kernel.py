"""Kernel: many small trials, one thread owns as many as it has lanes, everything of a tick fused in one kernel."""

from typing import Any

import taichi as ti

from tiswarm.dynamics import spawn, views
from tiswarm.dynamics.rows import (
    AGE,
    ALIVE_COUNT,
    ARRIVED_COUNT,
    CAPTURED_COUNT,
    CLOCK_ROWS,
    CRASHED_COUNT,
    DONE,
    FIRST_ARRIVAL,
    JOB,
    LAST_ARRIVAL,
    ON,
    TICK,
    TRIAL,
)
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.finite import STRANGE
from tiswarm.engine.trials import contacts, tick
from tiswarm.measures import running
from tiswarm.simd import runtime
from tiswarm.simd.lanes import Bundle, anywhere, bounded, row_of
from tiswarm.simd.runtime import LANES, TASK, Func, Types

OUTCOMES = {
    "alive": ALIVE_COUNT,
    "arrived": ARRIVED_COUNT,
    "captured": CAPTURED_COUNT,
    "crashed": CRASHED_COUNT,
    "ticks": AGE,
    "first_arrival": FIRST_ARRIVAL,
    "last_arrival": LAST_ARRIVAL,
}
"""What is kept of a trial that has ended, and the row of the clock it stands in."""

PATIENCE = 3 * LANES // 4
"""So many lanes are free before trials with planned ways begin: to plan for all of them takes as long as for one."""


def kernel(structure: Specialisation) -> tuple[Any, ParameterTable, tuple[int, int]]:
    """Give the kernel for a structure, built once per runtime, its layout, and how many rows of sums and ground a block has."""
    return runtime.kept(("trials", structure), lambda: _build(structure, runtime.types()))


def _replace(layout: ParameterTable, types: Types, starts: spawn.Starts, measures: running.Measures) -> Func:
    """Build the func that takes ended trials out of a block's lanes and lets the queue's next ones in."""
    structure, columns = layout.structure, len(layout.paths)
    outcomes = list(OUTCOMES.values())
    patience = PATIENCE if structure.frame.plan else 1
    state = layout.rows.place + layout.rows.motion

    @ti.func
    def strangeness(agents: ti.template(), b, count, height: ti.template()):
        """Give 0 in the lanes where all who are there have finite places and velocities, else what is no number."""
        told = types.lanes(0.0)
        for i in range(count):
            a = row_of(b * count + i, height)
            own = types.lanes(0.0)
            for k in ti.static(range(len(state))):
                own += 0.0 * agents[a + state[k]]
            told += ti.select(agents[a + layout.rows.alive] > 0.5, own, 0.0)
        return told

    @ti.func
    def idle_of(clock: ti.template(), b):
        """Count the lanes whose trials are over."""
        return ti.select((clock[b, ON] < 0.5) | (clock[b, DONE] > 0.5), 1, 0).sum()

    @ti.func
    def refill(block: ti.template(), work: ti.template()):
        """Write down trials that have ended, and put the queue's next ones into their lanes.

        Which lane gets which trial depends on the threads; no result does.
        """
        b, counts = block.b, block.counts
        clock, integer, numbers = ti.static(block.clock, block.integer, block.numbers)
        strange = strangeness(block.prey, b, counts[0], layout.agent_rows["prey"])
        if ti.static(structure.hunted):
            strange += strangeness(block.predators, b, counts[1], layout.agent_rows["predators"])
        finite = ti.select(strange == 0.0, 1, 0)
        takes = 1
        if ti.static(patience > 1):
            takes = ti.select(idle_of(clock, b) >= patience, 1, 0)
        for lane in range(LANES):
            if clock[b, DONE][lane] > 0.5:
                job = ti.cast(integer[b, JOB][lane], ti.i32)
                for k in ti.static(range(len(outcomes))):
                    work.results[job, k] = ti.cast(clock[b, outcomes[k]][lane] + 0.5, ti.i32)
                if finite[lane] == 0:
                    work.results[job, 0] = STRANGE
                for k in ti.static(range(measures.count)):
                    s = b * measures.height + 2 * k
                    # 0/0, not a number, where no state was measured
                    work.measured[job, k] = block.sums[s][lane] / block.sums[s + 1][lane]
                clock[b, ON][lane] = 0.0
                clock[b, DONE][lane] = 0.0
            if takes == 1 and clock[b, ON][lane] < 0.5:
                job = ti.atomic_add(work.queue[0], 1)
                if job < work.queue[1]:
                    for column in range(columns):
                        numbers[b * columns + column][lane] = work.table[work.jobs[job, 0], column]
                    for k in range(CLOCK_ROWS):
                        clock[b, k][lane] = 0.0
                    clock[b, ON][lane] = 1.0
                    integer[b, JOB][lane] = ti.cast(job, ti.u32)
                    integer[b, TRIAL][lane] = ti.cast(work.jobs[job, 1], ti.u32)
                    integer[b, TICK][lane] = ti.u32(0)

    @ti.func
    def replace(block: ti.template(), work: ti.template()):
        """Refill lanes whose trials have ended, as long as the queue holds any, and draw the starts of what came in."""
        b = block.b
        clock = ti.static(block.clock)
        ended = anywhere(clock[b, DONE] > 0.5)
        waiting = anywhere(clock[b, ON] < 0.5) and work.queue[0] < work.queue[1]
        if ti.static(patience > 1):
            waiting = waiting and idle_of(clock, b) >= patience
        if ended or waiting:
            refill(block, work)
            fresh = (clock[b, AGE] < 0.5) & (clock[b, ON] > 0.5)
            starts.spawn(block, block.one, fresh)
            measures.spread_ground(block.sums, block.ground, block.obstacles, block.numbers, b, block.counts[2], fresh)

    return replace


def _build(structure: Specialisation, types: Types) -> tuple[Any, ParameterTable, tuple[int, int]]:
    layout = ParameterTable(structure, types.lanes)
    see = views.build(layout, types)
    starts = spawn.build(layout, types)
    meetings = contacts.build(layout, types, see)
    moves_of = tick.build(layout, types, see, starts.uniform, meetings.bounce)
    measures = running.build(layout, types, see)
    replace = _replace(layout, types, starts, measures)
    flat = types.lane_array(1)
    integer_array = ti.types.ndarray(dtype=types.integer_lanes, ndim=2)
    whole = ti.types.ndarray(dtype=ti.i32, ndim=2)

    @ti.func
    def tick_of(block: ti.template(), work: ti.template(), left):
        """Run one tick of a block that may make `left` moves; give how many are left then, -1 when it shall pause."""
        b = block.b
        clock, integer = ti.static(block.clock, block.integer)
        replace(block, work)
        after = -1
        if anywhere(clock[b, ON] > 0.5):
            meetings.judge(block)
            measures.measure(block.prey, block.numbers, clock, block.sums, block.ground, b, block.counts)
            if left > 0:
                after = left - 1
                moves_of.move_prey(block)
                if ti.static(structure.hunted):
                    moves_of.move_predators(block)
                clock[b, AGE] = clock[b, AGE] + (1.0 - clock[b, DONE])
                integer[b, TICK] = integer[b, TICK] + ti.u32(1)
        return after

    @ti.kernel
    def advance(
        prey: flat,  # [block * agent * row]
        predators: flat,  # [block * agent * row]
        obstacles: flat,  # [block * obstacle * row]
        numbers: flat,  # [block * column], and as many again, in which a block spreads one trial's over all lanes
        clock: types.lane_array(2),  # [block, row]
        integer: integer_array,  # [block, row]
        table: ti.types.ndarray(dtype=types.real, ndim=2),  # [row, column]
        jobs: whole,  # [job] -> row of the table, trial number
        queue: ti.types.ndarray(dtype=ti.i32, ndim=1),  # next job, number of jobs
        results: whole,  # [job, outcome]
        sums: flat,  # [block * row], see running.py
        ground: flat,  # [block * cell]
        measured: ti.types.ndarray(dtype=types.real, ndim=2),  # [job, measure]
        board: flat,  # [block * row], planned ways, and what predators' surveys write
        met: flat,  # [block * agent * row], see mates.py
        prey_count: ti.i32,
        predator_count: ti.i32,
        obstacle_count: ti.i32,
        key_low: ti.u32,
        key_high: ti.u32,
        blocks: ti.i32,
        spread: ti.i32,  # every how manieth place in the arrays has a block
        moves: ti.i32,  # moves that each block makes at most before it pauses
    ):
        for index in range(blocks * TASK):
            if index % TASK == 0:
                work = Bundle(table=table, jobs=jobs, queue=queue, results=results, measured=measured)
                block = Bundle(
                    prey=prey, predators=predators, obstacles=obstacles, numbers=numbers, clock=clock, integer=integer,
                    sums=sums, ground=ground, board=board, met=met, b=bounded(index // TASK * spread),
                    one=(blocks + index // TASK) * spread,
                    counts=ti.Vector([prey_count, predator_count, obstacle_count]), key_low=key_low, key_high=key_high,
                )  # fmt: skip
                left = moves
                while left >= 0:
                    left = tick_of(block, work, left)

    return advance, layout, (measures.height, measures.cells)
