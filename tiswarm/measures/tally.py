"""Tally: where what is measured of a block's trials is summed up, state by state."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.scenario.measures import PEAKS
from tiswarm.simd.lanes import larger
from tiswarm.simd.runtime import Func

# Rows of a block's sums behind two for each measure (sum and number of states): cells swept so far, and cells there are. Behind
# them, what each measure of PEAKS was at most.
CLEAN, FREE, GROUND_ROWS = range(3)


@dataclass(frozen=True)
class Tally:
    """Rows of sums, [block * height + row], and the funcs that write them."""

    height: int
    add: Func  # add a state's value of measure k where it is counted, a mask
    keep: Func  # put a value there in place of what was
    keep_least: Func  # put a value there where it is less than what was, or the first
    peak: Func  # give the greatest value of measure k so far, a state's value included where it is counted


def build(layout: ParameterTable) -> Tally:
    """Lay out the rows."""
    names = layout.structure.frame.measures
    first = 2 * len(names) + GROUND_ROWS
    peaked = [name for name in names if name in PEAKS]
    height = first + len(peaked)

    @ti.func
    def add(sums: ti.template(), b, k: ti.template(), counted, value):
        s = b * height + 2 * k
        sums[s] = sums[s] + ti.select(counted, value, 0.0)
        sums[s + 1] = sums[s + 1] + ti.select(counted, 1.0, 0.0)

    @ti.func
    def keep(sums: ti.template(), b, k: ti.template(), counted, value):
        s = b * height + 2 * k
        sums[s] = ti.select(counted, value, sums[s])
        sums[s + 1] = ti.select(counted, 1.0, sums[s + 1])

    @ti.func
    def keep_least(sums: ti.template(), b, k: ti.template(), counted, value):
        s = b * height + 2 * k
        keep(sums, b, k, counted & ((sums[s + 1] < 0.5) | (value < sums[s])), value)

    @ti.func
    def peak(sums: ti.template(), b, k: ti.template(), counted, value):
        s = b * height + first + ti.static(peaked.index(names[k]))
        sums[s] = ti.select(counted, larger(sums[s], value), sums[s])
        return sums[s]

    return Tally(height=height, add=add, keep=keep, keep_least=keep_least, peak=peak)
