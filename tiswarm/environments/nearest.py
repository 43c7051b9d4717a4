"""Nearest: the few that are nearest to an agent, kept in lanes and written into observations."""

import taichi as ti

from tiswarm.simd.lanes import anywhere
from tiswarm.simd.runtime import LANES, Func, Types

FAR = 1e29
"""Beyond whatever is looked at [m, or m²]."""


@ti.func
def put(out: ti.template(), places: ti.template(), i, c, value):
    """Write a number of a block's trials, each at its place."""
    for lane in ti.static(range(LANES)):
        out[places[lane], i, c] = ti.cast(value[lane], ti.f32)


@ti.func
def keep_nearest(kept: ti.template(), away, found: ti.template(), most: ti.template()):
    """Put what was found where it belongs among the nearest so far; of equals the first stays first.

    kept: how far each is, nearest first, then what is shown of each.
    """
    size = ti.static(len(found))
    if anywhere(away < kept[most - 1]):
        for s in ti.static(range(most - 1, 0, -1)):
            closer, before = away < kept[s], away < kept[s - 1]
            for c in ti.static(range(size)):
                moved = ti.select(before, kept[most + (s - 1) * size + c], found[c])
                kept[most + s * size + c] = ti.select(closer, moved, kept[most + s * size + c])
            kept[s] = ti.select(closer, ti.select(before, kept[s - 1], away), kept[s])
        first = away < kept[0]
        for c in ti.static(range(size)):
            kept[most + c] = ti.select(first, found[c], kept[most + c])
        kept[0] = ti.select(first, away, kept[0])


def build_show(types: Types) -> Func:
    """Build the func that writes who was kept."""
    lanes = types.lanes

    @ti.func
    def show_kept(
        out: ti.template(),
        places: ti.template(),
        i,
        kept: ti.template(),
        at: ti.template(),
        size: ti.template(),
        units: ti.template(),
    ):
        """Write what was kept of each of the nearest, in its units, and 1; nothing but 0 where there is none."""
        most = ti.static(at[1])
        for s in ti.static(range(most)):
            here = kept[s] < 0.5 * FAR
            for c in ti.static(range(size)):
                value = ti.select(here, units[c] * kept[most + s * size + c], 0.0)
                put(out, places, i, at[0] + s * (size + 1) + c, value)
            put(out, places, i, at[0] + s * (size + 1) + size, ti.select(here, 1.0, lanes(0.0)))

    return show_kept
