"""Tick: one tick of the motion of a block's trials; all agents of a kind read one snapshot."""

from dataclasses import dataclass, replace

import taichi as ti

from tiswarm.dynamics import perception, steering
from tiswarm.dynamics.rows import AGE, TICK, TRIAL
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.engine.trials import certificates, mates
from tiswarm.simd.lanes import Bundle, anywhere, row_of
from tiswarm.simd.runtime import Func, Types


@dataclass(frozen=True)
class Moves:
    """One tick's motion of a block."""

    move_prey: Func  # move all prey (steering.py)
    move_predators: Func  # move all predators (steering.py)


def _proceeding(layout: ParameterTable, see: Views, driven: steering.Steering) -> Func:
    rows, prey_at = layout.rows, see.me_at["prey"]

    @ti.func
    def proceed(prey: ti.template(), a, i, limits: ti.template(), numbers: ti.template(), b):
        """Let a prey go as its certificate allows."""
        course = [1.0 * prey[a + row] for row in ti.static(rows.next_motion)]
        driven.note(prey, a, "prey", "barrier", course)
        driven.steps.prey.proceed(prey, a, course, prey_at(prey, a, i, limits), numbers, b)

    return proceed


def build(layout: ParameterTable, types: Types, see: Views, uniform, bounce) -> Moves:
    """Build `move_prey` and `move_predators` for a structure."""
    lanes, integers = types.lanes, types.integer_lanes
    at, rows, frame = layout.at, layout.rows, layout.structure.frame
    alone = perception.build(layout, types, see)
    met = {
        kind: mates.build(layout, types, see, kind, getattr(alone.terms, kind), pull)
        for kind, pull in alone.pull.items()
        if mates.lends(layout, kind)
    }
    senses = replace(alone, pull=alone.pull | {kind: each.pull for kind, each in met.items()})
    driven = steering.build(layout, types, see, senses, uniform)
    steps, plan = driven.steps, driven.plan
    certify, proceed = certificates.build(layout, types), _proceeding(layout, see, driven)
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
    prey_at, predator_at = see.me_at["prey"], see.me_at["predators"]
    surveys = [p.strategy.survey(layout, types, see, uniform, p) for p in layout.parts("predators", "strategy", "survey")]

    @ti.func
    def looker(block: ti.template(), i):
        return Bundle(
            prey=block.prey, predators=block.predators, obstacles=block.obstacles, numbers=block.numbers, met=block.met,
            board=block.board, b=block.b, counts=block.counts, i=i,
        )  # fmt: skip

    @ti.func
    def draw_of(block: ti.template(), i):
        b, index = block.b, integers(ti.cast(i, ti.u32))
        trial, now = block.integer[b, TRIAL], block.integer[b, TICK]
        return Bundle(key_low=block.key_low, key_high=block.key_high, trial=trial, index=index, tick=now)

    @ti.func
    def begin(prey: ti.template(), numbers: ti.template(), b, count, fresh):
        limits = see.limits_of(numbers, b, at.prey)
        for i in range(count):
            a = row_of(b * count + i, prey_rows)
            driven.memories.begin(prey, a, prey_at(prey, a, i, limits), numbers, b, fresh)
            if ti.static("prey" in frame.unicycles):
                steps.prey.face(prey, a, fresh)

    @ti.func
    def remember(prey: ti.template(), numbers: ti.template(), b, count):
        swarm_seen = lanes(0.0)
        limits = see.limits_of(numbers, b, at.prey)
        for i in range(count):
            a = row_of(b * count + i, prey_rows)
            swarm_seen += prey[a + rows.alive] * prey[a + rows.seen]
        for i in range(count):
            a = row_of(b * count + i, prey_rows)
            driven.memories.remember(prey, a, prey_at(prey, a, i, limits), numbers, b, swarm_seen)

    @ti.func
    def move_prey(block: ti.template()):
        """Move all prey (steering.py)."""
        b, counts = block.b, block.counts
        prey, numbers, clock = ti.static(block.prey, block.numbers, block.clock)
        if ti.static(frame.plan != ""):  # noqa: SIM102 - one branch at compile time, one at run time
            if anywhere(clock[b, AGE] < 0.5):
                plan(block, clock[b, AGE] < 0.5)
        if ti.static(driven.memories.starts or "prey" in frame.unicycles):
            fresh = clock[b, AGE] < 0.5
            if anywhere(fresh):
                begin(prey, numbers, b, counts[0], fresh)
        if ti.static(frame.verlet):
            for i in range(counts[0]):
                steps.prey.drift(prey, row_of(b * counts[0] + i, prey_rows), numbers, b)
        if ti.static("prey" in met):
            met["prey"].meet(block)
        swarm = senses.swarm_of(prey, numbers, b, counts[0], clock[b, AGE])
        target = see.target_of(numbers, b)
        limits = see.limits_of(numbers, b, at.prey)
        for i in range(counts[0]):
            a = row_of(b * counts[0] + i, prey_rows)
            me = prey_at(prey, a, i, limits)
            here = looker(block, i)
            draw = draw_of(block, i)
            driven.prey(here, draw, prey, a, me, numbers, b, swarm, target)
        if ti.static(bool(frame.safety)):
            certify(block)
            for i in range(counts[0]):
                proceed(prey, row_of(b * counts[0] + i, prey_rows), i, limits, numbers, b)
        for i in range(counts[0]):
            steps.prey.commit(prey, row_of(b * counts[0] + i, prey_rows), numbers, b)
        if ti.static(frame.contact == "bounce"):
            bounce(prey, numbers, b, counts[0])
        if ti.static(driven.memories.remembers):
            remember(prey, numbers, b, counts[0])

    @ti.func
    def move_predators(block: ti.template()):
        """Move all predators (steering.py)."""
        b, counts = block.b, block.counts
        prey, predators = ti.static(block.prey, block.predators)
        numbers, clock = ti.static(block.numbers, block.clock)
        for i in range(counts[1]):
            a = row_of(b * counts[1] + i, predator_rows)
            if ti.static("predators" in frame.unicycles):
                steps.predators.face(predators, a, clock[b, AGE] < 0.5)
            if ti.static(frame.verlet):
                steps.predators.drift(predators, a, numbers, b)
        for survey in ti.static(surveys):
            survey(
                prey, predators, block.board, numbers, block.integer[b, TRIAL], block.integer[b, TICK], b, counts,
                block.key_low, block.key_high,
            )  # fmt: skip
        if ti.static("predators" in met):
            met["predators"].meet(block)
        quarry = senses.swarm_of(prey, numbers, b, counts[0], clock[b, AGE])
        target = see.target_of(numbers, b)
        limits = see.limits_of(numbers, b, at.predators)
        for i in range(counts[1]):
            a = row_of(b * counts[1] + i, predator_rows)
            me = predator_at(predators, a, i, limits)
            here = looker(block, i)
            draw = draw_of(block, i)
            driven.predators(here, draw, predators, a, me, numbers, b, quarry, target)
        for i in range(counts[1]):
            steps.predators.commit(predators, row_of(b * counts[1] + i, predator_rows), numbers, b)

    return Moves(move_prey=move_prey, move_predators=move_predators)
