"""Separation, cohesion and alignment."""

import taichi as ti

from tiswarm.simd.lanes import NOTHING, components, coordinates, dot, larger, motion, place, rates, vector


@ti.func
def see_mate(mates: ti.template(), mate, away, counts, perception2, spacing2):
    """Add one mate to what an agent sees of its swarm. counts: 1 where it is a neighbour if near enough, else 0.

    away: p - p_j, across a periodic edge where that is shorter.

    mates.n: neighbours; x, y, z: Σ (p - p_j); vx, vy, vz: Σ v_j; push_x, ...: Σ (p - p_j) over those within the spacing.
    """
    distance2 = dot(away, away)
    near = (distance2 <= perception2) & (counts > 0.5)
    close = near & (distance2 <= spacing2)
    mates.n += ti.select(near, 1.0, NOTHING)
    for k in ti.static(range(len(away))):
        place(mates)[k] += ti.select(near, away[k], NOTHING)
        motion(mates)[k] += ti.select(near, motion(mate)[k], NOTHING)
        vector(mates, "push")[k] += ti.select(close, away[k], NOTHING)


@ti.func
def note_mate(notes: ti.template(), mate, away, near):
    """Add a mate to the notes of a strategy that flocks by rules of its own. near: 1 where the mate counts, else 0.

    notes.n: how many; gather_x, ...: Σ (p_j - p); along_x, ...: Σ v_j.
    """
    notes.n += near
    for k in ti.static(range(len(away))):
        vector(notes, "gather")[k] += -1.0 * near * away[k]
        vector(notes, "along")[k] += near * motion(mate)[k]


def _home(me) -> list:
    """Give the way from the map's origin, zeros in a world that has none."""
    return [0.0 for _ in coordinates(me)] if components(me, "period") else coordinates(me)


@ti.func
def flock(me, mates, cohesion, separation, alignment):
    """Steer by the neighbours: cohesion (c - p) + separation Σ (p - p_j) + alignment (u - v).

    c, u: mean position and velocity of the neighbours, both zero when there are none: a lone agent is drawn weakly to
    the map's origin and damped, as in the simulator of Lupau 2022 (equations 5 to 9 and its differences from them). Where
    sight wraps no place is the origin, and a lone agent is only damped.
    """
    share = 1.0 / larger(mates.n, 1.0)
    lone = ti.select(mates.n < 0.5, 1.0, 0.0)
    return [
        separation * push - cohesion * (share * away + lone * here) + alignment * (share * together - own)
        for push, away, here, together, own in ti.static(
            zip(components(mates, "push"), coordinates(mates), _home(me), rates(mates), rates(me), strict=True)
        )
    ]


@ti.func
def draw_together(me, mates, drawn):
    """Give what `flock` gives with the agent's own gains, of the neighbours' sums in another form.

    drawn: alignment Σ v_j - cohesion Σ (p - p_j), a list; of the mates only n and push are read.
    """
    share = 1.0 / larger(mates.n, 1.0)
    lone = ti.select(mates.n < 0.5, me.cohesion, 0.0)
    return [
        me.separation * push + share * toward - lone * here - me.alignment * own
        for push, toward, here, own in ti.static(zip(components(mates, "push"), drawn, _home(me), rates(me), strict=True))
    ]
