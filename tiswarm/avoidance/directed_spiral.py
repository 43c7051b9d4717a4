"""Directed spiral: like spiral, but clockwise around obstacles that lie towards the target."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.avoidance import Avoidance
from tiswarm.lanes import near, outward


class Strategy(Avoidance):
    """Lupau 2022, equations 18 to 21, in the sense of its simulator: equation 20 prints the two senses the other way round."""

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the field."""

        push: float = 10.0  # strength of the outward part [m²/s]
        swirl: float = 1.0  # strength of the spiral part [1/s]
        reach: float = 3.0  # distance from the obstacle's edge at which the field ends [m]

    @staticmethod
    @ti.func
    def field(me, obstacle, target, weights):
        x = me.x - obstacle.x
        y = me.y - obstacle.y
        distance2 = x * x + y * y
        inside = near(distance2, obstacle.radius + weights.reach)
        # (target - p)·(o - p) > 0, with o - p = -(x, y)
        ahead = (target.x - me.x) * x + (target.y - me.y) * y < 0.0
        push = inside * (outward(weights.push, distance2) + weights.swirl)
        swirl = inside * ti.select(ahead, -1.0 * weights.swirl, weights.swirl)
        return push * x - swirl * y, push * y + swirl * x
