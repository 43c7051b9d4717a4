"""Proportional navigation: aim ahead of the prey's way to the target."""

import taichi as ti

from tiswarm.simd.lanes import larger, unit
from tiswarm.strategies.predators import Predator


class Strategy(Predator):
    """Lupau 2022, section 6.3: the line of sight l to the prey's mean position, rotated anticlockwise by asin(s).

    s = |V × l|/max_speed, V the part of the prey's mean velocity that leads to the target.
    """

    chases = "swarm"

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, notes, weights):
        ahead_x, ahead_y = unit([target.x - quarry.x, target.y - quarry.y])
        sight_x, sight_y = unit([quarry.x - me.x, quarry.y - me.y])
        closing = (quarry.vx * ahead_x + quarry.vy * ahead_y) / me.max_speed
        across = closing * (ahead_x * sight_y - ahead_y * sight_x)
        # Jumps make s exceed 1 in 2 % of trials, where the simulator gives NaN: clamped.
        sine = ti.min(larger(across, -1.0 * across), 1.0)
        cosine = ti.sqrt(larger(1.0 - sine * sine, 0.0))
        return cosine * sight_x - sine * sight_y, sine * sight_x + cosine * sight_y
