"""Formulas: what one agent or one pair adds to a measure, in lanes, for both engines; recorded.py defines the measures."""

import taichi as ti

from tiswarm.simd.lanes import dot, logarithm, motion, place, safe, smaller, unit
from tiswarm.space.box_lanes import displacement

# What `add_motion` sums up: agents, speeds, kinetic energy; then, an axis each, directions of motion and places.
COUNT, SPEED, ENERGY, AHEAD = range(4)


@ti.func
def add_motion(sums: ti.template(), me: ti.template(), origin: ti.template(), period: ti.template()):
    """Add an agent that is alive to the sums above, a list of lanes: [3 + 2 dim].

    period: an empty list, or a length an axis where the world repeats itself: then places are ways from `origin`.
    """
    dim = ti.static(len(place(me)))
    ahead = unit(motion(me))
    speed2 = dot(motion(me), motion(me))
    sums[COUNT] += me.alive
    sums[SPEED] += me.alive * ti.sqrt(speed2)
    sums[ENERGY] += 0.5 * me.alive * speed2
    for k in ti.static(range(dim)):
        sums[AHEAD + k] += me.alive * ahead[k]
        if ti.static(len(period) == 0):
            sums[AHEAD + dim + k] += me.alive * place(me)[k]
        else:
            sums[AHEAD + dim + k] += me.alive * displacement(place(me)[k] - origin[k], period[k])


@ti.func
def add_spin(spin: ti.template(), me: ti.template(), centre: ti.template(), period: ti.template()):
    """Add u(x - c) × u(v) of an agent that is alive: [3], in a flat world along the third axis alone."""
    off = [p - c for p, c in ti.static(zip(place(me), centre, strict=True))]
    for k in ti.static(range(len(period))):
        off[k] = displacement(off[k], period[k])
    way = unit(off)
    ahead = unit(motion(me))
    spin[2] += me.alive * (way[0] * ahead[1] - way[1] * ahead[0])
    if ti.static(len(way) == 3):
        spin[0] += me.alive * (way[1] * ahead[2] - way[2] * ahead[1])
        spin[1] += me.alive * (way[2] * ahead[0] - way[0] * ahead[2])


@ti.func
def pair_energy(distance2, reach2, spacing2):
    """Give the potential energy of a pair [m²/s²], constant beyond reach; all squared lengths."""
    ratio = safe(smaller(distance2, reach2)) / safe(spacing2)
    return spacing2 * (1.0 / ratio + logarithm(ratio))


@ti.func
def visit_cells(
    x, y, side, tool, across: ti.template(), down: ti.template(), period: ti.template(), visit: ti.template(),
    ground: ti.template(),
):  # fmt: skip
    """Visit every cell whose centre lies under the tool of an agent at x, y: `visit(ground, cell)`.

    period: an empty list, or the sides of a world that repeats itself: then under the tool's nearest image, each cell once.
    """
    reach = tool / side
    for turn in range(ti.static(1 + 4 * len(period))):
        column_x = x / side - 0.5  # in cells, whole numbers at their centres
        row_y = y / side - 0.5
        if ti.static(len(period) > 0):
            column_x += (turn % 3 - 1) * period[0] / side
            row_y += (turn // 3 - 1) * period[1] / side
        first = ti.max(ti.cast(ti.ceil(column_x - reach), ti.i32), 0)
        last = ti.min(ti.cast(ti.floor(column_x + reach), ti.i32), across - 1)
        for row in range(
            ti.max(ti.cast(ti.ceil(row_y - reach), ti.i32), 0), ti.min(ti.cast(ti.floor(row_y + reach), ti.i32), down - 1) + 1
        ):
            for column in range(first, last + 1):
                under = (column - column_x) * (column - column_x) + (row - row_y) * (row - row_y) <= reach * reach
                if ti.static(len(period) > 0):
                    half_x, half_y = 0.5 * period[0] / side, 0.5 * period[1] / side
                    under = under and column - column_x <= half_x and column_x - column < half_x
                    under = under and row - row_y <= half_y and row_y - row < half_y
                if under:
                    visit(ground, row * across + column)
