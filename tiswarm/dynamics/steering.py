"""Steering: from what an agent senses to its next state, an agent or a trial a lane; who visits whom is the senses'."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics import integrator, perception
from tiswarm.dynamics.integrator import Steps
from tiswarm.dynamics.perception import NeighbourSearch
from tiswarm.dynamics.table import Layout
from tiswarm.dynamics.views import Views
from tiswarm.simd import philox
from tiswarm.simd.lanes import minus, motion
from tiswarm.simd.runtime import Func, Types


@dataclass(frozen=True)
class Steering:
    """From senses to a step, for both kinds."""

    prey: Func
    predators: Func
    begin: Func  # give strategies' memory its first values
    remember: Func  # let strategies update an agent's memory from what was seen in this move
    steps: Steps
    starts: bool
    remembers: bool


def build(layout: Layout, types: Types, see: Views, senses: NeighbourSearch, uniform) -> Steering:
    """Build prey, predators (one agent's move), begin, remember and steps, for the senses of either engine."""
    lanes = types.lanes
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    frame = layout.structure.frame
    steps = integrator.build(layout)
    strategies = layout.parts("prey", "strategy")
    kicking = [p for p in strategies if p.strategy.dice]
    remembering = [p for p in strategies if "remember" in p.own]
    starting = [p for p in strategies if "start" in p.own]
    pursuits = layout.parts("predators", "strategy")

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
    def remember(prey: ti.template(), a, me: ti.template(), numbers: ti.template(), b, swarm_seen):
        """Let strategies update an agent's memory from what was seen in this move."""
        for p in ti.static(remembering):
            memory = memory_of(p, prey, a)
            p.strategy.remember(memory, me, prey[a + rows.seen], swarm_seen, see.weights_of(p, numbers, b))
            for k in ti.static(range(len(p.memory))):
                prey[a + p.memory_rows[k]] = ti.static([getattr(memory, name) for name in p.memory])[k]

    @ti.func
    def pulled(here: ti.template(), kind: ti.template(), me: ti.template(), numbers: ti.template(), b):
        """Give the velocity with what mates in sight add to it."""
        course = [1.0 * rate for rate in ti.static(motion(me))]
        if ti.static(perception.flocking(layout, kind)):
            mates = see.Mates(*[lanes(0.0) for _ in ti.static(range(1 + 3 * dim))])
            senses.gather[kind](mates, here, me)
            pull = senses.flocked[kind](mates, numbers, b, me)
            for k in ti.static(range(dim)):
                course[k] += pull[k]
        return course

    @ti.func
    def turned(course: ti.template(), here: ti.template(), kind: ti.template(), me: ti.template(), numbers: ti.template(), b):
        """Rotate the course once if any obstacle blocks it."""
        for p in ti.static(layout.parts(kind, "avoidance", "blocks")):
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
            weights = see.weights_of(p, numbers, b)
            notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
            senses.look(p, notes, here, me, course, weights)
            other = p.strategy.deflect(me, course, notes, target, dice, weights)
            for k in ti.static(range(dim)):
                course[k] = ti.select(weights.on > 0.5, other[k], course[k])

    @ti.func
    def dice_of(draw: ti.template(), purpose: ti.template()):
        first, second, _, _ = uniform(draw.key_low, draw.key_high, draw.trial, purpose, draw.index, draw.tick)
        return see.Dice(a=first, b=second)

    @ti.func
    def steered(
        course: ti.template(),
        here: ti.template(),
        prey: ti.template(),
        a,
        me: ti.template(),
        numbers: ti.template(),
        b,
        threat: ti.template(),
        swarm: ti.template(),
    ):
        """Add what the strategies steer; those that integrate on their own make a course of their own out of it."""
        notes = [p.Notes(*[lanes(0.0) for _ in p.note_names]) for p in ti.static(strategies)]
        senses.heed(notes, threat, here, me)
        for j, p in ti.static(enumerate(strategies)):
            weights = see.weights_of(p, numbers, b)
            if ti.static("integrate" in p.own):
                push = minus(course, motion(me))
                dt = numbers[b * width + at.dt]
                other = p.strategy.integrate(me, push, swarm, notes[j], memory_of(p, prey, a), dt, weights)
                for k in ti.static(range(dim)):
                    course[k] = ti.select(weights.on > 0.5, other[k], course[k])
            elif ti.static("steer" in p.own):
                steer = p.strategy.steer(me, threat, swarm, notes[j], memory_of(p, prey, a), weights)
                for k in ti.static(range(dim)):
                    course[k] += weights.on * steer[k]

    @ti.func
    def drive_prey(
        here: ti.template(),
        draw: ti.template(),
        prey: ti.template(),
        a,
        me: ti.template(),
        numbers: ti.template(),
        b,
        swarm: ti.template(),
        target: ti.template(),
    ):
        """V += flocking + goal seeking + field + strategy; turn; cap; kick; p += v dt (Lupau 2022, equations 9 to 11).

        here: for the senses; draw: for random numbers: key_low, key_high and lanes of trial, index and tick.
        """
        course = pulled(here, "prey", me, numbers, b)
        if ti.static(frame.targeted):
            way = see.sight(target, me, numbers, b)
            for k in ti.static(range(dim)):
                course[k] += numbers[b * width + at.prey.goal] * way[k]
        for k in ti.static(range(dim)):
            course[k] += prey[a + rows.field[k]]
        steps.wall_turn(course, me, numbers, b)
        threat = see.Threat(*[lanes(0.0) for _ in ti.static(range(dim + 1))])
        steered(course, here, prey, a, me, numbers, b, threat, swarm)
        turned(course, here, "prey", me, numbers, b)
        steps.prey.limited(course, me, numbers, b)
        if ti.static(bool(layout.parts("prey", "avoidance", "deflect"))):
            deflected(course, here, "prey", me, numbers, b, target, dice_of(draw, philox.DEFLECTION))
        for p in ti.static(kicking):
            weights = see.weights_of(p, numbers, b)
            kick = p.strategy.kick(threat, dice_of(draw, philox.STRATEGY), memory_of(p, prey, a), weights)
            for k in ti.static(range(dim)):
                course[k] += weights.on * kick[k]
        prey[a + rows.seen] = threat.n
        steps.prey.advance(prey, a, course, me, numbers, b)

    @ti.func
    def drive_predator(
        here: ti.template(),
        draw: ti.template(),
        predators: ti.template(),
        a,
        me: ti.template(),
        numbers: ti.template(),
        b,
        quarry: ti.template(),
        target: ti.template(),
    ):
        """V += flocking + pursuit + field; turn; cap; p += v dt. The prey have moved already, and none has been removed yet."""
        course = pulled(here, "predators", me, numbers, b)
        for k in ti.static(range(dim)):
            course[k] += predators[a + rows.field[k]]
        steps.wall_turn(course, me, numbers, b)
        for p in ti.static(pursuits):
            weights = see.weights_of(p, numbers, b)
            notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
            if ti.static("observe" in p.own):
                senses.chase(p, notes, here, me, quarry, weights)
            way = p.strategy.pursue(me, quarry, target, notes, weights)
            goal = numbers[b * width + at.predators.goal]
            if ti.static(p.strategy.rules):
                for k in ti.static(range(dim)):
                    course[k] = ti.select(weights.on > 0.5, goal * way[k], course[k])
            else:
                goal = weights.on * goal
                for k in ti.static(range(dim)):
                    course[k] += goal * way[k]
        turned(course, here, "predators", me, numbers, b)
        steps.predators.limited(course, me, numbers, b)
        if ti.static(bool(layout.parts("predators", "avoidance", "deflect"))):
            deflected(course, here, "predators", me, numbers, b, target, dice_of(draw, philox.PREDATOR_DEFLECTION))
        steps.predators.advance(predators, a, course, me, numbers, b)

    return Steering(
        prey=drive_prey,
        predators=drive_predator,
        begin=begin,
        remember=remember,
        steps=steps,
        starts=bool(starting),
        remembers=bool(remembering),
    )
