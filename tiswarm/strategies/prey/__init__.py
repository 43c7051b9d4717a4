"""Prey strategies: one file each; the file's name is the name in presets."""

from dataclasses import dataclass
from math import inf

import taichi as ti

from tiswarm.simd.lanes import motion, place, plus, scaled


class Prey:
    """What a prey strategy may do; the base does nothing. Lanes rules: CONTRIBUTING, "Write a term in lanes".

    parts: names of other strategies that this one combines; a combination has no hooks of its own.
    dimensions: the worlds it supports.
    periodic: whether it has a meaning in a world without edges: moving everything must move its answer (`shortest` helps).
    flat_only: (weight, choice) pairs that have a meaning in the plane only.
    memory: names of numbers that an agent keeps between ticks, all 0 at the start.
    notes: names of sums that `observe` and `beware` collect over mates and predators in one tick.
        "away*" stands for away_x, away_y and, in a deep world, away_z: `lanes.vector(notes, "away")`.
    shown: those of them that mates see of each other, as numbers of `me` and `mate`.
    flocks: whether the scenario's separation, cohesion and alignment act as in flocking.py; else the strategy sees to it.
    feels: whether `observe` is told of mates within the scenario's spacing where prey.field_of_view or nearest would hide them.
    watches: whether `threat` is needed (it costs a loop over the predators).
    leads: whether `observe` needs agents 1 and 2.
    most: how many agents it works for at most, 0 for any number.
    dice: whether `kick` needs two random numbers a tick.
    networked: whether a network, the file that the weight `network` names, sets gains or velocity by what is noted.
    """

    parts: tuple[str, ...] = ()
    dimensions: tuple[int, ...] = (2,)
    periodic: bool = True
    flat_only: tuple[tuple[str, str], ...] = ()
    memory: tuple[str, ...] = ()
    shown: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    flocks: bool = True
    feels: bool = False
    watches: bool = False
    leads: bool = False
    most: int = 0
    dice: bool = False
    networked: bool = False

    @dataclass(frozen=True)
    class Weights:
        """The numbers of this strategy with their defaults and units."""

    @staticmethod
    def derived(weights):
        """Compute more numbers from the weights (a dict of name -> [trial]), on the host, once per trial."""
        return {}

    @staticmethod
    def sight(weights, perception):
        """Give how far `observe` and `beware` look [m]: large swarms visit nobody beyond, and inf compares all pairs."""
        return inf, inf

    @staticmethod
    def kick_speed(weights):
        """Give how long a `kick` is at most [m/s]: large swarms look so much farther for what is touched on the way."""
        return inf

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
    def start(memory: ti.template(), me, weights):
        """Set the memory before the first tick."""

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        """Add to the notes what one other mate tells, at any distance, gone ones (mate.alive = 0) too.

        away: the way from it to me, which alone tells how near it is; first, second: agents 1 and 2, if the strategy `leads`.
        """

    @staticmethod
    @ti.func
    def beware(notes: ti.template(), me, hunter, away, weights):
        """Add to the notes what one predator tells, at any distance, gone ones (hunter.alive = 0) too."""

    @staticmethod
    @ti.func
    def notice(notes: ti.template(), me, obstacle, away, weights):
        """Add to the notes what one obstacle tells, at any distance, for a network; away: the way from its centre."""

    @staticmethod
    @ti.func
    def urge(me, weights):
        """Give the share of the pull to the target that an agent heeds."""
        return 1.0

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        """Give what is added to the velocity, one number an axis."""
        return scaled(motion(me), 0.0)

    @staticmethod
    @ti.func
    def integrate(me, push, swarm, notes, memory, dt, weights):
        """Give the velocity after the tick, before the cap: for models driven by acceleration, in the place of `steer`.

        push: what goal, field and walls would add to the velocity.
        """
        return plus(motion(me), push)

    @staticmethod
    @ti.func
    def roam(me, push, notes, dice, dt, weights):
        """Give the velocity after the tick, before the cap, as `integrate` does: for models that draw their direction.

        dice: a, b, uniform in [0, 1), others each tick.
        """
        return plus(motion(me), push)

    @staticmethod
    @ti.func
    def keep(memory: ti.template(), course, notes, weights):
        """Keep in the memory what was noted in this move; course: the velocity after it, before the cap.

        Mates must not heed what changes here: some have moved already, others have not.
        """

    @staticmethod
    @ti.func
    def kick(threat, dice, memory, weights):
        """Give what is added to the velocity after the speed cap, one number an axis."""
        return scaled(place(threat), 0.0)

    @staticmethod
    @ti.func
    def remember(memory: ti.template(), me, seen, swarm_seen, weights):
        """Update the memory at the end of a move; `seen` predators were in sight, `swarm_seen` in anybody's."""
