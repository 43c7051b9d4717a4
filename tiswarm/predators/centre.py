"""Centre: steer for the mean position of the prey."""

import taichi as ti

from tiswarm.predators import Predator


class Strategy(Predator):
    """Lupau 2022, section 6.3, centre steering: g - p."""

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, weights):
        return quarry.x - me.x, quarry.y - me.y
