"""Hawk: fly straight at one prey, each tick another one or always the nearest."""

from dataclasses import dataclass
from typing import Literal

import taichi as ti

from tiswarm.simd.lanes import dot, scaled, unit, vector
from tiswarm.strategies.predators import Predator


class Strategy(Predator):
    """Rivera 2017 (UCLA M20 final project), section 1.2: the velocity is max_speed u(target - h), with no inertia."""

    chases = "one"
    dimensions = (2, 3)
    flocks = False
    rules = True
    notes = ("rank", "distance2", "way*")  # alive prey so far; of the chosen one: |p - h|², and p - h

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        pursuit: Literal["cycle", "nearest"] = "nearest"  # cycle: the text's rule

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, prey, away, quarry, weights):
        distance2 = dot(away, away)
        turn = quarry.age - quarry.n * ti.floor(quarry.age / ti.max(quarry.n, 1.0))  # age mod n, the place of whose turn it is
        its_turn = (notes.rank > turn - 0.5) & (notes.rank < turn + 0.5)
        nearer = (notes.rank < 0.5) | (distance2 < notes.distance2)
        chosen = ti.select(weights.pursuit > 0.5, nearer, its_turn) & (prey.alive > 0.5)
        notes.distance2 = ti.select(chosen, distance2, notes.distance2)
        for k in ti.static(range(len(away))):
            vector(notes, "way")[k] = ti.select(chosen, 0.0 - away[k], vector(notes, "way")[k])
        notes.rank += prey.alive

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, notes, weights):
        return scaled(unit(vector(notes, "way")), me.max_speed)
