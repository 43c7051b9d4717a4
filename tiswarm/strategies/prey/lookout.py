"""Lookout: boids in space that separate by the inverse distance."""

from dataclasses import dataclass
from typing import Literal

import taichi as ti

from tiswarm.simd.lanes import dot, larger, motion, vector
from tiswarm.strategies.flocking import note_mate
from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Flocking with Distance Perception Obstacles Avoidance, sections A to D, as meant, over boids within prey.perception.

    separation Σ D/(|D|² + soft²), D = P - P_n; cohesion (mean P_n - P); alignment (mean V_n - V); goal (P_T - P). The paper
    prints separation Σ (1/D_x, 1/D_y, 1/D_z), infinite where two boids share a coordinate, c mean - P, and a mean V_n.
    """

    dimensions = (2, 3)
    flocks = False
    notes = ("n", "gather*", "along*", "push*")

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        soft: float = 1e-3  # keeps separation finite where boids meet [m]
        separation_form: Literal["isotropic", "componentwise"] = "isotropic"

    @staticmethod
    def sight(weights, perception):
        return perception, 0.0

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        distance2 = dot(away, away)
        near = ti.select(distance2 <= me.perception * me.perception, mate.alive, 0.0)
        note_mate(notes, mate, away, near)
        push = near / larger(distance2 + weights.soft * weights.soft, 1e-12)
        for k in ti.static(range(len(away))):
            size = larger(away[k], 0.0 - away[k])
            single = near * away[k] / larger(size * larger(size, weights.soft), 1e-12)
            vector(notes, "push")[k] += ti.select(weights.separation_form > 0.5, single, push * away[k])

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        share = 1.0 / larger(notes.n, 1.0)
        company = ti.select(notes.n > 0.5, 1.0, 0.0)
        gather, along, push, velocity = vector(notes, "gather"), vector(notes, "along"), vector(notes, "push"), motion(me)
        return [
            me.separation * push[k]
            + me.cohesion * share * gather[k]
            + me.alignment * company * (share * along[k] - velocity[k])
            for k in ti.static(range(len(velocity)))
        ]
