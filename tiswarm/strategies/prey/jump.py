"""Jump: one kick in a random direction whenever predators come into sight."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import unit
from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Lupau 2022, section 6.2, jump: v += leap e after the speed cap, e in the first quadrant only, as its simulator draws it.

    The next tick's cap takes the speed back, so that a jump is a step of up to leap + max_speed, once per encounter.
    """

    memory = ("jumped",)
    watches = True
    dice = True

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        leap: float = 3.0  # speed of the kick [m/s]

    @staticmethod
    def kick_speed(weights):
        return weights["leap"]

    @staticmethod
    def states(memory, weights):
        return {"jumped": memory["jumped"] > 0.5}

    @staticmethod
    @ti.func
    def kick(threat, dice, memory, weights):
        x, y = unit([dice.a, dice.b])
        leap = ti.select((threat.n > 0.5) & (memory.jumped < 0.5), weights.leap, 0.0)
        return leap * x, leap * y

    @staticmethod
    @ti.func
    def remember(memory: ti.template(), me, seen, swarm_seen, weights):
        memory.jumped = ti.select(seen > 0.5, 1.0, 0.0)
