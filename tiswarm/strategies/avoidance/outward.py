"""Outward: every near obstacle pushes straight away from its centre."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import scaled
from tiswarm.strategies.avoidance import ReachingField


class Strategy(ReachingField):
    """Lupau 2022, equations 12 to 14."""

    dimensions = (2, 3)

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the field."""

        push: float = 10.0  # strength [m²/s]
        reach: float = 3.0  # distance from the obstacle's edge at which the field ends [m]

    @staticmethod
    @ti.func
    def field(away, distance2, me, obstacle, target, weights):
        return scaled(away, weights.push / distance2)
