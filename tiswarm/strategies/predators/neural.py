"""Neural: a network gives the gains of the ordinary terms in each tick, or a change of velocity beside them."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import dot, minus, motion, place, vector
from tiswarm.strategies import neural
from tiswarm.strategies.predators import Predator


class Strategy(Predator):
    """The controller of prey/neural.py for hunters: opponents and neighbours are prey, and the goal is the prey's middle.

    With the scenario's own gains it is `centre`.
    """

    networked = True
    notes = neural.NOTES

    @dataclass(frozen=True)
    class Weights:
        """The network."""

        network: str = "networks/thesis-gains.npz"  # its file, beside the preset or those that ship

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, prey, away, quarry, weights):
        neural.note_opponent(notes, prey, away, me.perception)
        near = ti.select(dot(away, away) <= me.perception * me.perception, prey.alive, 0.0)
        notes.n += near
        for k in ti.static(range(len(away))):
            vector(notes, "along")[k] += near * motion(prey)[k]

    @staticmethod
    @ti.func
    def notice(notes: ti.template(), me, obstacle, away, weights):
        neural.note_obstacle(notes, obstacle, away, me.perception)

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, notes, weights):
        return minus(place(quarry), place(me))
