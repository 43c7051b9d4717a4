"""Kernels: what a tick of large swarms launches: how all agents of a kind move, and what they remember.

A crowd (near_cells.py) has cold rows by number as well: see transfer.py.
"""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics import steering
from tiswarm.dynamics.integrator import drifted
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.engine.swarms import means, transfer
from tiswarm.engine.swarms.near_cells import CellSearch
from tiswarm.engine.swarms.transfer import LOOP, share_of
from tiswarm.simd.lanes import Bundle
from tiswarm.simd.runtime import LANES, TASK, Func, Types
from tiswarm.space import box, box_lanes
from tiswarm.space.cells import CELLS, HEAD, SLOTS, TRIALS

# What the clock of a swarm holds: ticks run, the number of its first trial, the two words of the seed, whether it has moved.
AGE, FIRST, KEY_LOW, KEY_HIGH, MOVED, CLOCK = range(6)


@dataclass(frozen=True)
class TickKernels:
    """What a tick launches, apart from contact; and whether what depends on strategies must run at all."""

    move_prey: Func
    move_predators: Func | None
    move_plain: Func  # prey that meet nobody but each other
    run_plain: Func  # the same for several ticks in one launch
    begin: Func
    face: Func
    remember: Func
    drift_prey: Func
    drift_predators: Func
    average: Func
    rank: Func
    starts: bool  # whether memory or headings begin with something
    remembers: bool  # whether memory is revised after a move
    ranks: bool  # whether somebody looks at agents by their number
    averages: bool  # whether somebody looks at means of the whole swarm
    scans: bool  # whether prey look at obstacles beyond their fields


