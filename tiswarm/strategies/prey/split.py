"""Split: two sub-swarms that push apart at first and then flock on their own."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import dot
from tiswarm.space.box_lanes import shortest
from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Lupau 2022, section 6.2, split: odd and even agents are no neighbours, and at first each is pushed away from m.

    m is the mean position of the other sub-swarm as its reference agent (2 for odd agents, 1 for even ones) sees it.
    """

    leads = True
    notes = ("n", "x", "y")

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        part: float = 200.0  # strength of the push [1/s]
        part_ticks: float = 30.0  # last tick in which it acts, counted from 0
        part_range: float = 50.0  # how far away the other sub-swarm is felt [m]

    @staticmethod
    def sight(weights, perception):
        return weights["part_range"], 0.0

    @staticmethod
    def group(number):
        return number % 2

    @staticmethod
    @ti.func
    def mates(me, mate, weights):
        return 1.0 - (me.odd - mate.odd) * (me.odd - mate.odd)

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        odd = me.odd
        even = 1.0 - odd
        lead_x, lead_y = odd * second.x + even * first.x, odd * second.y + even * first.y
        from_x, from_y = shortest(me, [mate.x - lead_x, mate.y - lead_y])
        seen = from_x * from_x + from_y * from_y <= me.perception * me.perception
        felt = dot(away, away) <= weights.part_range * weights.part_range
        other = (odd - mate.odd) * (odd - mate.odd) * ti.select(mate.number > 2.5, 1.0, 0.0)
        counted = ti.select(seen & felt, other * mate.alive * (odd * second.alive + even * first.alive), 0.0)
        notes.n += counted
        notes.x += counted * mate.x
        notes.y += counted * mate.y

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        share = 1.0 / ti.max(notes.n, 1.0)
        push = ti.select((notes.n > 0.5) & (swarm.age <= weights.part_ticks), weights.part, 0.0)
        return push * (me.x - share * notes.x), push * (me.y - share * notes.y)
