"""Memories: what prey strategies keep of an agent from tick to tick, in rows of its own."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.runtime import Func


@dataclass(frozen=True)
class Memories:
    """The memories of all prey strategies of a structure."""

    of: Func  # give an agent's memory of a strategy
    begin: Func  # give strategies' memory its first values
    remember: Func  # let strategies update an agent's memory from what was seen in this move
    keep: Func  # let a strategy keep in an agent's memory what it noted in this move
    starts: bool
    remembers: bool


def build(layout: ParameterTable, see: Views) -> Memories:
    """Build of, begin, remember and keep."""
    rows, strategies = layout.rows, layout.parts("prey", "strategy")
    remembering = [p for p in strategies if "remember" in p.own]
    starting = [p for p in strategies if "start" in p.own]

    @ti.func
    def memory_of(p: ti.template(), agents: ti.template(), a):
        return p.Memory(*[agents[a + row] for row in ti.static(p.memory_rows or [rows.place[0]])])

    @ti.func
    def begin(prey: ti.template(), a, me: ti.template(), numbers: ti.template(), b, fresh):
        """Give strategies' memory its first values."""
        for p in ti.static(starting):
            memory = memory_of(p, prey, a)
            p.strategy.start(memory, me, see.weights_of(p, numbers, b))
            for k in ti.static(range(len(p.memory))):
                kept = ti.static([getattr(memory, name) for name in p.memory])[k]
                prey[a + p.memory_rows[k]] = ti.select(fresh, kept, prey[a + p.memory_rows[k]])

    @ti.func
    def put(p: ti.template(), prey: ti.template(), a, memory: ti.template()):
        for k in ti.static(range(len(p.memory))):
            prey[a + p.memory_rows[k]] = ti.static([getattr(memory, name) for name in p.memory])[k]

    @ti.func
    def remember(prey: ti.template(), a, me: ti.template(), numbers: ti.template(), b, swarm_seen):
        """Let strategies update an agent's memory from what was seen in this move."""
        for p in ti.static(remembering):
            memory = memory_of(p, prey, a)
            p.strategy.remember(memory, me, prey[a + rows.seen], swarm_seen, see.weights_of(p, numbers, b))
            put(p, prey, a, memory)

    @ti.func
    def keep(p: ti.template(), prey: ti.template(), a, course: ti.template(), notes: ti.template(), weights):
        """Let a strategy keep in an agent's memory what it noted in this move."""
        memory = memory_of(p, prey, a)
        p.strategy.keep(memory, course, notes, weights)
        put(p, prey, a, memory)

    return Memories(of=memory_of, begin=begin, remember=remember, keep=keep, starts=bool(starting), remembers=bool(remembering))
