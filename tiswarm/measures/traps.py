"""Traps: prey that keep moving and get nowhere, found while a trial runs; deadlocks.py says what counts, and why."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.rows import AGE
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import dot, place
from tiswarm.simd.runtime import Func, Types


@dataclass(frozen=True)
class Watch:
    """Who is trapped: one agent after the other, or all of a block's trials at once."""

    pursue: Func
    watch: Func


def build(layout: ParameterTable, types: Types, see: Views) -> Watch:
    """Build `pursue`, for one agent, and `watch`, for all of a block's trials.

    Rows of an agent (layout.rows.trap): anchor, where its window began [m]; last, where it was [m]; total, the sum of its ways
    from the anchor [m]; held, the window's age [ticks]; path, how far it went in it [m]; counted, how much of `held` is in
    `time`; time, how long it has been trapped [ticks]; spin and most, how far it circled, and could have, since `counted` [m²];
    spin_sum and most_sum, the same while it was trapped.
    """
    lanes = types.lanes
    at, dim = layout.at.trap, len(layout.axes)
    rows, prey_rows = layout.rows.trap, layout.agent_rows["prey"]
    prey_mate = see.mate_at["prey"]
    width = len(layout.paths)
    milling = "trapped-milling" in layout.structure.frame.measures
    Place = ti.types.struct(**dict.fromkeys("xyz"[:dim], lanes))  # noqa: N806 - a type

    @ti.func
    def follow(prey: ti.template(), a, me: ti.template(), numbers: ti.template(), b, starts, here):
        """Take one state of a prey into its window; a window begins where a trial starts or the prey has left the old one."""
        last = Place(*[prey[a + row] for row in ti.static(rows.last)])
        anchor = Place(*[prey[a + row] for row in ti.static(rows.anchor)])
        within = numbers[b * width + at.within]
        way = see.gap(me, anchor, numbers, b)
        anew = starts | (here & (dot(way, way) > within * within))
        step = see.gap(me, last, numbers, b)
        held = prey[a + rows.held] + ti.select(here, 1.0, 0.0)
        length = ti.sqrt(dot(step, step))
        path = prey[a + rows.path] + ti.select(here, length, 0.0)
        if ti.static(milling):
            total = [prey[a + rows.total[k]] + ti.select(here, way[k], 0.0) for k in ti.static(range(dim))]
            arm = [way[k] - total[k] / (held + 1.0) for k in ti.static(range(dim))]
            spin = ti.select(here, arm[0] * step[1] - arm[1] * step[0], 0.0)
            most = ti.select(here, ti.sqrt(dot(arm, arm)) * length, 0.0)
            prey[a + rows.spin] = ti.select(anew, 0.0, prey[a + rows.spin] + spin)
            prey[a + rows.most] = ti.select(anew, 0.0, prey[a + rows.most] + most)
            for k in ti.static(range(dim)):
                prey[a + rows.total[k]] = ti.select(anew, 0.0, total[k])
        prey[a + rows.held] = ti.select(anew, 0.0, held)
        prey[a + rows.path] = ti.select(anew, 0.0, path)
        prey[a + rows.counted] = ti.select(anew, 0.0, prey[a + rows.counted])
        for k in ti.static(range(dim)):
            prey[a + rows.anchor[k]] = ti.select(anew, place(me)[k], prey[a + rows.anchor[k]])
            prey[a + rows.last[k]] = ti.select(here, place(me)[k], prey[a + rows.last[k]])

    @ti.func
    def count_in(prey: ti.template(), a, numbers: ti.template(), b, starts, here):
        """Add what a prey's window has beyond what is counted, if that is a trap."""
        n = b * width
        held = prey[a + rows.held]
        old = here & (held > numbers[n + at.window] - 0.5)
        stuck = old & (prey[a + rows.path] * numbers[n + at.window] >= numbers[n + at.path] * held)
        time = ti.select(starts, 0.0, prey[a + rows.time])
        prey[a + rows.time] = time + ti.select(stuck, held - prey[a + rows.counted], 0.0)
        prey[a + rows.counted] = ti.select(stuck, held, prey[a + rows.counted])
        if ti.static(milling):
            spin = ti.select(starts, 0.0, prey[a + rows.spin_sum])
            most = ti.select(starts, 0.0, prey[a + rows.most_sum])
            prey[a + rows.spin_sum] = spin + ti.select(stuck, prey[a + rows.spin], 0.0)
            prey[a + rows.most_sum] = most + ti.select(stuck, prey[a + rows.most], 0.0)
            prey[a + rows.spin] = ti.select(stuck, 0.0, prey[a + rows.spin])
            prey[a + rows.most] = ti.select(stuck, 0.0, prey[a + rows.most])

    @ti.func
    def pursue(prey: ti.template(), a, me: ti.template(), numbers: ti.template(), b, starts, here):
        """Take one state of a prey in. starts: where it is the first of a trial; here: where the prey is alive."""
        follow(prey, a, me, numbers, b, starts, here)
        count_in(prey, a, numbers, b, starts, here)

    @ti.func
    def watch(prey: ti.template(), numbers: ti.template(), clock: ti.template(), b, count, unseen):
        """Follow all prey; give how many were ever trapped, for how long together [ticks], and their spin and most [m²]."""
        caught, time, spin, most = lanes(0.0), lanes(0.0), lanes(0.0), lanes(0.0)
        starts = unseen & (clock[b, AGE] < 0.5)
        for i in range(count):
            a = (b * count + i) * prey_rows
            me = prey_mate(prey, a, i)
            here = unseen & (me.alive > 0.5)
            pursue(prey, a, me, numbers, b, starts, here)
            caught += ti.select(prey[a + rows.time] > 0.5, 1.0, 0.0)
            time += prey[a + rows.time]
            if ti.static(milling):
                spin += prey[a + rows.spin_sum]
                most += prey[a + rows.most_sum]
        return caught, time, spin, most

    return Watch(pursue=pursue, watch=watch)
