"""Neural: a network gives the gains of the ordinary terms in each tick, or a change of velocity beside them."""

import taichi as ti

from tiswarm.simd.lanes import minus, place
from tiswarm.strategies import neural
from tiswarm.strategies.predators import Predator


class Strategy(neural.Led, Predator):
    """The controller of prey/neural.py for hunters: opponents and neighbours are prey, and the goal is the prey's middle.

    With the scenario's own gains it is `centre`.
    """

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, prey, away, quarry, weights):
        neural.note_opponent(notes, prey, away, me.perception)
        neural.note_neighbour(notes, prey, away, me.perception)

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, notes, weights):
        return minus(place(quarry), place(me))
