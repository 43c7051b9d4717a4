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
from tiswarm.engine.swarms import means, moves, transfer
from tiswarm.engine.swarms.moves import MoveParts, end_of
from tiswarm.engine.swarms.near_cells import CellSearch
from tiswarm.engine.swarms.transfer import LOOP, share_of
from tiswarm.simd.lanes import Bundle
from tiswarm.simd.runtime import LANES, TASK, Func, Types
from tiswarm.space import box, box_lanes
from tiswarm.space.cells import CELLS, HEAD, SLOTS, TRIALS


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


def _revises(parts: MoveParts, kind: str, revise: Func) -> Func:
    """Build a kernel that lets `revise` change what agents of a kind remember."""
    ferry, funcs, deep = parts.carried[kind], getattr(parts.near, kind), transfer.scratch_rows(parts.layout)
    lanes, flat = parts.types.lanes, parts.types.lane_array(1)
    cold_array = ti.types.ndarray(dtype=parts.types.real, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)

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


def _drifts(parts: MoveParts, kind: str) -> Func:
    """Build the kernel of the half step that comes first in Verlet's scheme."""
    layout, funcs = parts.layout, getattr(parts.near, kind)
    dim, frame, flat = len(layout.axes), layout.structure.frame, parts.types.lane_array(1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)

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


def build(
    layout: ParameterTable,
    types: Types,
    see: Views,
    senses: CellSearch,
    near: Any,
    uniform: Any,
) -> TickKernels:
    """Build the kernels of a tick, and what the host asks about them: whether prey have memory to begin with or to update.

    move_prey, move_predators, drift_prey, drift_predators, face (predators), begin, remember (prey), average, rank; move_plain
    and run_plain, for prey that meet nobody but each other.
    """
    lanes, frame = types.lanes, layout.structure.frame
    driven = steering.build(layout, types, see, senses, uniform)
    steps = driven.steps
    carried = {kind: transfer.build(layout, types, see, senses, kind) for kind in ("prey", "predators")}
    parts = MoveParts(layout, types, see, near, driven, carried)

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

    strategies = layout.parts("prey", "strategy")
    return TickKernels(
        **vars(moves.build(parts)),
        begin=_revises(parts, "prey", begin),
        face=_revises(parts, "predators", face),
        remember=_revises(parts, "prey", remember),
        drift_prey=_drifts(parts, "prey"),
        drift_predators=_drifts(parts, "predators"),
        **vars(means.build(layout, types, near, carried["prey"].number_in)),
        starts=driven.memories.starts or "prey" in frame.unicycles,
        remembers=driven.memories.remembers,
        ranks=any(p.strategy.leads for p in strategies) or bool(layout.parts("predators", "strategy", "observe")),
        scans=any({"blocks", "look"} & set(p.own) for p in layout.parts("prey", "avoidance")),
        averages=layout.structure.hunted or any({"steer", "integrate"} & set(p.own) for p in strategies),
    )
