"""Potential: flock by a potential that is lowest at one distance, with headings or velocities that agree."""

from dataclasses import dataclass
from typing import Literal

import taichi as ti

from tiswarm.simd.lanes import dot, heading, motion, safe, vector
from tiswarm.strategies.prey import Prey

TURN = 6.283185307179586
"""A whole turn [rad]."""


class Strategy(Prey):
    """Tanner, Jadbabaie and Pappas 2003: V(r) = 1/r² + ln r², r in units of prey.spacing, over mates within prey.perception.

    gradient: a_i = -Σ ∇V_ij, which conserves energy; velocity: and -Σ (v_i - v_j), the theorem's law; heading: and
    ω_i ẑ × v_i, ω_i = -Σ wrap(θ_i - θ_j)/r², the law of the sanitation report, which does no work. Half of the force acts
    before the turn and half behind it, and the turn keeps the speed, so that energy is kept as well as the scheme can.
    """

    dimensions = (2, 3)
    flocks = False
    flat_only = (("law", "heading"),)
    memory = ("theta",)
    shown = ("theta",)
    notes = ("force*", "drag*", "spin")

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        law: Literal["heading", "velocity", "gradient"] = "heading"

    @staticmethod
    @ti.func
    def start(memory: ti.template(), me, weights):
        memory.theta = heading(me.vy, me.vx)

    @staticmethod
    def sight(weights, perception):
        return perception, 0.0

    @staticmethod
    @ti.func
    def observe(notes: ti.template(), me, mate, away, first, second, weights):
        distance2 = dot(away, away)
        near = ti.select(distance2 <= me.perception * me.perception, mate.alive, 0.0)
        inverse2 = me.spacing * me.spacing / safe(distance2)
        turn = me.theta - mate.theta
        notes.spin += -1.0 * near * inverse2 * (turn - TURN * ti.floor(turn / TURN + 0.5))
        pull = -2.0 * near * inverse2 * (1.0 - inverse2)
        for k in ti.static(range(len(away))):
            vector(notes, "force")[k] += pull * away[k]
            vector(notes, "drag")[k] += near * (motion(mate)[k] - motion(me)[k])

    @staticmethod
    @ti.func
    def integrate(me, push, swarm, notes, memory, dt, weights):
        drags = ti.select((weights.law > 0.5) & (weights.law < 1.5), 1.0, 0.0)
        force, drag = vector(notes, "force"), vector(notes, "drag")
        half = [0.5 * dt * (force[k] + drags * drag[k]) for k in ti.static(range(len(push)))]
        velocity = [motion(me)[k] + push[k] + half[k] for k in ti.static(range(len(push)))]
        if ti.static(len(push) == 2):
            # The rotation whose half angle has this tangent: norms stay, the angle is right to its third power.
            tangent = 0.5 * dt * ti.select(weights.law < 0.5, notes.spin, 0.0)
            share = 1.0 / (1.0 + tangent * tangent)
            cosine = (1.0 - tangent * tangent) * share
            sine = 2.0 * tangent * share
            x, y = velocity[0], velocity[1]
            velocity[0] = cosine * x - sine * y
            velocity[1] = sine * x + cosine * y
        return [velocity[k] + half[k] for k in ti.static(range(len(push)))]

    @staticmethod
    @ti.func
    def remember(memory: ti.template(), me, seen, swarm_seen, weights):
        moves = me.vx * me.vx + me.vy * me.vy > 0.0
        memory.theta = ti.select(moves, heading(me.vy, me.vx), memory.theta)
