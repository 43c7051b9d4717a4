"""Evasive: move away from every predator in sight."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import place, scaled
from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Lupau 2022, section 6.2, evasive: evade Σ (p - q) over predators q in sight."""

    dimensions = (2, 3)
    watches = True

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        evade: float = 0.01  # strength [1/s]

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        return scaled(place(threat), weights.evade)
