"""Distance perception: look ahead along the course, and turn off it when a sphere is in the way."""

from dataclasses import dataclass
from typing import Literal

import taichi as ti

from tiswarm.simd.lanes import anywhere, cosine, dot, larger, minus, place, plus, safe, scaled, sine, smaller, unit, vector
from tiswarm.strategies.avoidance import Avoidance

TURN = 6.283185307179586
"""A whole turn [rad]."""


class Strategy(Avoidance):
    """Flocking with Distance Perception Obstacles Avoidance, section E: W = -α V + β |V| p, V ← |V| u(W), p ⟂ V at random.

    α = β = 1 turns by 135° whatever the distance. Graded: W = (1 - b) V + b |V| p with b from 0 at the edge of perception
    to 1 at contact, and p away from the sphere's centre; at random only when the course leads straight to it. Of several
    spheres in the way the nearest counts.
    """

    dimensions = (2, 3)
    notes = ("seen", "gap", "away*")

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the rule."""

        look: float = 15.0  # how far ahead a boid looks [m]
        buffer: float = 2.0  # how near to an edge its course may lead [m]
        alpha: float = 1.0  # share of the inverted velocity
        beta: float = 1.0  # share of the sideways velocity
        deflection: Literal["paper", "graded"] = "paper"
        resume_gain: float = 0.0  # speed gained by a deflection, per distance to the target [1/s]

    @staticmethod
    def sight(weights):
        return weights["look"] + weights["buffer"]

    @staticmethod
    @ti.func
    def look(notes: ti.template(), me, course, away, obstacle, weights):
        ahead = unit(course)
        along = larger(smaller(0.0 - dot(away, ahead), weights.look), 0.0)
        off = plus(away, scaled(ahead, along))
        size = obstacle.radius + weights.buffer
        gap = ti.sqrt(dot(away, away)) - obstacle.radius
        nearer = (notes.seen < 0.5) | (gap < notes.gap)
        chosen = (dot(off, off) <= size * size) & nearer
        notes.seen = ti.select(chosen, 1.0, notes.seen)
        notes.gap = ti.select(chosen, gap, notes.gap)
        for k in ti.static(range(len(away))):
            vector(notes, "away")[k] = ti.select(chosen, away[k], vector(notes, "away")[k])

    @staticmethod
    @ti.func
    def deflect(me, course, notes, target, dice, weights):
        other = scaled(course, 1.0)
        seen = notes.seen > 0.5
        if anywhere(seen):
            speed = ti.sqrt(dot(course, course))
            ahead = unit(course)
            aside = ti.static(SIDES[len(course)])(ahead, dice)
            outward = vector(notes, "away")
            across = minus(outward, scaled(ahead, dot(outward, ahead)))
            # Heading straight for the centre leaves only rounding across: no side is better than another.
            off_aim = dot(across, across) > 1e-10 * safe(dot(outward, outward))
            clear = unit(across)
            graded = weights.deflection > 0.5
            share = larger(smaller(1.0 - notes.gap / larger(weights.look + weights.buffer, 1e-6), 1.0), 0.0)
            back = ti.select(graded, 1.0 - share, 0.0 - weights.alpha)
            side = ti.select(graded, share, weights.beta)
            chosen = [
                back * course[k] + side * speed * ti.select(graded & (off_aim), clear[k], aside[k])
                for k in ti.static(range(len(course)))
            ]
            way = minus(place(target), place(me))
            gain = weights.resume_gain * ti.sqrt(dot(way, way))
            fast = ti.select(weights.resume_gain > 0.0, larger(speed, smaller(speed + gain, me.max_speed)), speed)
            turned = unit(chosen)
            for k in ti.static(range(len(course))):
                other[k] = ti.select(seen, fast * turned[k], course[k])
        return other


@ti.func
def flat_side(ahead, dice):
    """Give one of the two sides."""
    side = ti.select(dice.a < 0.5, 1.0, -1.0)
    return [0.0 - side * ahead[1], side * ahead[0]]


@ti.func
def deep_side(ahead, dice):
    """Turn one perpendicular about the unit vector by a random angle."""
    steep = ahead[0] * ahead[0] > 0.5
    x = ti.select(steep, 0.0, 1.0)
    y = ti.select(steep, 1.0, 0.0)
    along = x * ahead[0] + y * ahead[1]
    one = unit([x - along * ahead[0], y - along * ahead[1], 0.0 - along * ahead[2]])
    two = [
        ahead[1] * one[2] - ahead[2] * one[1],
        ahead[2] * one[0] - ahead[0] * one[2],
        ahead[0] * one[1] - ahead[1] * one[0],
    ]
    angle = TURN * dice.a
    return plus(scaled(one, cosine(angle)), scaled(two, sine(angle)))


SIDES = {2: flat_side, 3: deep_side}
"""A random unit vector perpendicular to a unit vector, by dimension."""
