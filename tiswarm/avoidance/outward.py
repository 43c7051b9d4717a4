"""Outward: every near obstacle pushes straight away from its centre."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.avoidance import Avoidance
from tiswarm.lanes import near, outward


class Strategy(Avoidance):
    """Lupau 2022, equations 12 to 14."""

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the field."""

        push: float = 10.0  # strength [m²/s]
        reach: float = 3.0  # distance from the obstacle's edge at which the field ends [m]

    @staticmethod
    @ti.func
    def field(me, obstacle, target, weights):
        x = me.x - obstacle.x
        y = me.y - obstacle.y
        distance2 = x * x + y * y
        push = near(distance2, obstacle.radius + weights.reach) * outward(weights.push, distance2)
        return push * x, push * y
