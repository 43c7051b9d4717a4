"""Obstacle avoidances: one file each; the file's name is the name in presets."""

from dataclasses import dataclass
from math import inf

import taichi as ti

from tiswarm.simd.lanes import scaled


class Avoidance:
    """What an avoidance may do; the base does nothing. Lanes rules: CONTRIBUTING, "Write a term in lanes".

    parts: names of other avoidances that this one combines; a combination has no hooks of its own.
    dimensions: the worlds it supports.
    periodic: whether it has a meaning in a world without edges: moving everything must move its answer (`shortest` helps).
    notes: names of numbers that `look` collects over the obstacles in one tick.
        "away*" stands for away_x, away_y and, in a deep world, away_z: `lanes.vector(notes, "away")`.
    """

    parts: tuple[str, ...] = ()
    dimensions: tuple[int, ...] = (2,)
    periodic: bool = True
    notes: tuple[str, ...] = ()

    @dataclass(frozen=True)
    class Weights:
        """The numbers of this avoidance with their defaults and units."""

    @staticmethod
    def derived(weights):
        """Compute more numbers from the weights (a dict of name -> [trial]), on the host, once per trial."""
        return {}

    @staticmethod
    def sight(weights):
        """Give how far from an obstacle's edge any hook may heed it [m]: large swarms visit no obstacle beyond."""
        return inf

    @staticmethod
    @ti.func
    def reach(weights):
        """Give the distance from an obstacle's edge at which its field ends [m]."""
        return 0.0

    @staticmethod
    @ti.func
    def field(away, distance2, me, obstacle, target, weights):
        """Give one obstacle's contribution to the agent's velocity, from r = away, the way from its centre.

        distance2: |r|², never quite 0. Lanes out of reach are dropped by the caller.
        """
        return scaled(away, 0.0)

    @staticmethod
    @ti.func
    def blocks(me, course, away, obstacle, weights):
        """Tell whether an obstacle blocks the course (the velocity after all terms): 1 or 0. Flat worlds only."""
        return 0.0

    @staticmethod
    @ti.func
    def turn(weights):
        """Give cosine and sine of the angle by which a blocked course is rotated, anticlockwise."""
        return 1.0, 0.0

    @staticmethod
    @ti.func
    def look(notes: ti.template(), me, course, away, obstacle, weights):
        """Add to the notes what one obstacle tells about the course (the velocity after the cap)."""

    @staticmethod
    @ti.func
    def deflect(me, course, notes, target, dice, weights):
        """Give another course, from what `look` noted; dice.a, dice.b: two random numbers in [0, 1)."""
        return scaled(course, 1.0)


class ReachingField(Avoidance):
    """An avoidance that sees no obstacle whose edge is further away than its weight `reach` [m]."""

    @staticmethod
    def sight(weights):
        """Give the weight `reach`."""
        return weights["reach"]

    @staticmethod
    @ti.func
    def reach(weights):
        """Give the weight `reach`."""
        return weights.reach
