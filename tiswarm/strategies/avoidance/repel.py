"""Repel: near obstacles push away with the distance and a constant; the predators' own."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import scaled
from tiswarm.strategies.avoidance import ReachingField


class Strategy(ReachingField):
    """The simulator of Lupau 2022: repel Σ (p - o)(1 + radius/|p - o|)."""

    dimensions = (2, 3)

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the field."""

        repel: float = 0.3  # strength [1/s]
        reach: float = 5.0  # distance from the obstacle's edge at which the field ends [m]

    @staticmethod
    @ti.func
    def field(away, distance2, me, obstacle, target, weights):
        return scaled(away, weights.repel * (1.0 + obstacle.radius / ti.sqrt(distance2)))
