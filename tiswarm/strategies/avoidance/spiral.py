"""Spiral: every near obstacle pushes away and swirls anticlockwise."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.strategies.avoidance import ReachingField


class Strategy(ReachingField):
    """Lupau 2022, equations 15 to 17: A(r) = swirl (r_x - r_y, r_x + r_y) + push r/|r|²."""

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
        return push * away[0] - weights.swirl * away[1], push * away[1] + weights.swirl * away[0]
