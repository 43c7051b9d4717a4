"""Obstacle avoidances: one file each; the file's name is the name in presets."""

from dataclasses import dataclass

import taichi as ti


class Avoidance:
    """What an avoidance may do; the base does nothing. Lanes rules: CONTRIBUTING, "Write a term in lanes".

    parts: names of other avoidances that this one combines; a combination has no hooks of its own.
    dimensions: the worlds it supports.
    """

    parts: tuple[str, ...] = ()
    dimensions: tuple[int, ...] = (2,)

    @dataclass(frozen=True)
    class Weights:
        """The numbers of this avoidance with their defaults and units."""

    @staticmethod
    def derived(weights):
        """Compute more numbers from the weights (a dict of name -> [trial]), on the host, once per trial."""
        return {}

    @staticmethod
    @ti.func
    def reach(weights):
        """Give the distance from an obstacle's edge at which its field ends [m]."""
        return 0.0

    @staticmethod
    @ti.func
    def field(x, y, distance2, me, obstacle, target, weights):
        """Give one obstacle's contribution to the agent's velocity, (x, y), from r = (x, y), the way from its centre.

        distance2: |r|², never quite 0. Lanes out of reach are dropped by the caller.
        """
        return 0.0, 0.0

    @staticmethod
    @ti.func
    def blocks(me, course, obstacle, weights):
        """Tell whether an obstacle blocks the course (the velocity after all terms): 1 or 0."""
        return 0.0

    @staticmethod
    @ti.func
    def turn(weights):
        """Give cosine and sine of the angle by which a blocked course is rotated, anticlockwise."""
        return 1.0, 0.0
