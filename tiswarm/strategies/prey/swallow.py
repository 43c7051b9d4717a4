"""Swallow: acceleration-driven cohesion, alignment, separation and fear of the hawk."""

from dataclasses import dataclass
from typing import Literal

import taichi as ti

from tiswarm.simd.lanes import capped, dot, motion, safe, unit, vector
from tiswarm.strategies.flocking import note_mate
from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Rivera 2017 (UCLA M20 final project), sections 1.2 and 1.4; a rule that sees nobody contributes nothing.

    The gains are the scenario's: prey.cohesion c1, prey.alignment c2, prey.separation c3, within prey.perception and, for
    separation, prey.spacing.
    """

    dimensions = (2, 3)
    flocks = False
    # Neighbours: how many, Σ (x_j - x), Σ v_j; those within the spacing: how many, Σ (x - x_j)/|x - x_j|²;
    # predators in sight: how many, Σ (x - h)/|x - h|³.
    notes = ("n", "gather*", "along*", "close", "push*", "hunters", "flee*")

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        fear: float = 4.0  # c4, gain of fear [1/s]
        fear_range: float = 40.0  # how far away a predator is feared [m]
        max_acceleration: float = 1.0  # [m/s²]
        # normalised: only directions count; power: separation falls with the distance, fear with its square
        urgency: Literal["normalised", "power"] = "normalised"

    @staticmethod
    def sight(weights, perception):
        return perception, weights["fear_range"]

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        distance2 = dot(away, away)
        near = ti.select(distance2 <= me.perception * me.perception, mate.alive, 0.0)
        close = ti.select(distance2 <= me.spacing * me.spacing, mate.alive, 0.0)
        note_mate(notes, mate, away, near)
        notes.close += close
        push = close / safe(distance2)
        for k in ti.static(range(len(away))):
            vector(notes, "push")[k] += push * away[k]

    @staticmethod
    @ti.func
    def beware(notes: ti.template(), me, hunter, away, weights):
        distance2 = dot(away, away)
        near = ti.select(distance2 <= weights.fear_range * weights.fear_range, hunter.alive, 0.0)
        notes.hunters += near
        share = near / (safe(distance2) * ti.sqrt(safe(distance2)))
        for k in ti.static(range(len(away))):
            vector(notes, "flee")[k] += share * away[k]

    @staticmethod
    @ti.func
    def integrate(me, push, swarm, notes, memory, dt, weights):
        velocity = motion(me)
        # A direction does not change with the length, so that sums stand for means.
        together, along = unit(vector(notes, "gather")), unit(vector(notes, "along"))
        pushes, flee = vector(notes, "push"), vector(notes, "flee")
        apart, off = unit(pushes), unit(flee)
        power = weights.urgency > 0.5
        seen = ti.select(notes.n > 0.5, 1.0, 0.0)
        crowded = ti.select(notes.close > 0.5, me.separation, 0.0)
        afraid = ti.select(notes.hunters > 0.5, weights.fear, 0.0)
        pull = [
            seen * (me.cohesion * (me.max_speed * together[k] - velocity[k]))
            + seen * (me.alignment * (me.max_speed * along[k] - velocity[k]))
            + crowded * ti.select(power, me.max_speed * pushes[k], me.max_speed * apart[k] - velocity[k])
            + afraid * ti.select(power, me.max_speed * flee[k], me.max_speed * off[k] - velocity[k])
            for k in ti.static(range(len(push)))
        ]
        acceleration = capped(pull, weights.max_acceleration)
        return [velocity[k] + push[k] + dt * acceleration[k] for k in ti.static(range(len(push)))]
