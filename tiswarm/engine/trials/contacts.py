"""Contacts: who of a block's trials dies, arrives and bounces; the rules are dynamics/contact.py's."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics import contact
from tiswarm.dynamics.rows import (
    AGE,
    ALIVE_COUNT,
    ARRIVED_COUNT,
    CAPTURED,
    CAPTURED_COUNT,
    CRASHED_COUNT,
    DONE,
    FIRST_ARRIVAL,
    LAST_ARRIVAL,
    ON,
)
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import anywhere, larger, minus, motion, row_of
from tiswarm.simd.runtime import Func, Types


@dataclass(frozen=True)
class Contacts:
    """The loops over who may touch whom."""

    judge: Func
    bounce: Func  # let prey that touch and approach each other bounce, pair by pair in a fixed order


def build(layout: ParameterTable, types: Types, see: Views) -> Contacts:
    """Build `judge`, and `bounce` for prey that collide without harm."""
    lanes = types.lanes
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    frame, hunted = layout.structure.frame, layout.structure.hunted
    rules = contact.build(layout, types, see)
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
    prey_mate, predator_mate = see.mate_at["prey"], see.mate_at["predators"]

    def crashes(kind: str, column: int):
        agent_rows, me_at, limits_at = layout.agent_rows[kind], see.me_at[kind], getattr(at, kind)
        meet_obstacle, crash = rules.meet_obstacle[kind], rules.crash[kind]

        @ti.func
        def crash_all(agents: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, counts, moved, target):
            """Let obstacles, and for predators the target, kill; keep what fields add to velocities. Give how many died."""
            limits = see.limits_of(numbers, b, limits_at)
            crashed = lanes(0.0)
            for i in range(counts[column]):
                a = row_of(b * counts[column] + i, agent_rows)
                me = me_at(agents, a, i, limits)
                travel = rules.travel_of(agents, a)
                touched = [lanes(0.0)]
                pull = [lanes(0.0) for _ in ti.static(range(dim))]
                for j in range(counts[2]):
                    obstacle = see.obstacle_at(obstacles, b, counts[2], j)
                    away = see.gap(me, obstacle, numbers, b)
                    meet_obstacle(touched, pull, me, travel, obstacle, away, target, numbers, b)
                for k in ti.static(range(dim)):
                    agents[a + rows.field[k]] = pull[k]
                crashed += crash(agents, a, me, touched[0], moved, target, numbers, b)
            return crashed

        return crash_all

    crash_prey, crash_predators = crashes("prey", 0), crashes("predators", 1)

    @ti.func
    def capture(prey: ti.template(), predators: ti.template(), numbers: ti.template(), b, counts, moved):
        """Let pairs kill, all judged on the same lists: one predator can take two prey at once; of a deadly touch both die."""
        n = b * width
        reach = numbers[n + at.prey.radius] + numbers[n + at.predators.radius]
        captured_count = lanes(0.0)
        for j in range(counts[1]):
            predators[row_of(b * counts[1] + j, predator_rows) + rows.hit] = lanes(0.0)
        for i in range(counts[0]):
            a = row_of(b * counts[0] + i, prey_rows)
            me = prey_mate(prey, a, i)
            captured = lanes(0.0)
            for j in range(counts[1]):
                q = row_of(b * counts[1] + j, predator_rows)
                hunter = predator_mate(predators, q, j)
                travel = minus(rules.travel_of(prey, a), rules.travel_of(predators, q))
                touch = rules.touches(rules.nearest(see.gap(me, hunter, numbers, b), travel, numbers, b), reach)
                if anywhere(touch):
                    hit = ti.select(touch, moved * me.alive * hunter.alive, 0.0)
                    captured = larger(captured, hit)
                    predators[q + rows.hit] = larger(predators[q + rows.hit], hit)
            rules.die(prey, a, captured, CAPTURED)
            captured_count += captured
        if ti.static(frame.contact == "deadly"):  # noqa: SIM102 - one branch at compile time, one at run time
            if anywhere(captured_count > 0.5):
                for j in range(counts[1]):
                    q = row_of(b * counts[1] + j, predator_rows)
                    rules.die(predators, q, predators[q + rows.hit], CAPTURED)
        return captured_count

    @ti.func
    def arrive(prey: ti.template(), numbers: ti.template(), clock: ti.template(), b, counts, moved, target):
        """Let prey arrive, and note when; give how many stay."""
        arrived_count = lanes(0.0)
        alive_count = lanes(0.0)
        for i in range(counts[0]):
            a = row_of(b * counts[0] + i, prey_rows)
            me = prey_mate(prey, a, i)
            arrived = rules.arrive(prey, a, me, moved, target, numbers, b)
            arrived_count += arrived
            alive_count += me.alive - arrived
        first = (clock[b, ARRIVED_COUNT] < 0.5) & (arrived_count > 0.5)
        clock[b, FIRST_ARRIVAL] = ti.select(first, clock[b, AGE], clock[b, FIRST_ARRIVAL])
        clock[b, LAST_ARRIVAL] = ti.select(arrived_count > 0.5, clock[b, AGE], clock[b, LAST_ARRIVAL])
        clock[b, ARRIVED_COUNT] = clock[b, ARRIVED_COUNT] + arrived_count
        return alive_count

    @ti.func
    def judge(block: ti.template()):
        """Obstacles and the target kill, then pairs kill, then prey arrive; so a trial can pause between two ticks."""
        b, counts = block.b, block.counts
        prey, predators, obstacles = ti.static(block.prey, block.predators, block.obstacles)
        numbers, clock = ti.static(block.numbers, block.clock)
        moved = ti.select(clock[b, AGE] > 0.5, 1.0, 0.0)
        target = see.target_of(numbers, b)
        if ti.static(hunted):
            crash_predators(predators, obstacles, numbers, b, counts, moved, target)
        clock[b, CRASHED_COUNT] = clock[b, CRASHED_COUNT] + crash_prey(prey, obstacles, numbers, b, counts, moved, target)
        if ti.static(hunted and frame.contact in ("deadly", "eaten")):
            clock[b, CAPTURED_COUNT] = clock[b, CAPTURED_COUNT] + capture(prey, predators, numbers, b, counts, moved)
        alive_count = arrive(prey, numbers, clock, b, counts, moved, target)
        clock[b, ALIVE_COUNT] = alive_count
        ended = (alive_count < 0.5) | (clock[b, AGE] > numbers[b * width + at.ticks] - 0.5)
        clock[b, DONE] = ti.select(ended, clock[b, ON], lanes(0.0))

    return Contacts(judge=judge, bounce=_bounce(layout, see, rules))


def _bounce(layout: ParameterTable, see: Views, rules: contact.ContactRules) -> Func:
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width, prey_rows, prey_mate = len(layout.paths), layout.agent_rows["prey"], see.mate_at["prey"]

    @ti.func
    def bounce(prey: ti.template(), numbers: ti.template(), b, count):
        """Let prey that touch and approach each other bounce, pair by pair in a fixed order."""
        reach = 2.0 * numbers[b * width + at.prey.radius]
        for i in range(count):
            a = row_of(b * count + i, prey_rows)
            for j in range(i + 1, count):
                c = row_of(b * count + j, prey_rows)
                me = prey_mate(prey, a, i)
                mate = prey_mate(prey, c, j)
                away = see.gap(me, mate, numbers, b)
                if anywhere(rules.touches(away, reach)):
                    given = rules.rebound(me, mate, away, reach)
                    for k in ti.static(range(dim)):
                        prey[a + rows.motion[k]] = motion(me)[k] - given[k]
                        prey[c + rows.motion[k]] = motion(mate)[k] + given[k]

    return bounce
