"""Contact: who dies, who arrives, and what the obstacles' fields do, judged on the state that the last move left."""

from types import SimpleNamespace

import taichi as ti

from tiswarm.lanes import anywhere, larger, near, safe
from tiswarm.layout import (
    AGE,
    ALIVE,
    ALIVE_COUNT,
    ARRIVED,
    ARRIVED_COUNT,
    CAPTURED,
    CAPTURED_COUNT,
    CRASHED,
    CRASHED_COUNT,
    DONE,
    FATE,
    FIELD_X,
    FIELD_Y,
    FIRST_ARRIVAL,
    HIT,
    LAST_ARRIVAL,
    ON,
    Layout,
    X,
    Y,
)


def build(layout: Layout, types: SimpleNamespace, see: SimpleNamespace) -> SimpleNamespace:
    """Build `judge`."""
    lanes = types.lanes
    at = layout.at
    width = len(layout.paths)
    hunted = layout.structure.hunted
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]

    def meets_obstacles(kind: str):
        fields = layout.parts(kind, "avoidance", "field")

        @ti.func
        def meet(agents: ti.template(), a, me, obstacles: ti.template(), numbers: ti.template(), b, count, target):
            """Store the fields' pull on an agent and give 1 where it touches an obstacle: both need the same distances."""
            touched = lanes(0.0)
            field_x = lanes(0.0)
            field_y = lanes(0.0)
            for j in range(count):
                obstacle = see.obstacle_at(obstacles, b, count, j)
                x = me.x - obstacle.x
                y = me.y - obstacle.y
                distance2 = x * x + y * y
                size = me.radius + obstacle.radius
                touched += ti.select(distance2 < size * size, 1.0, 0.0)
                for p in ti.static(fields):
                    weights = see.weights_of(p, numbers, b)
                    reach = larger(obstacle.radius + p.strategy.reach(weights), 0.0)
                    inside = distance2 <= reach * reach
                    if anywhere(inside):
                        push_x, push_y = p.strategy.field(x, y, safe(distance2), me, obstacle, target, weights)
                        share = ti.select(inside, weights.on, 0.0)
                        field_x += share * push_x
                        field_y += share * push_y
            agents[a + FIELD_X] = field_x
            agents[a + FIELD_Y] = field_y
            return ti.select(touched > 0.5, 1.0, 0.0)

        return meet

    meet_prey = meets_obstacles("prey")
    meet_predators = meets_obstacles("predators")

    @ti.func
    def crash_predators(predators: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, counts, moved, target):
        limits = see.limits_of(numbers, b, at.predators)
        for j in range(counts[1]):
            q = (b * counts[1] + j) * predator_rows
            me = see.me_at(predators, q, j, limits)
            touched = meet_predators(predators, q, me, obstacles, numbers, b, counts[2], target)
            x = me.x - target.x
            y = me.y - target.y
            crashed = moved * me.alive * ti.max(touched, near(x * x + y * y, target.radius))
            predators[q + ALIVE] = me.alive - crashed
            predators[q + FATE] = ti.select(crashed > 0.5, float(CRASHED), predators[q + FATE])

    @ti.func
    def crash_prey(prey: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, counts, moved, target):
        limits = see.limits_of(numbers, b, at.prey)
        crashed_count = lanes(0.0)
        for i in range(counts[0]):
            a = (b * counts[0] + i) * prey_rows
            me = see.me_at(prey, a, i, limits)
            crashed = moved * me.alive * meet_prey(prey, a, me, obstacles, numbers, b, counts[2], target)
            prey[a + ALIVE] = me.alive - crashed
            prey[a + FATE] = ti.select(crashed > 0.5, float(CRASHED), prey[a + FATE])
            crashed_count += crashed
        return crashed_count

    @ti.func
    def capture(prey: ti.template(), predators: ti.template(), numbers: ti.template(), b, counts, moved):
        """Let pairs kill, all judged on the same lists: one predator can take two prey at once, and both sides die."""
        n = b * width
        reach = numbers[n + at.prey.radius] + numbers[n + at.predators.radius]
        reach2 = reach * reach
        captured_count = lanes(0.0)
        for j in range(counts[1]):
            predators[(b * counts[1] + j) * predator_rows + HIT] = lanes(0.0)
        for i in range(counts[0]):
            a = (b * counts[0] + i) * prey_rows
            x, y, alive = prey[a + X], prey[a + Y], prey[a + ALIVE]
            captured = lanes(0.0)
            for j in range(counts[1]):
                q = (b * counts[1] + j) * predator_rows
                to_x = x - predators[q + X]
                to_y = y - predators[q + Y]
                touch = to_x * to_x + to_y * to_y < reach2
                if anywhere(touch):
                    hit = ti.select(touch, moved * alive * predators[q + ALIVE], 0.0)
                    captured = ti.max(captured, hit)
                    predators[q + HIT] = ti.max(predators[q + HIT], hit)
            prey[a + ALIVE] = alive - captured
            prey[a + FATE] = ti.select(captured > 0.5, float(CAPTURED), prey[a + FATE])
            captured_count += captured
        if anywhere(captured_count > 0.5):
            for j in range(counts[1]):
                q = (b * counts[1] + j) * predator_rows
                predators[q + ALIVE] = predators[q + ALIVE] - predators[q + HIT]
                predators[q + FATE] = ti.select(predators[q + HIT] > 0.5, float(CAPTURED), predators[q + FATE])
        return captured_count

    @ti.func
    def arrive(prey: ti.template(), numbers: ti.template(), clock: ti.template(), b, counts, moved, target):
        """Take prey that lie wholly inside the target out of the trial; give how many stay."""
        depth = ti.max(target.radius - numbers[b * width + at.prey.radius], 0.0)
        arrived_count = lanes(0.0)
        alive_count = lanes(0.0)
        for i in range(counts[0]):
            a = (b * counts[0] + i) * prey_rows
            x = prey[a + X] - target.x
            y = prey[a + Y] - target.y
            arrived = moved * prey[a + ALIVE] * near(x * x + y * y, depth)
            prey[a + ALIVE] = prey[a + ALIVE] - arrived
            prey[a + FATE] = ti.select(arrived > 0.5, float(ARRIVED), prey[a + FATE])
            arrived_count += arrived
            alive_count += prey[a + ALIVE]
        first = (clock[b, ARRIVED_COUNT] < 0.5) & (arrived_count > 0.5)
        clock[b, FIRST_ARRIVAL] = ti.select(first, clock[b, AGE], clock[b, FIRST_ARRIVAL])
        clock[b, LAST_ARRIVAL] = ti.select(arrived_count > 0.5, clock[b, AGE], clock[b, LAST_ARRIVAL])
        clock[b, ARRIVED_COUNT] = clock[b, ARRIVED_COUNT] + arrived_count
        return alive_count

    @ti.func
    def judge(
        prey: ti.template(),
        predators: ti.template(),
        obstacles: ti.template(),
        numbers: ti.template(),
        clock: ti.template(),
        b,
        counts,
    ):
        """Obstacles and the target kill, then pairs kill, then prey arrive; a start that has not moved is not judged.

        Judging the same state twice changes nothing the second time, so a trial can pause between two ticks.
        """
        moved = ti.select(clock[b, AGE] > 0.5, 1.0, 0.0)
        target = see.target_of(numbers, b)
        if ti.static(hunted):
            crash_predators(predators, obstacles, numbers, b, counts, moved, target)
        clock[b, CRASHED_COUNT] = clock[b, CRASHED_COUNT] + crash_prey(prey, obstacles, numbers, b, counts, moved, target)
        if ti.static(hunted):
            clock[b, CAPTURED_COUNT] = clock[b, CAPTURED_COUNT] + capture(prey, predators, numbers, b, counts, moved)
        alive_count = arrive(prey, numbers, clock, b, counts, moved, target)
        clock[b, ALIVE_COUNT] = alive_count
        ended = (alive_count < 0.5) | (clock[b, AGE] > numbers[b * width + at.ticks] - 0.5)
        clock[b, DONE] = ti.select(ended, clock[b, ON], lanes(0.0))

    return SimpleNamespace(judge=judge)
