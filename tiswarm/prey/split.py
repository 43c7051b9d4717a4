"""Split: two sub-swarms that push apart at first and then flock on their own."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.lanes import near
from tiswarm.prey import Prey


class Strategy(Prey):
    """Lupau 2022, section 6.2, split: odd and even agents are no neighbours, and for `part_ticks` ticks each is pushed
    away from m, the mean position of the other sub-swarm as its reference agent (2 for odd, 1 for even) sees it.
    """

    notes = ("n", "x", "y")

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        part: float = 200.0  # strength of the push [1/s]
        part_ticks: float = 30.0  # last tick in which it acts, counted from 0
        part_range: float = 50.0  # how far away the other sub-swarm is felt [m]

    @staticmethod
    def group(number):
        return number % 2

    @staticmethod
    @ti.func
    def mates(me, mate, weights):
        return ti.select((me.number + mate.number) % 2 == 0, 1.0, 0.0)

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, first, second, weights):
        odd = ti.select(me.number % 2 == 1, 1.0, 0.0)
        reference_x = odd * second.x + (1.0 - odd) * first.x
        reference_y = odd * second.y + (1.0 - odd) * first.y
        reference_alive = odd * second.alive + (1.0 - odd) * first.alive
        other = ti.select(((me.number + mate.number) % 2 == 1) & (mate.number > 2), 1.0, 0.0)
        seen = near((mate.x - reference_x) ** 2 + (mate.y - reference_y) ** 2, me.perception)
        felt = near((mate.x - me.x) ** 2 + (mate.y - me.y) ** 2, weights.part_range)
        counted = other * reference_alive * mate.alive * seen * felt
        notes.n += counted
        notes.x += counted * mate.x
        notes.y += counted * mate.y

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        share = 1.0 / ti.max(notes.n, 1.0)
        push = ti.select((notes.n > 0.5) & (swarm.age <= weights.part_ticks), weights.part, 0.0)
        return push * (me.x - share * notes.x), push * (me.y - share * notes.y)
