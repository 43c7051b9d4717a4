"""Neural: a network gives the gains of the ordinary terms in each tick, or a change of velocity beside them."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import dot, motion, vector
from tiswarm.strategies import neural
from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Lupau 2022, the neural controller of its program, whose inputs, layers and outputs the network's file names.

    gains: of separation, alignment, cohesion, goal and field, in the place of the scenario's. velocity: added to what the
    scenario's own gains give. The swarm's middle is that of all prey alive, as the program has it.
    """

    networked = True
    notes = neural.NOTES

    @dataclass(frozen=True)
    class Weights:
        """The network."""

        network: str = "networks/thesis-gains.npz"  # its file, beside the preset or those that ship

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        near = ti.select(dot(away, away) <= me.perception * me.perception, mate.alive, 0.0)
        notes.n += near
        for k in ti.static(range(len(away))):
            vector(notes, "along")[k] += near * motion(mate)[k]

    @staticmethod
    @ti.func
    def beware(notes: ti.template(), me, hunter, away, weights):
        neural.note_opponent(notes, hunter, away, me.perception)

    @staticmethod
    @ti.func
    def notice(notes: ti.template(), me, obstacle, away, weights):
        neural.note_obstacle(notes, obstacle, away, me.perception)
