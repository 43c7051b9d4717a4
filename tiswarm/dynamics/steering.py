"""Steering: from what an agent senses to its next state, an agent or a trial a lane; who visits whom is the senses'."""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics import commands, courses, integrator, memories, networks, planning
from tiswarm.dynamics.courses import Courses
from tiswarm.dynamics.integrator import Steps
from tiswarm.dynamics.memories import Memories
from tiswarm.dynamics.perception import NeighbourSearch
from tiswarm.dynamics.planning import Planning
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd import philox
from tiswarm.simd.lanes import APART, minus, motion
from tiswarm.simd.runtime import Func, Types


@dataclass(frozen=True)
class Steering:
    """From senses to a step, for both kinds."""

    prey: Func
    predators: Func
    memories: Memories
    plan: Func  # find ways to the target for trials that begin (planning.py)
    note: Func  # write down the velocity behind a term, where terms are noted
    steps: Steps


@dataclass(frozen=True)
class _Tools:
    """What the moves of both kinds are made of. consults: part -> func; told: kind -> rows of gains that it is told."""

    layout: ParameterTable
    types: Types
    see: Views
    senses: NeighbourSearch
    courses: Courses
    steps: Steps
    kept: Memories
    goals: Planning
    consults: dict[Any, Any]
    told: dict[str, list[int]]


def build(layout: ParameterTable, types: Types, see: Views, senses: NeighbourSearch, uniform: Func) -> Steering:
    """Build prey, predators (one agent's move), memories, plan and steps, for the senses of either engine."""
    steps, kept = integrator.build(layout), memories.build(layout, see)
    common, goals = courses.build(layout, types, see, senses, uniform), planning.build(layout, types, see)
    told = {kind: layout.commands[kind] for kind, mode in commands.modes(layout).items() if mode == "gains"}
    tools = _Tools(layout, types, see, senses, common, steps, kept, goals, networks.build(layout, see, senses), told)
    obeying = commands.build(layout, types, steps)
    return Steering(
        prey=obeying["prey"] if "prey" in obeying else _prey(tools),
        predators=obeying["predators"] if "predators" in obeying else _predators(tools),
        memories=kept,
        plan=goals.plan,
        note=common.note,
        steps=steps,
    )


def _steered(tools: _Tools, strategies: list[Any], led: bool) -> Func:
    layout, see, senses, kept = tools.layout, tools.see, tools.senses, tools.kept
    at, dim, width = layout.at, len(layout.axes), len(layout.paths)
    note, timed, dice_of = tools.courses.note, tools.courses.timed, tools.courses.dice

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
            if APART:
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

    return steered


def _prey(tools: _Tools) -> Func:
    """Build the move of a prey."""
    layout, see, senses, steps, kept = tools.layout, tools.see, tools.senses, tools.steps, tools.kept
    at, rows, dim, width, frame = layout.at, layout.rows, len(layout.axes), len(layout.paths), layout.structure.frame
    lanes, common = tools.types.lanes, tools.courses
    note, timed, pulled, turned, deflected = common.note, common.timed, common.pulled, common.turned, common.deflected
    dice_of, consults, goals, told = common.dice, tools.consults, tools.goals, tools.told
    strategies = layout.parts("prey", "strategy")
    kicking = [p for p in strategies if p.strategy.dice]
    urging = [p for p in strategies if "urge" in p.own]
    led = any(p.part in consults for p in strategies)
    steered = _steered(tools, strategies, led)

    @ti.func
    def drive_prey(
        here: ti.template(), draw: ti.template(), prey: ti.template(), a, me: ti.template(), numbers: ti.template(), b,
        swarm: ti.template(), target: ti.template(),
    ):  # fmt: skip
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
                if APART:
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
            if APART:
                weights = see.weights_of(p, numbers, b)
                kick = p.strategy.kick(threat, dice_of(draw, philox.STRATEGY), kept.of(p, prey, a), weights)
                for k in ti.static(range(dim)):
                    course[k] += weights.on * kick[k]
        note(prey, a, "prey", "kick", course)
        prey[a + rows.seen] = threat.n
        steps.prey.advance(prey, a, course, me, numbers, b)

    return drive_prey


def _predators(tools: _Tools) -> Func:
    """Build the move of a predator."""
    layout, see, senses, steps = tools.layout, tools.see, tools.senses, tools.steps
    at, rows, dim, width = layout.at, layout.rows, len(layout.axes), len(layout.paths)
    lanes, common = tools.types.lanes, tools.courses
    note, timed, pulled, turned, deflected = common.note, common.timed, common.pulled, common.turned, common.deflected
    dice_of, consults, told = common.dice, tools.consults, tools.told
    pursuits = layout.parts("predators", "strategy")
    chasing = any(p.part in consults for p in pursuits)

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
            if APART:
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

    return drive_predator
