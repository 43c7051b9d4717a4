"""Steering: from what an agent senses to its next state, an agent or a trial a lane; who visits whom is the senses'."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics import commands, integrator, memories, networks, planning
from tiswarm.dynamics.integrator import Steps
from tiswarm.dynamics.memories import Memories
from tiswarm.dynamics.perception import NeighbourSearch
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd import philox
from tiswarm.simd.lanes import minus, motion
from tiswarm.simd.runtime import Func, Types
from tiswarm.strategies.flocking import flock


@dataclass(frozen=True)
class Steering:
    """From senses to a step, for both kinds."""

    prey: Func
    predators: Func
    memories: Memories
    plan: Func  # find ways to the target for trials that begin (planning.py)
    note: Func  # write down the velocity behind a term, where terms are noted
    steps: Steps


def build(layout: ParameterTable, types: Types, see: Views, senses: NeighbourSearch, uniform) -> Steering:
    """Build prey, predators (one agent's move), memories, plan and steps, for the senses of either engine."""
    lanes = types.lanes
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    frame = layout.structure.frame
    steps, kept = integrator.build(layout), memories.build(layout, see)
    strategies = layout.parts("prey", "strategy")
    kicking = [p for p in strategies if p.strategy.dice]
    urging = [p for p in strategies if "urge" in p.own]
    pursuits = layout.parts("predators", "strategy")
    consults, goals = networks.build(layout, see, senses), planning.build(layout, types, see)
    led = any(p.part in consults for p in strategies)
    chasing = any(p.part in consults for p in pursuits)
    told = {kind: layout.commands[kind] for kind, mode in commands.modes(layout).items() if mode == "gains"}

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
            other = p.strategy.deflect(me, course, notes, see.image(me, target, numbers, b), dice, weights)
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
        draw: ti.template(),
        prey: ti.template(),
        a,
        me: ti.template(),
        numbers: ti.template(),
        b,
        threat: ti.template(),
        swarm: ti.template(),
        notes: ti.template(),
    ):
        """Add what the strategies steer; those that integrate on their own make a course of their own out of it."""
        if ti.static(not led):  # networks have heeded already
            senses.heed(notes, threat, here, me)
        for j, p in ti.static(enumerate(strategies)):
            weights = see.weights_of(p, numbers, b)
            if ti.static("roam" in p.own):
                push = minus(course, motion(me))
                dice = dice_of(draw, philox.STRATEGY)
                other = p.strategy.roam(me, push, notes[j], dice, numbers[b * width + at.dt], weights)
                for k in ti.static(range(dim)):
                    course[k] = ti.select(weights.on > 0.5, other[k], course[k])
            elif ti.static("integrate" in p.own):
                push = minus(course, motion(me))
                dt = numbers[b * width + at.dt]
                other = p.strategy.integrate(me, push, swarm, notes[j], kept.of(p, prey, a), dt, weights)
                for k in ti.static(range(dim)):
                    course[k] = ti.select(weights.on > 0.5, other[k], course[k])
            elif ti.static("steer" in p.own):
                steer = p.strategy.steer(me, threat, swarm, notes[j], kept.of(p, prey, a), weights)
                for k in ti.static(range(dim)):
                    course[k] += timed(weights.on * steer[k], numbers, b)
            if ti.static("keep" in p.own):
                kept.keep(p, prey, a, course, notes[j], weights)
            note(prey, a, "prey", p.part.name, course)

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
        flock = see.image(me, swarm, numbers, b)
        aim = see.image(me, target, numbers, b)
        threat = see.Threat(*[lanes(0.0) for _ in ti.static(range(dim + 1))])
        notes = [p.Notes(*[lanes(0.0) for _ in p.note_names]) for p in ti.static(strategies)]
        orders = [1.0 * numbers[b * width + at.prey.goal], lanes(1.0), lanes(0.0), lanes(0.0)]
        if ti.static(led):
            senses.heed(notes, threat, here, me)
            for j, p in ti.static(enumerate(strategies)):
                if ti.static(p.part in consults):
                    dice = dice_of(draw, philox.STRATEGY)
                    consults[p.part](notes[j], here, prey, a, me, numbers, b, flock, aim, dice, orders)
        if ti.static("prey" in told):
            commands.regain(prey, a, told["prey"], me, orders)
        course = pulled(prey, a, here, "prey", me, numbers, b)
        if ti.static(frame.targeted):
            way = goals.way(here, prey, a, me, target, numbers, b)
            for p in ti.static(urging):
                weights = see.weights_of(p, numbers, b)
                orders[0] = orders[0] * ti.select(weights.on > 0.5, p.strategy.urge(me, weights), 1.0)
            for k in ti.static(range(dim)):
                course[k] += timed(orders[0] * way[k], numbers, b)
        note(prey, a, "prey", "goal", course)
        for k in ti.static(range(dim)):
            field = orders[1] * prey[a + rows.field[k]] if ti.static(led or "prey" in told) else prey[a + rows.field[k]]
            course[k] += timed(field, numbers, b)
        if ti.static(led):
            for k in ti.static(range(2)):
                course[k] += timed(orders[2 + k], numbers, b)
        note(prey, a, "prey", "field", course)
        steps.wall_turn(course, me, numbers, b)
        note(prey, a, "prey", "walls", course)
        steered(course, here, draw, prey, a, me, numbers, b, threat, flock, notes)
        turned(course, here, "prey", me, numbers, b)
        note(prey, a, "prey", "turn", course)
        steps.prey.limited(course, me, numbers, b)
        note(prey, a, "prey", "cap", course)
        if ti.static(bool(layout.parts("prey", "avoidance", "deflect"))):
            deflected(course, here, "prey", me, numbers, b, target, dice_of(draw, philox.DEFLECTION))
        note(prey, a, "prey", "deflection", course)
        for p in ti.static(kicking):
            weights = see.weights_of(p, numbers, b)
            kick = p.strategy.kick(threat, dice_of(draw, philox.STRATEGY), kept.of(p, prey, a), weights)
            for k in ti.static(range(dim)):
                course[k] += weights.on * kick[k]
        note(prey, a, "prey", "kick", course)
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
        chased = see.image(me, quarry, numbers, b)
        aim = see.image(chased, target, numbers, b)  # where the prey go, from where they are
        orders = [1.0 * numbers[b * width + at.predators.goal], lanes(1.0), lanes(0.0), lanes(0.0)]
        for p in ti.static([p for p in pursuits if p.part in consults]):
            notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
            senses.chase(p, notes, here, me, chased, see.weights_of(p, numbers, b))
            dice = dice_of(draw, philox.PREDATOR_STRATEGY)
            consults[p.part](notes, here, predators, a, me, numbers, b, chased, aim, dice, orders)
        if ti.static("predators" in told):
            commands.regain(predators, a, told["predators"], me, orders)
        course = pulled(predators, a, here, "predators", me, numbers, b)
        for k in ti.static(range(dim)):
            heeded = ti.static(chasing or "predators" in told)
            field = orders[1] * predators[a + rows.field[k]] if ti.static(heeded) else predators[a + rows.field[k]]
            course[k] += timed(field, numbers, b)
        if ti.static(chasing):
            for k in ti.static(range(2)):
                course[k] += timed(orders[2 + k], numbers, b)
        note(predators, a, "predators", "field", course)
        steps.wall_turn(course, me, numbers, b)
        note(predators, a, "predators", "walls", course)
        for p in ti.static(pursuits):
            weights = see.weights_of(p, numbers, b)
            notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
            if ti.static("observe" in p.own and p.part not in consults):
                senses.chase(p, notes, here, me, chased, weights)
            way = p.strategy.pursue(me, chased, aim, notes, weights)
            goal = orders[0]
            if ti.static(p.strategy.rules):
                for k in ti.static(range(dim)):
                    course[k] = ti.select(weights.on > 0.5, goal * way[k], course[k])
            else:
                goal = weights.on * goal
                for k in ti.static(range(dim)):
                    course[k] += timed(goal * way[k], numbers, b)
        note(predators, a, "predators", "pursuit", course)
        turned(course, here, "predators", me, numbers, b)
        note(predators, a, "predators", "turn", course)
        steps.predators.limited(course, me, numbers, b)
        note(predators, a, "predators", "cap", course)
        if ti.static(bool(layout.parts("predators", "avoidance", "deflect"))):
            deflected(course, here, "predators", me, numbers, b, target, dice_of(draw, philox.PREDATOR_DEFLECTION))
        note(predators, a, "predators", "deflection", course)
        steps.predators.advance(predators, a, course, me, numbers, b)

    obeying = commands.build(layout, types, steps)
    return Steering(
        prey=obeying.get("prey", drive_prey),
        predators=obeying.get("predators", drive_predator),
        memories=kept,
        plan=goals.plan,
        note=note,
        steps=steps,
    )
