"""Standing: whether all prey of a block's trials stand still, and whose commands a certificate changed; see recorded.py."""

import taichi as ti

from tiswarm.dynamics.rows import ARRIVED_COUNT
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.measures.tally import Tally
from tiswarm.scenario.measures import STILL
from tiswarm.simd.lanes import dot, larger, motion
from tiswarm.simd.runtime import Func, Types


def build(layout: ParameterTable, types: Types, see: Views, tally: Tally) -> Func:
    """Build what adds the measures "stalled" and "corrected" of a state."""
    at, rows, width, lanes = layout.at, layout.rows, len(layout.paths), types.lanes
    prey_rows, prey_mate = layout.agent_rows["prey"], see.mate_at["prey"]
    frame = layout.structure.frame

    @ti.func
    def measure_standing(
        sums: ti.template(), prey: ti.template(), numbers: ti.template(), clock: ti.template(), b, count, counted
    ):
        still = STILL * numbers[b * width + at.prey.max_speed]
        alive, moving, corrected = lanes(0.0), lanes(0.0), lanes(0.0)
        for i in range(count):
            a = (b * count + i) * prey_rows
            me = prey_mate(prey, a, i)
            alive += me.alive
            moving += ti.select(dot(motion(me), motion(me)) < still * still, 0.0, me.alive)
            if ti.static(frame.safety != ""):
                corrected += me.alive * prey[a + rows.corrected]
        there = counted & (alive > 0.5)
        for k, name in ti.static(enumerate(frame.measures)):
            if ti.static(name == "stalled"):
                tally.add(sums, b, k, there, ti.select((moving < 0.5) & (clock[b, ARRIVED_COUNT] < 0.5), 1.0, 0.0))
            if ti.static(name == "corrected"):
                tally.add(sums, b, k, there, corrected / larger(alive, 1.0))

    return measure_standing
