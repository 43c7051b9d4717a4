"""Steer away: turn once, anticlockwise, when any obstacle blocks the course."""

from dataclasses import dataclass

import numpy as np
import taichi as ti

from tiswarm.simd.lanes import larger
from tiswarm.strategies.avoidance import Avoidance


class Strategy(Avoidance):
    """Lupau 2022, equations 22 to 30. Equation 30 varies the sign; its simulator always turns anticlockwise."""

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the turn."""

        turn: float = 0.15  # angle of one turn [π rad]
        lookahead: float = 30.0  # distance from the obstacle's edge at which it is looked at [m]

    @staticmethod
    def derived(weights):
        """Compute the rotation once per trial: lanes have no sine."""
        return {"cosine": np.cos(np.pi * weights["turn"]), "sine": np.sin(np.pi * weights["turn"])}

    @staticmethod
    def sight(weights):
        return weights["lookahead"]

    @staticmethod
    @ti.func
    def blocks(me, course, away, obstacle, weights):
        """|tan(angle to the centre)| <= (my radius + its radius)/distance, without the divisions.

        An obstacle right behind blocks too, as its tangent is small as well: the simulator's quirk, kept.
        """
        distance2 = away[0] * away[0] + away[1] * away[1]
        across = course[0] * away[1] - course[1] * away[0]  # its sign, and that of the next, do not matter
        along = course[0] * away[0] + course[1] * away[1]
        size = me.radius + obstacle.radius
        lookahead = larger(obstacle.radius + weights.lookahead, 0.0)
        ahead = across * across * distance2 <= size * size * along * along
        return ti.select(ahead & (distance2 <= lookahead * lookahead), 1.0, 0.0)

    @staticmethod
    @ti.func
    def turn(weights):
        return weights.cosine, weights.sine
