"""Damper: springs with dampers between near agents, which are kept once the swarm is at rest."""

from dataclasses import dataclass
from math import inf
from typing import Literal

import taichi as ti

from tiswarm.strategies import Prey, dot, larger, minus, motion, plus, safe, scaled, vector

BITS = 24
"""So many mates' links a number of memory holds, one a bit: single precision holds whole numbers up to 2²⁴."""


class Strategy(Prey):
    """Lupau 2022, equations 1 and 2 (after Wiech, Eremeyev and Giorgio 2018): m a = Σ (k (l - l₀) + c dl/dt) e.

    Over the links of an agent, l long, along e: to all mates nearer than `span` l₀, anew each tick, until the agent is slower
    than `freeze`; then it keeps those it has, however long they become, while both are there. thesis: a second-order system.
    program: the thesis's own program sets v = F / m afresh each tick, and its damper pulls by |dl/dt|, whatever the sign.
    """

    dimensions = (2, 3)
    flocks = False
    memory = ("linked", "links_low", "links_high")
    shown = ("linked", "links_low", "links_high")
    notes = ("force*", "low", "high")  # Σ forces [N]; the links of now, a bit each
    most = 2 * BITS

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        form: Literal["thesis", "program"] = "thesis"
        stiffness: float = 1.0  # k [N/m]
        damping: float = 2.0  # c [N s/m]
        mass: float = 10.0  # m [kg]
        length: float = 8.0  # l₀, of a spring at rest [m]
        span: float = 1.2  # up to how many times l₀ mates are linked
        freeze: float = 0.001  # an agent slower than this keeps its links [m/s]; 0: never
        leader: Literal["none", "first"] = "none"  # who heeds prey.goal: all, or the first agent alone, once its links are kept

    @staticmethod
    def sight(weights, perception):
        return (inf if weights["freeze"] else weights["span"] * weights["length"]), 0.0

    @staticmethod
    def states(memory, weights):
        return {"linked": memory["linked"] > 0.5}

    @staticmethod
    @ti.func
    def urge(me, weights):
        leads = (me.number + 0.0 * me.alive < 1.5) & (me.linked > 0.5)
        return ti.select((weights.leader < 0.5) | leads, 1.0, 0.0)

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        distance2 = dot(away, away)
        distance = ti.sqrt(safe(distance2))
        rate = dot(minus(motion(me), motion(mate)), away) / distance
        longest = weights.span * weights.length
        low, high = bits_of(mate.number - 1.0 + 0.0 * me.alive)
        kept = held(me.links_low, low) + held(me.links_high, high)
        near = ti.select(distance2 < longest * longest, 1.0, 0.0)
        link = mate.alive * ti.select(me.linked > 0.5, kept, near)
        pulled = ti.select(weights.form > 0.5, larger(rate, 0.0 - rate), rate)
        tension = weights.stiffness * (distance - weights.length) + weights.damping * pulled
        notes.low += link * low
        notes.high += link * high
        for k in ti.static(range(len(away))):
            vector(notes, "force")[k] += -1.0 * link * tension * away[k] / distance

    @staticmethod
    @ti.func
    def integrate(me, push, swarm, notes, memory, dt, weights):
        force = vector(notes, "force")
        afresh = weights.form > 0.5
        kept = scaled(motion(me), ti.select(afresh, 0.0, 1.0))
        return plus(plus(kept, scaled(force, ti.select(afresh, 1.0, dt) / weights.mass)), push)

    @staticmethod
    @ti.func
    def keep(memory: ti.template(), course, notes, weights):
        rests = (memory.linked < 0.5) & (dot(course, course) < weights.freeze * weights.freeze)
        memory.links_low = ti.select(rests, notes.low, memory.links_low)
        memory.links_high = ti.select(rests, notes.high, memory.links_high)
        memory.linked = ti.select(rests, 1.0, memory.linked)


@ti.func
def bits_of(index):
    """Give the bit of a mate, counted from 0, in either number: a power of two in one, 0 in the other."""
    upper = index > 23.5
    left = index - ti.select(upper, 24.0, 0.0)
    power = 1.0 + 0.0 * index
    for k, factor in ti.static(((16.0, 65536.0), (8.0, 256.0), (4.0, 16.0), (2.0, 4.0), (1.0, 2.0))):
        there = left > k - 0.5
        power = power * ti.select(there, factor, 1.0)
        left = left - ti.select(there, k, 0.0)
    return ti.select(upper, 0.0, power), ti.select(upper, power, 0.0)


@ti.func
def held(links, bit):
    """Tell whether a sum of powers of two holds one of them, 1 or 0; 0 for the bit 0."""
    count = ti.floor(links / larger(bit, 1.0))
    return ti.select(bit > 0.5, count - 2.0 * ti.floor(0.5 * count), 0.0)
