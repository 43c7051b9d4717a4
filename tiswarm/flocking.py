"""Separation, cohesion, alignment and goal seeking."""

import taichi as ti

from tiswarm.lanes import larger


@ti.func
def see_mate(mates: ti.template(), me, mate, counts, perception2, spacing2):
    """Add one mate to what an agent sees of its swarm. counts: 1 where it is a neighbour if near enough, else 0.

    mates.n: neighbours; x, y: Σ (p - p_j); vx, vy: Σ v_j; push_x, push_y: Σ (p - p_j) over those within the spacing.
    """
    x = me.x - mate.x
    y = me.y - mate.y
    distance2 = x * x + y * y
    near = ti.select(distance2 <= perception2, counts, 0.0)
    close = ti.select(distance2 <= spacing2, near, 0.0)
    mates.n += near
    mates.x += near * x
    mates.y += near * y
    mates.vx += near * mate.vx
    mates.vy += near * mate.vy
    mates.push_x += close * x
    mates.push_y += close * y


@ti.func
def flock(me, mates, cohesion, separation, alignment):
    """Steer by the neighbours: cohesion (c - p) + separation Σ (p - p_j) + alignment (u - v).

    c, u: mean position and velocity of the neighbours, both (0, 0) when there are none: a lone agent is drawn weakly to
    the map's origin and damped, as in the simulator of Lupau 2022 (equations 5 to 9 and its differences from them).
    """
    share = 1.0 / larger(mates.n, 1.0)
    lone = ti.select(mates.n < 0.5, 1.0, 0.0)
    x = separation * mates.push_x - cohesion * (share * mates.x + lone * me.x) + alignment * (share * mates.vx - me.vx)
    y = separation * mates.push_y - cohesion * (share * mates.y + lone * me.y) + alignment * (share * mates.vy - me.vy)
    return x, y
