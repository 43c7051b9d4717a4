"""Predator strategies: one file each; the file's name is the name in presets."""

from dataclasses import dataclass

import taichi as ti


class Predator:
    """What a predator strategy may do; the base does nothing. Lanes rules: CONTRIBUTING, "Write a term in lanes".

    parts: names of other strategies that this one combines; a combination has no hooks of its own.
    dimensions: the worlds it supports.
    """

    parts: tuple[str, ...] = ()
    dimensions: tuple[int, ...] = (2,)

    @dataclass(frozen=True)
    class Weights:
        """The numbers of this strategy with their defaults and units."""

    @staticmethod
    def derived(weights):
        """Compute more numbers from the weights (a dict of name -> [trial]), on the host, once per trial."""
        return {}

    @staticmethod
    @ti.func
    def mates(me, mate, weights):
        """Tell whether a neighbour counts as one: 1 or 0."""
        return 1.0

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, weights):
        """Give where to go, (x, y); `predators.goal` times this is added to the velocity.

        quarry: the alive prey after their move, mean position (x, y) and velocity (vx, vy).
        """
        return 0.0, 0.0