def build(
    layout: ParameterTable,
    types: Types,
    see: Views,
    senses: CellSearch,
    near: Any,
    uniform: Any,
    mortal: bool,
) -> TickKernels:
    """Build the kernels of a tick, and what the host asks about them: whether prey have memory to begin with or to update.

    move_prey, move_predators, drift_prey, drift_predators, face (predators), begin, remember (prey), average, rank; move_plain
    and run_plain, for prey that meet nobody but each other.
    """
    lanes, integers, real = types.lanes, types.integer_lanes, types.real
    dim, frame = len(layout.axes), layout.structure.frame
    driven = steering.build(layout, types, see, senses, uniform)
    steps = driven.steps
    carried = {kind: transfer.build(layout, types, see, senses, kind, mortal) for kind in ("prey", "predators")}
    saved = {kind: carried[kind].saves(getattr(near, kind)) for kind in carried}
    deep = transfer.scratch_rows(layout)
    flat = types.lane_array(1)
    cold_array = ti.types.ndarray(dtype=real, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)

    @ti.func
    def end_of(crowd: ti.template(), alive_end: ti.template(), block):
        """Give the slot behind the last agent of a block, its first slot where there is none."""
        trial = block * LANES // crowd.whole[SLOTS]
        return ti.max(ti.min((block + 1) * LANES, alive_end(crowd.whole, trial)), block * LANES)

    @ti.func
    def swarm_at(means: ti.template(), trial, age):
        told = [lanes(means[trial * (2 * dim + 2) + k]) for k in ti.static(range(2 * dim + 1))]
        return see.Swarm(*told, lanes(age))

    @ti.func
    def draw_of(clock: ti.template(), trial, index):
        key_low, key_high = ti.cast(clock[KEY_LOW], ti.u32), ti.cast(clock[KEY_HIGH], ti.u32)
        own = integers(ti.cast(trial + clock[FIRST], ti.u32))
        tick = integers(ti.cast(clock[AGE], ti.u32))
        return Bundle(key_low=key_low, key_high=key_high, trial=own, index=index, tick=tick)

    def moves(kind: str):
        ferry, save, alive_end = carried[kind], saved[kind], getattr(near, kind).alive_end
        drive_one, step_of = getattr(driven, kind), getattr(steps, kind)

        @ti.func
        def move_block(
            crowds: ti.template(), scratch: ti.template(), a, numbers: ti.template(), means: ti.template(), block, count,
            prey_count, clock: ti.template(), rows: ti.template(),
        ):  # fmt: skip
            """Move a block of agents; slots without one are written, too, for the sort. rows: its grid's, see cell_list.py."""
            crowd = crowds.of(kind)
            trial = block * LANES // crowd.whole[SLOTS]
            end = end_of(crowd, alive_end, block)
            if end > block * LANES:
                me, index = ferry.load(scratch, a, crowd, numbers, count, block, end)
                here = Bundle(
                    prey=crowds.prey, predators=crowds.predators, obstacles=crowds.obstacles, numbers=numbers,
                    trial=trial, block=block, end=end, count=prey_count,
                )  # fmt: skip
                draw = draw_of(clock, trial, index)
                target = see.target_of(numbers, 0)
                swarm = swarm_at(means, trial, ti.cast(clock[AGE], real))
                drive_one(here, draw, scratch, a, me, numbers, 0, swarm, target)
                step_of.commit(scratch, a, numbers, 0)
                ferry.save_rows(scratch, a, crowd, count, block, end)
            save(scratch, a, crowd, rows, block, end)

        return move_block

    move_prey_block = moves("prey")
    move_predator_block = moves("predators") if layout.structure.hunted else None

    def kernel_of(kind: str, move_block: Any):
        column = 0 if kind == "prey" else 1

        @ti.kernel
        def move(
            prey_agents: near.prey.agent_array, prey_whole: whole_array, prey_reals: near.prey.real_array,
            prey_cold: cold_array, prey_order: whole_array,
            predator_agents: near.predators.agent_array, predator_whole: whole_array, predator_reals: near.predators.real_array,
            predator_cold: cold_array, moving_rows: near.prey.row_array,
            obstacle_agents: near.obstacles.agent_array, obstacle_whole: whole_array, obstacle_reals: near.obstacles.real_array,
            scratch: flat, numbers: flat, means: cold_array, clock: whole_array,
            prey_count: ti.i32, predator_count: ti.i32,
        ):  # fmt: skip
            for index in range(LOOP):
                if index % TASK == 0:
                    chunk = index // TASK
                    prey = Bundle(
                        agents=prey_agents, whole=prey_whole, reals=prey_reals, cold=prey_cold, order=prey_order,
                    )  # fmt: skip
                    predators = Bundle(
                        agents=predator_agents, whole=predator_whole, reals=predator_reals, cold=predator_cold,
                    )  # fmt: skip
                    obstacles = Bundle(agents=obstacle_agents, whole=obstacle_whole, reals=obstacle_reals)
                    crowds = Bundle(prey=prey, predators=predators, obstacles=obstacles)
                    crowd = ti.static(prey_whole if kind == "prey" else predator_whole)
                    count = ti.Vector([prey_count, predator_count])[column]
                    begin, end = share_of(chunk, crowd[SLOTS] * crowd[TRIALS] // LANES)
                    for block in range(begin, end):
                        move_block(
                            crowds, scratch, chunk * deep, numbers, means, block, count, prey_count, clock,
                            moving_rows,
                        )  # fmt: skip

        return move

    @ti.func
    def plain_block(
        prey: ti.template(), rows: ti.template(), scratch: ti.template(), numbers: ti.template(), means: ti.template(),
        clock: ti.template(), chunk, block,
    ):  # fmt: skip
        """Move a block of prey that meet nobody but each other, and have no cold rows to be found by their count."""
        crowds = Bundle(prey=prey, predators=0, obstacles=0)
        move_prey_block(crowds, scratch, chunk * deep, numbers, means, block, 0, 0, clock, rows)

    @ti.kernel
    def move_plain(
        agents: near.prey.agent_array, whole: whole_array, reals: near.prey.real_array, rows: near.prey.row_array,
        scratch: flat, numbers: flat, means: cold_array, clock: whole_array,
    ):  # fmt: skip
        for index in range(LOOP):
            if index % TASK == 0:
                prey = Bundle(agents=agents, whole=whole, reals=reals)
                begin, end = share_of(index // TASK, whole[SLOTS] * whole[TRIALS] // LANES)
                for block in range(begin, end):
                    plain_block(prey, rows, scratch, numbers, means, clock, index // TASK, block)

    @ti.kernel
    def run_plain(
        agents: near.prey.agent_array, whole: whole_array, reals: near.prey.real_array, rows: near.prey.row_array,
        scratch: flat, numbers: flat, means: cold_array, clock: whole_array, ticks: ti.i32,
    ):  # fmt: skip
        """Run many ticks on one thread."""
        ti.loop_config(serialize=True)
        for _ in range(ticks):
            prey = Bundle(agents=agents, whole=whole, reals=reals)
            for block in range(whole[SLOTS] * whole[TRIALS] // LANES):
                plain_block(prey, rows, scratch, numbers, means, clock, 0, block)
            near.prey.arrange(agents, whole)
            clock[AGE] = clock[AGE] + 1

    def revises(kind: str, revise):
        """Build a kernel that lets `revise` change what agents of a kind remember."""
        ferry, funcs = carried[kind], getattr(near, kind)

        @ti.kernel
        def revised(
            agents: funcs.agent_array, whole: whole_array, cold: cold_array, scratch: flat, numbers: flat, seen: cold_array,
            count: ti.i32,
        ):  # fmt: skip
            for index in range(LOOP):
                if index % TASK == 0:
                    crowd = Bundle(agents=agents, whole=whole, cold=cold)
                    a = index // TASK * deep
                    first, last = share_of(index // TASK, whole[SLOTS] * whole[TRIALS] // LANES)
                    for block in range(first, last):
                        end = end_of(crowd, funcs.alive_end, block)
                        if end > block * LANES:
                            me, _ = ferry.load(scratch, a, crowd, numbers, count, block, end)
                            revise(scratch, a, me, numbers, lanes(seen[block * LANES // whole[SLOTS]]))
                            ferry.save_rows(scratch, a, crowd, count, block, end)
                            ferry.save_shown(scratch, a, crowd, block, end)

        return revised

    @ti.func
    def begin(scratch: ti.template(), a, me: ti.template(), numbers: ti.template(), seen):  # noqa: ARG001 - as its sisters
        """Give a prey's memory its first values, and a heading to a unicycle."""
        fresh = lanes(1.0) > 0.5
        driven.memories.begin(scratch, a, me, numbers, 0, fresh)
        if ti.static("prey" in frame.unicycles):
            steps.prey.face(scratch, a, fresh)

    @ti.func
    def face(scratch: ti.template(), a, me: ti.template(), numbers: ti.template(), seen):  # noqa: ARG001 - as its sisters
        """Let a predator that is a unicycle head where it moves."""
        steps.predators.face(scratch, a, lanes(1.0) > 0.5)

    @ti.func
    def remember(scratch: ti.template(), a, me: ti.template(), numbers: ti.template(), seen):
        """Update a prey's memory. seen: how many predators all prey of its trial together saw in the last move."""
        driven.memories.remember(scratch, a, me, numbers, 0, seen)

    def drifts(kind: str):
        funcs = getattr(near, kind)

        @ti.kernel
        def drift(agents: funcs.agent_array, whole: whole_array, reals: funcs.real_array, numbers: flat):
            """Half a step with the old velocity (Verlet), to where the sort expects moved agents."""
            total = whole[SLOTS] * whole[TRIALS]
            for slot in range(total):
                trial = slot // whole[SLOTS]
                step = numbers[layout.at.dt][0]
                moved = agents[slot]
                for k in ti.static(range(dim)):
                    moved[k] = drifted(moved[k], moved[dim + k], step)
                    if ti.static(box.wraps(frame.boundary)):
                        moved[k] = box_lanes.wrap(moved[k], numbers[layout.at.size[k]][0])
                place = whole[CELLS] - 1
                if slot < funcs.alive_end(whole, trial):
                    place = funcs.place_of(moved, whole, reals)
                whole[HEAD + slot] = trial * whole[CELLS] + place
                whole[HEAD + 2 * total + slot] = whole[HEAD + total + slot]
                agents[total + slot] = moved

        return drift

    strategies = layout.parts("prey", "strategy")
    return TickKernels(
        move_prey=kernel_of("prey", move_prey_block),
        move_predators=kernel_of("predators", move_predator_block) if layout.structure.hunted else None,
        move_plain=move_plain,
        run_plain=run_plain,
        begin=revises("prey", begin),
        face=revises("predators", face),
        remember=revises("prey", remember),
        drift_prey=drifts("prey"),
        drift_predators=drifts("predators"),
        **vars(means.build(layout, types, see, near, carried["prey"].number_in)),
        starts=driven.memories.starts or "prey" in frame.unicycles,
        remembers=driven.memories.remembers,
        ranks=any(p.strategy.leads for p in strategies) or bool(layout.parts("predators", "strategy", "observe")),
        scans=any({"blocks", "look"} & set(p.own) for p in layout.parts("prey", "avoidance")),
        averages=layout.structure.hunted or any({"steer", "integrate"} & set(p.own) for p in strategies),
    )
