"""Couzin: zones of repulsion, orientation and attraction, at one speed, with turns of limited rate and some error."""

from dataclasses import dataclass
from math import pi

import taichi as ti

from tiswarm.simd.lanes import cosine, dot, logarithm, motion, scaled, sine, smaller, unit, vector
from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Couzin, Krause, James, Ruxton and Franks 2002, equations 1 to 3: d = -Σ r̂ over the zone of repulsion, else Σ v̂ + Σ r̂.

    The zones reach to prey.spacing, `orientation` and prey.perception; the speed is prey.max_speed. prey.field_of_view hides
    mates from all zones but that of repulsion. Who sees nobody goes on.
    """

    dimensions = (2, 3)
    flocks = False
    feels = True
    notes = ("close", "apart*", "drawn*")  # how many are too near; Σ away from them; Σ of what the other zones say

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        orientation: float = 3.0  # how far mates are flown along with [m]
        turn_rate: float = 0.698  # θ, how fast the direction may change [rad/s]
        error: float = 0.05  # standard deviation of the direction aimed at [rad]

    @staticmethod
    def sight(weights, perception):
        return perception, 0.0

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        distance2 = dot(away, away)
        # Who is at the very same place gives no direction.
        there = ti.select((distance2 <= me.perception * me.perception) & (distance2 > 0.0), mate.alive, 0.0)
        close = ti.select(distance2 <= me.spacing * me.spacing, there, 0.0)
        along = (distance2 <= weights.orientation * weights.orientation) & (close < 0.5)
        repelled = close > 0.5
        course = motion(mate)
        way = unit(
            [ti.select(along, course[k], ti.select(repelled, away[k], 0.0 - away[k])) for k in ti.static(range(len(away)))]
        )
        notes.close += close
        for k in ti.static(range(len(away))):
            vector(notes, "apart")[k] += close * way[k]
            vector(notes, "drawn")[k] += (there - close) * way[k]

    @staticmethod
    @ti.func
    def roam(me, push, notes, dice, dt, weights):
        own = unit(motion(me))
        apart, drawn = vector(notes, "apart"), vector(notes, "drawn")
        crowded = notes.close > 0.5
        aim = unit([ti.select(crowded, apart[k], drawn[k]) + push[k] for k in ti.static(range(len(own)))])
        lost = dot(aim, aim) < 0.5
        for k in ti.static(range(len(own))):
            aim[k] = ti.select(lost, own[k], aim[k])
        size = weights.error * ti.sqrt(0.0 - 2.0 * logarithm(1.0 - dice.a))
        err = erring(aim, size, 2.0 * pi * dice.b)
        return scaled(turned(own, err, smaller(weights.turn_rate * dt, pi)), me.max_speed)


@ti.func
def erring(aim, size, side):
    """Turn a direction by an angle of a given size: in space to the side of an angle, in the plane by its cosine's share."""
    found = scaled(aim, 1.0)
    c, s = cosine(side), sine(side)
    if ti.static(len(aim) == 2):
        angle = size * c
        c, s = cosine(angle), sine(angle)
        found[0], found[1] = c * aim[0] - s * aim[1], s * aim[0] + c * aim[1]
    else:  # two directions across it: Duff et al. 2017, Building an orthonormal basis, revisited
        x, y, z = aim[0], aim[1], aim[2]
        sign = ti.select(z < 0.0, -1.0, 1.0)
        a = -1.0 / (sign + z)
        b = x * y * a
        across = [1.0 + sign * x * x * a, sign * b, 0.0 - sign * x]
        other = [b, sign + y * y * a, 0.0 - y]
        ahead, off = cosine(size), sine(size)
        for k in ti.static(range(3)):
            found[k] = ahead * aim[k] + off * (c * across[k] + s * other[k])
    return found


@ti.func
def turned(own, aim, most):
    """Turn a direction towards another one, by an angle of at most `most`."""
    along = dot(own, aim)
    c, s = cosine(most), sine(most)
    across = unit([aim[k] - along * own[k] for k in ti.static(range(len(own)))])
    return unit([ti.select(along >= c, aim[k], c * own[k] + s * across[k]) for k in ti.static(range(len(own)))])
