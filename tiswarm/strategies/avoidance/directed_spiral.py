"""Directed spiral: like spiral, but clockwise around obstacles that lie towards the target."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.strategies.avoidance import ReachingField


class Strategy(ReachingField):
    """Lupau 2022, equations 18 to 21, in the sense of its simulator: equation 20 prints the two senses the other way round."""

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the field."""

        push: float = 10.0  # strength of the outward part [m²/s]
        swirl: float = 1.0  # strength of the spiral part [1/s]
        reach: float = 3.0  # distance from the obstacle's edge at which the field ends [m]

    @staticmethod
    @ti.func
    def field(away, distance2, me, obstacle, target, weights):
        push = weights.push / distance2 + weights.swirl
        # (target - p)·(o - p) > 0, with o - p = -r
        ahead = (target.x - me.x) * away[0] + (target.y - me.y) * away[1] < 0.0
        swirl = ti.select(ahead, -1.0 * weights.swirl, weights.swirl)
        return push * away[0] - swirl * away[1], push * away[1] + swirl * away[0]
