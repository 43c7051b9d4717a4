"""Predator strategies: one file each; the file's name is the name in presets."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.lanes import motion, scaled


class Predator:
    """What a predator strategy may do; the base does nothing. Lanes rules: CONTRIBUTING, "Write a term in lanes".

    parts: names of other strategies that this one combines; a combination has no hooks of its own.
    dimensions: the worlds it supports.
    notes: names of numbers that `observe` collects over single prey in one tick.
        "away*" stands for away_x, away_y and, in a deep world, away_z: `lanes.vector(notes, "away")`.
    flocks: whether the scenario's separation, cohesion and alignment act.
    rules: whether `pursue` gives the velocity itself, so that nothing else adds to it.
    """

    parts: tuple[str, ...] = ()
    dimensions: tuple[int, ...] = (2,)
    notes: tuple[str, ...] = ()
    flocks: bool = True
    rules: bool = False

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
    def observe(notes: ti.template(), me, prey, away, quarry, weights):
        """Add to the notes what one prey tells after its move, at any distance, gone ones (prey.alive = 0) too.

        away: the way from it to me.
        """

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, notes, weights):
        """Give where to go, one number an axis; `predators.goal` times this is added to the velocity.

        quarry: the alive prey after their move: how many (n), mean position (x, y) and velocity (vx, vy); age: ticks run.
        """
        return scaled(motion(me), 0.0)
