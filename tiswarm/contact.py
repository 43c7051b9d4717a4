"""Contact: who dies, who arrives, and what the obstacles' fields do, judged on the state that the last move left."""

from types import SimpleNamespace

import taichi as ti

from tiswarm.lanes import near
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
    OBSTACLE_RADIUS,
    OBSTACLE_ROWS,
    OBSTACLE_X,
    OBSTACLE_Y,
    ON,
    VX,
    VY,
    Layout,
    X,
    Y,
)


def build(layout: Layout, types: SimpleNamespace, structs: SimpleNamespace) -> SimpleNamespace:
    """Build `judge`. One pass over an agent's obstacles serves both the crash and the field: they need the same distances."""
    lanes = types.lanes
    at = layout.at
    hunted = layout.structure.hunted
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]

    def meets_obstacles(kind: str):
        columns, rows = getattr(at, kind), layout.agent_rows[kind]
        fields = layout.parts(kind, "avoidance", "field")

        @ti.func
        def meet(agents: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, i, obstacle_count, target):
            """Store the field's pull at agent i; give 1 where it touches an obstacle."""
            r = b * rows
            o = b * OBSTACLE_ROWS
            me = structs.Me(
                x=agents[r + X, i],
                y=agents[r + Y, i],
                vx=agents[r + VX, i],
                vy=agents[r + VY, i],
                alive=agents[r + ALIVE, i],
                radius=numbers[b, columns.radius],
                perception=numbers[b, columns.perception],
                max_speed=numbers[b, columns.max_speed],
                number=i + 1,
            )
            touched = lanes(0.0)
            field_x = lanes(0.0)
            field_y = lanes(0.0)
            for j in range(obstacle_count):
                obstacle = structs.Obstacle(
                    x=obstacles[o + OBSTACLE_X, j], y=obstacles[o + OBSTACLE_Y, j], radius=obstacles[o + OBSTACLE_RADIUS, j]
                )
                x = me.x - obstacle.x
                y = me.y - obstacle.y
                size = me.radius + obstacle.radius
                touched = ti.max(touched, ti.select(x * x + y * y < size * size, 1.0, 0.0))
                for p in ti.static(fields):
                    weights = p.Weights(*[numbers[b, column] for column in ti.static(p.columns)])
                    push_x, push_y = p.strategy.field(me, obstacle, target, weights)
                    if ti.static(p.part.mixed):
                        field_x += weights.on * push_x
                        field_y += weights.on * push_y
                    else:
                        field_x += push_x
                        field_y += push_y
            agents[r + FIELD_X, i] = field_x
            agents[r + FIELD_Y, i] = field_y
            return touched

        return meet

    meet_prey = meets_obstacles("prey")
    meet_predators = meets_obstacles("predators")

    @ti.func
    def judge_predators(predators: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, counts, moved, target):
        r = b * predator_rows
        for j in range(counts[1]):
            touched = meet_predators(predators, obstacles, numbers, b, j, counts[2], target)
            x = predators[r + X, j] - target.x
            y = predators[r + Y, j] - target.y
            crashed = moved * ti.max(touched, near(x * x + y * y, target.radius)) * predators[r + ALIVE, j]
            predators[r + ALIVE, j] = predators[r + ALIVE, j] - crashed
            predators[r + FATE, j] = ti.select(crashed > 0.5, float(CRASHED), predators[r + FATE, j])

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
        """Obstacles and the target kill, then pairs kill, then prey arrive; a start state that has not moved is not judged.

        Judging the same state twice changes nothing the second time, so a trial can pause between two ticks.
        """
        moved = ti.select(clock[b, AGE] > 0.5, 1.0, 0.0)
        target = structs.Target(x=numbers[b, at.target.x], y=numbers[b, at.target.y], radius=numbers[b, at.target.radius])
        if ti.static(hunted):
            judge_predators(predators, obstacles, numbers, b, counts, moved, target)
        r = b * prey_rows
        h = b * predator_rows
        capture = numbers[b, at.prey.radius] + numbers[b, at.predators.radius]
        arrival = ti.max(target.radius - numbers[b, at.prey.radius], 0.0)
        alive_count = lanes(0.0)
        arrived_count = lanes(0.0)
        captured_count = lanes(0.0)
        crashed_count = lanes(0.0)
        if ti.static(hunted):
            for j in range(counts[1]):
                predators[h + HIT, j] = lanes(0.0)
        for i in range(counts[0]):
            touched = meet_prey(prey, obstacles, numbers, b, i, counts[2], target)
            alive = prey[r + ALIVE, i]
            crashed = moved * touched * alive
            alive = alive - crashed
            captured = lanes(0.0)
            if ti.static(hunted):
                for j in range(counts[1]):
                    x = prey[r + X, i] - predators[h + X, j]
                    y = prey[r + Y, i] - predators[h + Y, j]
                    hit = ti.select(x * x + y * y < capture * capture, moved * alive * predators[h + ALIVE, j], 0.0)
                    captured = ti.max(captured, hit)
                    predators[h + HIT, j] = ti.max(predators[h + HIT, j], hit)
            alive = alive - captured
            x = prey[r + X, i] - target.x
            y = prey[r + Y, i] - target.y
            arrived = moved * alive * near(x * x + y * y, arrival)
            alive = alive - arrived
            prey[r + ALIVE, i] = alive
            fate = ti.select(crashed > 0.5, float(CRASHED), prey[r + FATE, i])
            fate = ti.select(captured > 0.5, float(CAPTURED), fate)
            prey[r + FATE, i] = ti.select(arrived > 0.5, float(ARRIVED), fate)
            alive_count += alive
            arrived_count += arrived
            captured_count += captured
            crashed_count += crashed
        if ti.static(hunted):
            for j in range(counts[1]):
                hit = predators[h + HIT, j]
                predators[h + ALIVE, j] = predators[h + ALIVE, j] - hit
                predators[h + FATE, j] = ti.select(hit > 0.5, float(CAPTURED), predators[h + FATE, j])
        age = clock[b, AGE]
        first = (clock[b, ARRIVED_COUNT] < 0.5) & (arrived_count > 0.5)
        clock[b, FIRST_ARRIVAL] = ti.select(first, age, clock[b, FIRST_ARRIVAL])
        clock[b, LAST_ARRIVAL] = ti.select(arrived_count > 0.5, age, clock[b, LAST_ARRIVAL])
        clock[b, ALIVE_COUNT] = alive_count
        clock[b, ARRIVED_COUNT] = clock[b, ARRIVED_COUNT] + arrived_count
        clock[b, CAPTURED_COUNT] = clock[b, CAPTURED_COUNT] + captured_count
        clock[b, CRASHED_COUNT] = clock[b, CRASHED_COUNT] + crashed_count
        ended = (alive_count < 0.5) | (age > numbers[b, at.ticks] - 0.5)
        clock[b, DONE] = ti.select(ended, clock[b, ON], lanes(0.0))

    return SimpleNamespace(judge=judge)
