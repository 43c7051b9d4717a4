"""Spring: near obstacles push away the more the nearer they are, and brake whoever comes closer."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.strategies import ReachingField, dot, motion, scaled, smaller


class Strategy(ReachingField):
    """Lupau 2022, section 3.1: k (D - |p - o|), D from the obstacle's centre, by the agent's mass; D = its radius + `reach`.

    The thesis's program takes D = 0.5 m, the size of the agent: smaller than any obstacle, so that nobody alive ever feels it.
    """

    dimensions = (2, 3)

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the field."""

        push: float = 0.1  # stiffness by the agent's mass [1/s²]
        brake: float = 0.0  # damping of the speed of approach by the agent's mass [1/s]
        reach: float = 2.5  # distance from the obstacle's edge at which the field ends [m]

    @staticmethod
    @ti.func
    def field(away, distance2, me, obstacle, target, weights):
        distance = ti.sqrt(distance2)
        approach = smaller(dot(motion(me), away) / distance, 0.0)
        force = weights.push * (obstacle.radius + weights.reach - distance) - weights.brake * approach
        return scaled(away, force / distance)
