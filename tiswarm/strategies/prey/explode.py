"""Explode: scatter from the swarm's centre for a while once a predator is seen."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Lupau 2022, section 6.2, explode: blast (p - g)/(|p - g|² + soft), g = mean position of the prey.

    A prey explodes once in its life, from the tick after it first sees a predator. In the paper one prey's alarm sets off
    all; its simulator's messages never arrive, and its tables have `communicate` off.
    """

    memory = ("fuse",)  # ticks since the first predator was seen, counted from 1; 0 before
    watches = True

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        blast: float = 20.0  # strength [m²/s]
        blast_ticks: float = 50.0  # how long an explosion lasts [ticks]
        soft: float = 0.05  # keeps the force finite at the centre [m²]
        communicate: float = 0.0  # 1: whoever sees a predator sets off the whole swarm; 0: only itself

    @staticmethod
    def states(memory, weights):
        fuse = memory["fuse"]
        return {"exploding": (fuse >= 1) & (fuse <= weights["blast_ticks"])}

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        x = me.x - swarm.x
        y = me.y - swarm.y
        exploding = ti.select((memory.fuse > 0.5) & (memory.fuse <= weights.blast_ticks), 1.0, 0.0)
        blast = exploding * weights.blast / ti.max(x * x + y * y + weights.soft, 1e-6)
        return blast * x, blast * y

    @staticmethod
    @ti.func
    def remember(memory: ti.template(), me, seen, swarm_seen, weights):
        lit = (seen > 0.5) | ((swarm_seen > 0.5) & (weights.communicate > 0.5))
        memory.fuse = ti.select(memory.fuse > 0.5, memory.fuse + 1.0, ti.select(lit, 1.0, 0.0))
