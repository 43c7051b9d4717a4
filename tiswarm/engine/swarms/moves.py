"""Moves: the kernels that move all agents of a kind of a large swarm, and those for swarms of prey alone."""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics.steering import Steering
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.engine.swarms import transfer
from tiswarm.engine.swarms.clock import AGE, FIRST, KEY_HIGH, KEY_LOW
from tiswarm.engine.swarms.transfer import LOOP, share_of
from tiswarm.simd.lanes import Bundle
from tiswarm.simd.runtime import LANES, TASK, Func, Types
from tiswarm.space.cells import SLOTS, TRIALS


@dataclass(frozen=True)
class MoveParts:
    """What a move is made of."""

    layout: ParameterTable
    types: Types
    see: Views
    near: Any
    driven: Steering
    carried: dict[str, Any]  # kind -> what brings its agents into lanes and back


@dataclass(frozen=True)
class MoveKernels:
    """Kernels that move agents."""

    move_prey: Func
    move_predators: Func | None
    move_plain: Func  # prey that meet nobody but each other
    run_plain: Func  # the same for several ticks in one launch


@ti.func
def end_of(crowd: ti.template(), alive_end: ti.template(), block):
    """Give the slot behind the last agent of a block, its first slot where there is none."""
    trial = block * LANES // crowd.whole[SLOTS]
    return ti.max(ti.min((block + 1) * LANES, alive_end(crowd.whole, trial)), block * LANES)


def _moves(parts: MoveParts, kind: str) -> Func:
    """Build the func that moves a block of agents of a kind."""
    layout, types, see = parts.layout, parts.types, parts.see
    lanes, integers, dim = types.lanes, types.integer_lanes, len(layout.axes)
    ferry, alive_end = parts.carried[kind], getattr(parts.near, kind).alive_end
    save = ferry.saves(getattr(parts.near, kind))
    drive_one, step_of = getattr(parts.driven, kind), getattr(parts.driven.steps, kind)

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
            swarm = swarm_at(means, trial, ti.cast(clock[AGE], types.real))
            drive_one(here, draw, scratch, a, me, numbers, 0, swarm, target)
            step_of.commit(scratch, a, numbers, 0)
            ferry.save_rows(scratch, a, crowd, count, block, end)
        save(scratch, a, crowd, rows, block, end)

    return move_block


def _all_moves(parts: MoveParts, kind: str, move_block: Func) -> Func:
    """Build the kernel that moves all agents of a kind."""
    near, deep = parts.near, transfer.scratch_rows(parts.layout)
    flat = parts.types.lane_array(1)
    cold_array = ti.types.ndarray(dtype=parts.types.real, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)
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


def build(parts: MoveParts) -> MoveKernels:
    """Build the kernels."""
    near, deep = parts.near, transfer.scratch_rows(parts.layout)
    flat = parts.types.lane_array(1)
    cold_array = ti.types.ndarray(dtype=parts.types.real, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)
    hunted = parts.layout.structure.hunted
    move_prey_block = _moves(parts, "prey")

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

    return MoveKernels(
        move_prey=_all_moves(parts, "prey", move_prey_block),
        move_predators=_all_moves(parts, "predators", _moves(parts, "predators")) if hunted else None,
        move_plain=move_plain,
        run_plain=run_plain,
    )
