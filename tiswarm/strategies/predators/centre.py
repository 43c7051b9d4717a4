"""Centre: steer for the mean position of the prey."""

import taichi as ti

from tiswarm.simd.lanes import minus, place
from tiswarm.strategies.predators import Predator


class Strategy(Predator):
    """Lupau 2022, section 6.3, centre steering: g - p."""

    chases = "swarm"
    dimensions = (2, 3)

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, notes, weights):
        return minus(place(quarry), place(me))
