"""Crossing: walks of a block of one kind through the agents of another, whose cells are in another order."""

from collections.abc import Callable
from typing import Any

import taichi as ti

from tiswarm.simd.runtime import LANES, Func, Types
from tiswarm.space.cells import REACH_X

FAR = 1e15
"""Where lanes wait that do not visit: out of everyone's reach [m]."""


def build(funcs: Any, types: Types, dim: int, meet: Callable[..., Any]) -> Func:
    """Build a walk of any block through the agents of a kind. funcs: those of its grid; `meet` as for a grid's own walks."""
    lanes, real = types.lanes, types.real
    box, hashed, periodic = funcs.walks(meet).box, funcs.hashed, funcs.periodic

    @ti.func
    def together(whole: ti.template(), low: ti.template(), high: ti.template()):
        """Tell whether one walk serves all lanes: their cells lie close to each other, and it visits no cell twice."""
        spread = high - low
        close = 1
        for k in ti.static(range(dim)):
            reach = whole[REACH_X + k]
            if spread[k] > 2 * reach + 2:
                close = 0
            if ti.static(periodic):  # noqa: SIM102 - no cell may be visited twice
                if spread[k] + 2 * reach >= whole[ti.static(funcs.count_x) + k]:
                    close = 0
            if ti.static(hashed):  # noqa: SIM102 - nor any place in the table
                if (k > 0 and spread[k] > 0) or (k == 0 and not funcs.fits(whole, low[0], high[0])):
                    close = 0
        if spread[0] + spread[1] + spread[2] == 0:
            close = 1
        return close

    @ti.func
    def cross(view: ti.template(), p: ti.template(), crowd: ti.template(), trial):
        """Let lanes at p meet all within reach, together where they are close to each other, else one by one."""
        whole = ti.static(crowd.whole)
        low = ti.Vector([0, 0, 0])
        high = ti.Vector([0, 0, 0])
        cells = [funcs.lane_cells(p[k], k, whole, crowd.reals) for k in ti.static(range(dim))]
        for k in ti.static(range(dim)):
            low[k], high[k] = ti.cast(cells[k].min(), ti.i32), ti.cast(cells[k].max(), ti.i32)
        close = together(whole, low, high)
        reach = ti.Vector([whole[REACH_X], whole[REACH_X + 1], whole[REACH_X + 2]])
        for part in range(ti.select(close == 1, 1, LANES)):
            here = [1.0 * p[k] for k in ti.static(range(dim))]
            if close == 0:
                lane = lanes([float(number) for number in ti.static(range(LANES))])
                here[0] = ti.select(lane == ti.cast(part, real), p[0], FAR)
                for lane_of in ti.static(range(LANES)):
                    if lane_of == part:
                        for k in ti.static(range(dim)):
                            low[k] = ti.cast(cells[k][lane_of], ti.i32)
                            high[k] = low[k]
            box(view, here, crowd.agents, whole, crowd.reals, trial, low - reach, high + reach)

    return cross
