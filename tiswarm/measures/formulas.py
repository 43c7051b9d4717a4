"""Formulas: what one agent or one pair adds to a measure, in lanes, for both engines; recorded.py defines the measures."""

import taichi as ti

from tiswarm.simd.lanes import dot, logarithm, motion, place, safe, smaller, unit

# What `add_motion` sums up: agents, speeds, kinetic energy; then, an axis each, directions of motion and places.
COUNT, SPEED, ENERGY, AHEAD = range(4)


@ti.func
def add_motion(sums: ti.template(), me: ti.template()):
    """Add an agent that is alive to the sums above, a list of lanes: [3 + 2 dim]."""
    dim = ti.static(len(place(me)))
    ahead = unit(motion(me))
    speed2 = dot(motion(me), motion(me))
    sums[COUNT] += me.alive
    sums[SPEED] += me.alive * ti.sqrt(speed2)
    sums[ENERGY] += 0.5 * me.alive * speed2
    for k in ti.static(range(dim)):
        sums[AHEAD + k] += me.alive * ahead[k]
        sums[AHEAD + dim + k] += me.alive * place(me)[k]


@ti.func
def add_spin(spin: ti.template(), me: ti.template(), centre: ti.template()):
    """Add u(x - c) × u(v) of an agent that is alive: [3], in a flat world along the third axis alone."""
    way = unit([p - c for p, c in ti.static(zip(place(me), centre, strict=True))])
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
def visit_cells(x, y, side, tool, across: ti.template(), down: ti.template(), visit: ti.template(), ground: ti.template()):
    """Visit every cell whose centre lies under the tool of an agent at x, y: `visit(ground, cell)`."""
    column_x = x / side - 0.5  # in cells, whole numbers at their centres
    row_y = y / side - 0.5
    reach = tool / side
    first = ti.max(ti.cast(ti.ceil(column_x - reach), ti.i32), 0)
    last = ti.min(ti.cast(ti.floor(column_x + reach), ti.i32), across - 1)
    for row in range(
        ti.max(ti.cast(ti.ceil(row_y - reach), ti.i32), 0), ti.min(ti.cast(ti.floor(row_y + reach), ti.i32), down - 1) + 1
    ):
        for column in range(first, last + 1):
            if (column - column_x) * (column - column_x) + (row - row_y) * (row - row_y) <= reach * reach:
                visit(ground, row * across + column)
