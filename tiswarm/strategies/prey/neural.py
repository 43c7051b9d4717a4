"""Neural: a network gives the gains of the ordinary terms in each tick, or a change of velocity beside them."""

import taichi as ti

from tiswarm.strategies import neural
from tiswarm.strategies.prey import Prey


class Strategy(neural.Led, Prey):
    """Lupau 2022, the neural controller of its program, whose inputs, layers and outputs the network's file names.

    gains: of separation, alignment, cohesion, goal and field, in the place of the scenario's. velocity: added to what the
    scenario's own gains give. The swarm's middle is that of all prey alive, as the program has it.
    """

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        neural.note_neighbour(notes, mate, away, me.perception)

    @staticmethod
    @ti.func
    def beware(notes: ti.template(), me, hunter, away, weights):
        neural.note_opponent(notes, hunter, away, me.perception)
