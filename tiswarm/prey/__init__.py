"""Prey strategies: one file each; the file's name is the name in presets."""

from dataclasses import dataclass

import taichi as ti


class Prey:
    """What a prey strategy may do; the base does nothing. Lanes rules: CONTRIBUTING, "Write a term in lanes".

    parts: names of other strategies that this one combines; a combination has no hooks of its own.
    dimensions: the worlds it supports.
    memory: names of numbers that an agent keeps between ticks, all 0 at the start.
    notes: names of sums that `observe` collects over the mates in one tick.
    watches: whether `threat` is needed (it costs a loop over the predators).
    dice: whether `kick` needs two random numbers a tick.
    """

    parts: tuple[str, ...] = ()
    dimensions: tuple[int, ...] = (2,)
    memory: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    watches: bool = False
    dice: bool = False

    @dataclass(frozen=True)
    class Weights:
        """The numbers of this strategy with their defaults and units."""

    @staticmethod
    def derived(weights):
        """Compute more numbers from the weights (a dict of name -> [trial]), on the host, once per trial."""
        return {}

    @staticmethod
    def states(memory, weights):
        """Name states for recordings: {name: [agent] bool} from memory as {name: [agent]}."""
        return {}

    @staticmethod
    def group(number):
        """Give the sub-swarm of agent 1, 2, ... for recordings; -1 when the swarm does not split."""
        return -1

    @staticmethod
    @ti.func
    def mates(me, mate, weights):
        """Tell whether a neighbour counts as one: 1 or 0."""
        return 1.0

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, first, second, weights):
        """Add what one alive mate (any distance) tells to the notes; `first` and `second` are agents 1 and 2."""

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        """Give what is added to the velocity, (x, y)."""
        return 0.0, 0.0

    @staticmethod
    @ti.func
    def kick(threat, dice, memory, weights):
        """Give what is added to the velocity after the speed cap, (x, y)."""
        return 0.0, 0.0

    @staticmethod
    @ti.func
    def remember(memory: ti.template(), seen, swarm_seen, weights):
        """Update the memory at the end of a move; `seen` predators are in sight, `swarm_seen` in anybody's."""
