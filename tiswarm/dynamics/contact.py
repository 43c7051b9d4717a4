"""Contact: who dies, who arrives, and what the obstacles' fields do, judged on the state that the last move left."""

from types import SimpleNamespace

import taichi as ti

from tiswarm.dynamics.table import (
    AGE,
    ALIVE_COUNT,
    ARRIVED,
    ARRIVED_COUNT,
    CAPTURED,
    CAPTURED_COUNT,
    CRASHED,
    CRASHED_COUNT,
    DONE,
    FIRST_ARRIVAL,
    LAST_ARRIVAL,
    ON,
    Layout,
)
from tiswarm.simd.lanes import anywhere, dot, larger, near, safe


def build(layout: Layout, types: SimpleNamespace, see: SimpleNamespace) -> SimpleNamespace:
    """Build `judge`."""
    lanes = types.lanes
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    frame = layout.structure.frame
    hunted = layout.structure.hunted
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
    prey_at, predator_at = see.me_at["prey"], see.me_at["predators"]
    prey_mate, predator_mate = see.mate_at["prey"], see.mate_at["predators"]

    def meets_obstacles(kind: str):
        fields = layout.parts(kind, "avoidance", "field")

        @ti.func
        def meet(agents: ti.template(), a, me, obstacles: ti.template(), numbers: ti.template(), b, count, target):
            """Store the fields' pull on an agent and give 1 where it touches an obstacle: both need the same distances."""
            touched = lanes(0.0)
            pull = [lanes(0.0) for _ in ti.static(range(dim))]
            for j in range(count):
                obstacle = see.obstacle_at(obstacles, b, count, j)
                away = see.gap(me, obstacle, numbers, b)
                distance2 = dot(away, away)
                size = me.radius + obstacle.radius
                touched += ti.select(distance2 < size * size, 1.0, 0.0)
                for p in ti.static(fields):
                    weights = see.weights_of(p, numbers, b)
                    reach = larger(obstacle.radius + p.strategy.reach(weights), 0.0)
                    inside = distance2 <= reach * reach
                    if anywhere(inside):
                        push = p.strategy.field(away, safe(distance2), me, obstacle, target, weights)
                        share = ti.select(inside, weights.on, 0.0)
                        for k in ti.static(range(dim)):
                            pull[k] += share * push[k]
            for k in ti.static(range(dim)):
                agents[a + rows.field[k]] = pull[k]
            return ti.select(touched > 0.5, 1.0, 0.0)

        return meet

    meet_prey = meets_obstacles("prey")
    meet_predators = meets_obstacles("predators")

    @ti.func
    def reached(me: ti.template(), target, numbers: ti.template(), b, depth):
        """Give 1 where an agent's centre is within `depth` of the target's."""
        inside = lanes(0.0)
        if ti.static(frame.targeted):
            way = see.gap(me, target, numbers, b)
            inside = near(dot(way, way), depth)
        return inside

    @ti.func
    def die(agents: ti.template(), a, alive, dies, fate: ti.template()):
        agents[a + rows.alive] = alive - dies
        agents[a + rows.fate] = ti.select(dies > 0.5, float(fate), agents[a + rows.fate])

    @ti.func
    def crash_predators(predators: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, counts, moved, target):
        limits = see.limits_of(numbers, b, at.predators)
        for j in range(counts[1]):
            q = (b * counts[1] + j) * predator_rows
            me = predator_at(predators, q, j, limits)
            touched = meet_predators(predators, q, me, obstacles, numbers, b, counts[2], target)
            if ti.static(not frame.counts_hits):
                crashed = moved * me.alive * ti.max(touched, reached(me, target, numbers, b, target.radius))
                die(predators, q, me.alive, crashed, CRASHED)

    @ti.func
    def crash_prey(prey: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, counts, moved, target):
        limits = see.limits_of(numbers, b, at.prey)
        crashed_count = lanes(0.0)
        for i in range(counts[0]):
            a = (b * counts[0] + i) * prey_rows
            me = prey_at(prey, a, i, limits)
            touched = moved * me.alive * meet_prey(prey, a, me, obstacles, numbers, b, counts[2], target)
            if ti.static(frame.counts_hits):
                prey[a + rows.hit] = larger(prey[a + rows.hit], touched)
            else:
                die(prey, a, me.alive, touched, CRASHED)
                crashed_count += touched
        return crashed_count

    @ti.func
    def capture(prey: ti.template(), predators: ti.template(), numbers: ti.template(), b, counts, moved):
        """Let pairs kill, all judged on the same lists: one predator can take two prey at once; of a deadly touch both die."""
        n = b * width
        reach = numbers[n + at.prey.radius] + numbers[n + at.predators.radius]
        reach2 = reach * reach
        captured_count = lanes(0.0)
        for j in range(counts[1]):
            predators[(b * counts[1] + j) * predator_rows + rows.hit] = lanes(0.0)
        for i in range(counts[0]):
            a = (b * counts[0] + i) * prey_rows
            me = prey_mate(prey, a, i)
            captured = lanes(0.0)
            for j in range(counts[1]):
                q = (b * counts[1] + j) * predator_rows
                hunter = predator_mate(predators, q, j)
                way = see.gap(me, hunter, numbers, b)
                touch = dot(way, way) < reach2
                if anywhere(touch):
                    hit = ti.select(touch, moved * me.alive * hunter.alive, 0.0)
                    captured = ti.max(captured, hit)
                    predators[q + rows.hit] = ti.max(predators[q + rows.hit], hit)
            die(prey, a, me.alive, captured, CAPTURED)
            captured_count += captured
        if ti.static(frame.contact == "deadly"):  # noqa: SIM102 - one branch at compile time, one at run time
            if anywhere(captured_count > 0.5):
                for j in range(counts[1]):
                    q = (b * counts[1] + j) * predator_rows
                    die(predators, q, predators[q + rows.alive], predators[q + rows.hit], CAPTURED)
        return captured_count

    @ti.func
    def arrive(prey: ti.template(), numbers: ti.template(), clock: ti.template(), b, counts, moved, target):
        """Take prey that lie wholly inside the target out of the trial; give how many stay."""
        depth = ti.max(target.radius - numbers[b * width + at.prey.radius], 0.0)
        arrived_count = lanes(0.0)
        alive_count = lanes(0.0)
        for i in range(counts[0]):
            a = (b * counts[0] + i) * prey_rows
            me = prey_mate(prey, a, i)
            arrived = moved * me.alive * reached(me, target, numbers, b, depth)
            die(prey, a, me.alive, arrived, ARRIVED)
            arrived_count += arrived
            alive_count += me.alive - arrived
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
        if ti.static(hunted and frame.contact in ("deadly", "eaten")):
            clock[b, CAPTURED_COUNT] = clock[b, CAPTURED_COUNT] + capture(prey, predators, numbers, b, counts, moved)
        alive_count = arrive(prey, numbers, clock, b, counts, moved, target)
        clock[b, ALIVE_COUNT] = alive_count
        ended = (alive_count < 0.5) | (clock[b, AGE] > numbers[b * width + at.ticks] - 0.5)
        clock[b, DONE] = ti.select(ended, clock[b, ON], lanes(0.0))

    return SimpleNamespace(judge=judge)
