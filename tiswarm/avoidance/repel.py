"""Repel: near obstacles push away with the distance and a constant; the predators' own."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.avoidance import Avoidance
from tiswarm.lanes import near, safe


class Strategy(Avoidance):
    """The simulator of Lupau 2022: repel Σ (p - o)(1 + radius/|p - o|)."""

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the field."""

        repel: float = 0.3  # strength [1/s]
        reach: float = 5.0  # distance from the obstacle's edge at which the field ends [m]

    @staticmethod
    @ti.func
    def field(me, obstacle, target, weights):
        x = me.x - obstacle.x
        y = me.y - obstacle.y
        distance2 = x * x + y * y
        inside = near(distance2, obstacle.radius + weights.reach)
        push = inside * weights.repel * (1.0 + obstacle.radius / ti.sqrt(safe(distance2)))
        return push * x, push * y
