"""Sweeper: the boids of cleaning robots, whose separation is a mean of directions."""

from dataclasses import dataclass
from typing import Literal

import taichi as ti

from tiswarm.simd.lanes import dot, larger, motion, safe, vector
from tiswarm.strategies.flocking import note_mate
from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Boids for sanitation and hygiene robots, approach 1 (Choi and Ahn 2019), as meant.

    v + alignment (v̄ - v) + cohesion (l̄ - l) + separation mean((l - l_j)/|l - l_j|^power), the last over those within
    prey.spacing, the others within prey.perception. The report prints sums where differences are meant, and attraction.
    """

    dimensions = (2, 3)
    flocks = False
    notes = ("n", "gather*", "along*", "close", "push*")

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        separation_power: Literal[1, 2] = 1  # 2: nearness counts

    @staticmethod
    def sight(weights, perception):
        return perception, 0.0

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        distance2 = safe(dot(away, away))
        near = ti.select(distance2 <= me.perception * me.perception, mate.alive, 0.0)
        close = ti.select(distance2 <= me.spacing * me.spacing, near, 0.0)
        note_mate(notes, mate, away, near)
        notes.close += close
        push = close / ti.select(weights.separation_power > 0.5, distance2, ti.sqrt(distance2))
        for k in ti.static(range(len(away))):
            vector(notes, "push")[k] += push * away[k]

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        share = 1.0 / larger(notes.n, 1.0)
        close = 1.0 / larger(notes.close, 1.0)
        company = ti.select(notes.n > 0.5, 1.0, 0.0)
        gather, along, push, velocity = vector(notes, "gather"), vector(notes, "along"), vector(notes, "push"), motion(me)
        return [
            me.alignment * company * (share * along[k] - velocity[k])
            + me.cohesion * share * gather[k]
            + me.separation * close * push[k]
            for k in ti.static(range(len(velocity)))
        ]
