"""Predator strategies: one file each; the file's name is the name in presets."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import taichi as ti

from tiswarm.simd.lanes import motion, scaled


class Predator:
    """What a predator strategy may do; the base does nothing. Lanes rules: CONTRIBUTING, "Write a term in lanes".

    parts: names of other strategies that this one combines; a combination has no hooks of its own.
    dimensions: the worlds it supports.
    periodic: whether it has a meaning in a world without edges: moving everything must move its answer (`shortest` helps).
    notes: names of numbers that `observe` collects over single prey in one tick.
        "away*" stands for away_x, away_y and, in a deep world, away_z: `lanes.vector(notes, "away")`.
    memory: names of numbers that a predator keeps between ticks, all 0 at the start, for `survey` to set; "way*" as above.
    shown: those of them that it and its mates see as numbers of `me` and `mate`.
    whole: weights that are whole numbers, with the least and the largest that may be.
    needed: weights that, when not 0, need another one to be a certain word: name -> (name, word).
    live: the weight that, when not 0, lets `consult` do on the host what `survey` does in kernels: single trials only.
    flocks: whether the scenario's separation, cohesion and alignment act.
    rules: whether `pursue` gives the velocity itself, so that nothing else adds to it.
    chases: whom it goes for, for films: "swarm" (the middle of the alive prey), "group" (of those of its own), "one" (the
        weight `pursuit` says which: "nearest" or "cycle"); "" where that cannot be said.
    networked: whether a network, the file that the weight `network` names, sets gains or velocity by what is noted.
    """

    parts: tuple[str, ...] = ()
    dimensions: tuple[int, ...] = (2,)
    periodic: bool = True
    notes: tuple[str, ...] = ()
    memory: tuple[str, ...] = ()
    shown: tuple[str, ...] = ()
    whole: Mapping[str, tuple[int, int]] = MappingProxyType({})
    needed: Mapping[str, tuple[str, str]] = MappingProxyType({})
    live: str = ""
    flocks: bool = True
    rules: bool = False
    chases: str = ""
    networked: bool = False

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
    def groups(memory):
        """Give each predator's sub-swarm for recordings, [agent], -1 for none, from memory; None when none split."""

    @staticmethod
    def prey_groups(board, prey_count, dim):
        """Give the sub-swarm that predators take each prey for, [prey], -1 for none, from one trial's board; or None."""

    @staticmethod
    def board_rows(dim):
        """Count the rows of a block's board that `survey` needs: for any number of prey, and for each prey."""
        return 0, 0

    @staticmethod
    def survey(layout, types, see, uniform, part):
        """Build a func that looks at whole trials once a tick, after the prey's move and before any predator's.

        It is called as survey(prey, predators, board, numbers, trial, tick, b, counts, key_low, key_high), with the kernel's
        arrays; it works on the rows of the board from part.board on, and writes into the predators' memory, part.memory_rows.
        """

    @staticmethod
    def consult(board, memory, position, weights, key):
        """Write into one trial's board and its predators' memory, on the host, what `survey` would.

        memory: name -> [predator]; position: [prey, dim], m, NaN for the gone; key: whole numbers to draw by, others each tick.
        """

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
    def notice(notes: ti.template(), me, obstacle, away, weights):
        """Add to the notes what one obstacle tells, at any distance, for a network; away: the way from its centre."""

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, notes, weights):
        """Give where to go, one number an axis; `predators.goal` times this is added to the velocity.

        quarry: the alive prey after their move: how many (n), mean position (x, y) and velocity (vx, vy); age: ticks run.
        """
        return scaled(motion(me), 0.0)
