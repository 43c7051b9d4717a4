"""Vicsek: fly at one speed in the mean direction of whoever is near, turned by a random angle."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import cosine, dot, motion, near, scaled, sine, unit, vector
from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Vicsek, Czirók, Ben-Jacob, Cohen and Shochet 1995, equations 1 and 2: θ(t + 1) = ⟨θ(t)⟩_r + Δθ, Δθ in ±η/2.

    r is prey.perception, v is prey.max_speed, and ⟨θ⟩ the direction of the sum of velocities, one's own among them. The paper
    moves with the direction before the turn, we with the one behind it: their places at t + 1 are ours at t.
    """

    flocks = False
    notes = ("along*",)

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        noise: float = 1.0  # η, width of the interval that random angles are drawn from [rad]

    @staticmethod
    def sight(weights, perception):
        return perception, 0.0

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        counts = near(dot(away, away), me.perception) * mate.alive
        for k in ti.static(range(len(away))):
            vector(notes, "along")[k] += counts * motion(mate)[k]

    @staticmethod
    @ti.func
    def roam(me, push, notes, dice, dt, weights):
        own, along = motion(me), vector(notes, "along")
        ahead = unit([own[k] + along[k] + push[k] for k in ti.static(range(2))])
        lost = dot(ahead, ahead) < 0.5  # who is drawn to nowhere keeps its direction
        kept = unit(own)
        x, y = ti.select(lost, kept[0], ahead[0]), ti.select(lost, kept[1], ahead[1])
        angle = weights.noise * (dice.a - 0.5)
        c, s = cosine(angle), sine(angle)
        return scaled([c * x - s * y, s * x + c * y], me.max_speed)
