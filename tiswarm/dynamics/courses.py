"""Courses: how a velocity becomes the next one, whoever moves: mates, turns, deflections; and what each term made of it."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.perception import NeighbourSearch
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import APART, motion
from tiswarm.simd.runtime import Func, Types
from tiswarm.strategies.flocking import flock


@dataclass(frozen=True)
class Courses:
    """What both kinds' moves are made of. A course is a list of a velocity's components, changed in place."""

    note: Func  # write down the velocity behind a term, where terms are noted
    timed: Func  # give what a term adds within a tick
    pulled: Func  # give the velocity with what mates add
    turned: Func  # rotate a course that obstacles block
    deflected: Func  # let avoidances change a course after the cap
    dice: Func  # draw two numbers


def build(layout: ParameterTable, types: Types, see: Views, senses: NeighbourSearch, uniform: Func) -> Courses:
    """Build these funcs for the senses of either engine."""
    lanes = types.lanes
    at, dim, width = layout.at, len(layout.axes), len(layout.paths)
    frame = layout.structure.frame

    @ti.func
    def note(agents: ti.template(), a, kind: ti.template(), term: ti.template(), course: ti.template()):
        """Write down the velocity behind a term, where terms are noted."""
        for k, row in ti.static(enumerate(layout.courses[kind].get(term, []))):
            agents[a + row] = course[k]

    @ti.func
    def note_flocking(agents: ti.template(), a, kind: ti.template(), me: ti.template(), mates: ti.template()):
        """Write down the velocity behind separation, and behind cohesion, which `pull` adds in one go with alignment."""
        if ti.static(layout.structure.terms):
            apart = flock(me, mates, 0.0 * me.cohesion, me.separation, 0.0 * me.alignment)
            both = flock(me, mates, me.cohesion, me.separation, 0.0 * me.alignment)
            note(agents, a, kind, "separation", [own + pull for own, pull in ti.static(zip(motion(me), apart, strict=True))])
            note(agents, a, kind, "cohesion", [own + pull for own, pull in ti.static(zip(motion(me), both, strict=True))])

    @ti.func
    def timed(term, numbers: ti.template(), b):
        """Give what a term adds to the velocity in this tick: itself, or in a world of gains per second as much of it."""
        added = term
        if ti.static(frame.per_second):
            added = numbers[b * width + at.dt] * term
        return added

    @ti.func
    def pulled(
        agents: ti.template(), a, here: ti.template(), kind: ti.template(), me: ti.template(), numbers: ti.template(), b
    ):
        """Give the velocity with what mates in sight add to it."""
        course = [1.0 * rate for rate in ti.static(motion(me))]
        if ti.static(layout.flocks(kind)):
            mates = see.Mates(*[lanes(0.0) for _ in ti.static(range(1 + 3 * dim))])
            pull = senses.pull[kind](mates, here, me)
            note_flocking(agents, a, kind, me, mates)
            for k in ti.static(range(dim)):
                course[k] += timed(pull[k], numbers, b)
            note(agents, a, kind, "alignment", course)
        return course

    @ti.func
    def turned(course: ti.template(), here: ti.template(), kind: ti.template(), me: ti.template(), numbers: ti.template(), b):
        """Rotate the course once if any obstacle blocks it."""
        for p in ti.static(layout.parts(kind, "avoidance", "blocks")):
            if APART:
                weights = see.weights_of(p, numbers, b)
                blocked = senses.blocked(p, here, me, course, weights)
                cosine, sine = p.strategy.turn(weights)
                rotated = (blocked > 0.5) & (weights.on > 0.5)
                cosine = ti.select(rotated, cosine, 1.0)
                sine = ti.select(rotated, sine, 0.0)
                x, y = course[0], course[1]
                course[0] = cosine * x - sine * y
                course[1] = sine * x + cosine * y

    @ti.func
    def deflected(
        course: ti.template(),
        here: ti.template(),
        kind: ti.template(),
        me: ti.template(),
        numbers: ti.template(),
        b,
        target: ti.template(),
        dice: ti.template(),
    ):
        """Let avoidances change the course after the cap."""
        for p in ti.static(layout.parts(kind, "avoidance", "deflect")):
            if APART:
                weights = see.weights_of(p, numbers, b)
                notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
                senses.look(p, notes, here, me, course, weights)
                other = p.strategy.deflect(me, course, notes, see.image(me, target, numbers, b), dice, weights)
                for k in ti.static(range(dim)):
                    course[k] = ti.select(weights.on > 0.5, other[k], course[k])

    @ti.func
    def dice_of(draw: ti.template(), purpose: ti.template()):
        first, second, _, _ = uniform(draw.key_low, draw.key_high, draw.trial, purpose, draw.index, draw.tick)
        return see.Dice(a=first, b=second)

    return Courses(note=note, timed=timed, pulled=pulled, turned=turned, deflected=deflected, dice=dice_of)
