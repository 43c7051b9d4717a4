"""Move: how agents steer and one step of their motion; all of a kind read one snapshot."""

from types import SimpleNamespace

import taichi as ti

from tiswarm import rng, sense, step
from tiswarm.lanes import anywhere, minus, motion
from tiswarm.layout import AGE, TICK, TRIAL, Layout


def build(layout: Layout, types: SimpleNamespace, see: SimpleNamespace, uniform) -> SimpleNamespace:
    """Build `move_prey` and `move_predators` for a structure."""
    lanes = types.lanes
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    frame = layout.structure.frame
    sensed = sense.build(layout, types, see)
    steps = step.build(layout, see)
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
    prey_at, predator_at = see.me_at["prey"], see.me_at["predators"]
    memory_of, swarm_of, threat_to = sensed.memory_of, sensed.swarm_of, sensed.threat_to
    flock_prey, turn_prey, deflect_prey = (each["prey"] for each in (sensed.flock, sensed.turn, sensed.deflect))
    flock_predators, turn_predators, deflect_predators = (
        each["predators"] for each in (sensed.flock, sensed.turn, sensed.deflect)
    )
    strategies = layout.parts("prey", "strategy")
    kicking = [p for p in strategies if p.strategy.dice]
    remembering = [p for p in strategies if "remember" in p.own]
    starting = [p for p in strategies if "start" in p.own]
    pursuits = layout.parts("predators", "strategy")
    surveys = [p.strategy.survey(layout, types, see, uniform, p) for p in layout.parts("predators", "strategy", "survey")]
    deflected = {kind: bool(layout.parts(kind, "avoidance", "deflect")) for kind in layout.agent_rows}

    @ti.func
    def dice_of(integer: ti.template(), b, i, purpose: ti.template(), key_low, key_high):
        first, second, _, _ = uniform(key_low, key_high, integer[b, TRIAL], purpose, i, integer[b, TICK])
        return see.Dice(a=first, b=second)

    @ti.func
    def begin(prey: ti.template(), numbers: ti.template(), b, count, fresh):
        """Give strategies' memory its first values."""
        limits = see.limits_of(numbers, b, at.prey)
        for i in range(count):
            a = (b * count + i) * prey_rows
            me = prey_at(prey, a, i, limits)
            for p in ti.static(starting):
                memory = memory_of(p, prey, a)
                p.strategy.start(memory, me, see.weights_of(p, numbers, b))
                for k in ti.static(range(len(p.memory))):
                    kept = ti.static([getattr(memory, name) for name in p.memory])[k]
                    prey[a + p.memory_rows[k]] = ti.select(fresh, kept, prey[a + p.memory_rows[k]])

    @ti.func
    def remember(prey: ti.template(), numbers: ti.template(), b, count):
        """Let strategies update the agents' memory from what was seen in this move."""
        swarm_seen = lanes(0.0)
        limits = see.limits_of(numbers, b, at.prey)
        for i in range(count):
            a = (b * count + i) * prey_rows
            swarm_seen += prey[a + rows.alive] * prey[a + rows.seen]
        for i in range(count):
            a = (b * count + i) * prey_rows
            me = prey_at(prey, a, i, limits)
            for p in ti.static(remembering):
                memory = memory_of(p, prey, a)
                p.strategy.remember(memory, me, prey[a + rows.seen], swarm_seen, see.weights_of(p, numbers, b))
                for k in ti.static(range(len(p.memory))):
                    prey[a + p.memory_rows[k]] = ti.static([getattr(memory, name) for name in p.memory])[k]

    @ti.func
    def steer_prey(
        course: ti.template(),
        me: ti.template(),
        prey: ti.template(),
        predators: ti.template(),
        numbers: ti.template(),
        b,
        counts,
        a,
        threat: ti.template(),
        swarm: ti.template(),
    ):
        """Add what the strategies steer; those that integrate on their own make a course of their own out of it."""
        for p in ti.static(strategies):
            weights = see.weights_of(p, numbers, b)
            notes = sensed.notes_of_prey(p, prey, predators, numbers, b, counts, me, weights)
            if ti.static("integrate" in p.own):
                push = minus(course, motion(me))
                dt = numbers[b * width + at.dt]
                other = p.strategy.integrate(me, push, swarm, notes, memory_of(p, prey, a), dt, weights)
                for k in ti.static(range(dim)):
                    course[k] = ti.select(weights.on > 0.5, other[k], course[k])
            elif ti.static("steer" in p.own):
                steer = p.strategy.steer(me, threat, swarm, notes, memory_of(p, prey, a), weights)
                for k in ti.static(range(dim)):
                    course[k] += weights.on * steer[k]

    @ti.func
    def move_prey(
        prey: ti.template(),
        predators: ti.template(),
        obstacles: ti.template(),
        numbers: ti.template(),
        clock: ti.template(),
        integer: ti.template(),
        b,
        counts,
        key_low,
        key_high,
    ):
        """V += flocking + goal seeking + field + strategy; turn; cap; kick; p += v dt (Lupau 2022, equations 9 to 11)."""
        n = b * width
        if ti.static(bool(starting) or "prey" in frame.unicycles):
            fresh = clock[b, AGE] < 0.5
            if anywhere(fresh):
                begin(prey, numbers, b, counts[0], fresh)
                if ti.static("prey" in frame.unicycles):
                    steps.prey.face(prey, b, counts[0], fresh)
        if ti.static(frame.verlet):
            steps.prey.drift(prey, numbers, b, counts[0])
        swarm = swarm_of(prey, b, counts[0], clock[b, AGE])
        target = see.target_of(numbers, b)
        limits = see.limits_of(numbers, b, at.prey)
        for i in range(counts[0]):
            a = (b * counts[0] + i) * prey_rows
            me = prey_at(prey, a, i, limits)
            threat = threat_to(me, predators, numbers, b, counts[1])
            pull = flock_prey(prey, numbers, b, counts[0], me)
            course = [rate + part for rate, part in ti.static(zip(motion(me), pull, strict=True))]
            if ti.static(frame.targeted):
                way = see.sight(target, me, numbers, b)
                for k in ti.static(range(dim)):
                    course[k] += numbers[n + at.prey.goal] * way[k]
            for k in ti.static(range(dim)):
                course[k] += prey[a + rows.field[k]]
            steps.wall_turn(course, me, numbers, b)
            steer_prey(course, me, prey, predators, numbers, b, counts, a, threat, swarm)
            turn_prey(course, obstacles, numbers, b, counts[2], me)
            steps.prey.limited(course, me, numbers, b)
            if ti.static(deflected["prey"]):
                dice = dice_of(integer, b, i, rng.DEFLECTION, key_low, key_high)
                deflect_prey(course, obstacles, numbers, b, counts[2], me, target, dice)
            for p in ti.static(kicking):
                weights = see.weights_of(p, numbers, b)
                dice = dice_of(integer, b, i, rng.STRATEGY, key_low, key_high)
                kick = p.strategy.kick(threat, dice, memory_of(p, prey, a), weights)
                for k in ti.static(range(dim)):
                    course[k] += weights.on * kick[k]
            prey[a + rows.seen] = threat.n
            steps.prey.advance(prey, a, course, me, numbers, b)
        steps.prey.commit(prey, numbers, b, counts[0])
        if ti.static(frame.contact == "bounce"):
            steps.bounce(prey, numbers, b, counts[0])
        if ti.static(bool(remembering)):
            remember(prey, numbers, b, counts[0])

    @ti.func
    def move_predators(
        prey: ti.template(),
        predators: ti.template(),
        obstacles: ti.template(),
        numbers: ti.template(),
        clock: ti.template(),
        integer: ti.template(),
        board: ti.template(),
        b,
        counts,
        key_low,
        key_high,
    ):
        """V += flocking + pursuit + field; turn; cap; p += v dt. The prey have moved already, and none has been removed yet."""
        n = b * width
        if ti.static("predators" in frame.unicycles):
            steps.predators.face(predators, b, counts[1], clock[b, AGE] < 0.5)
        if ti.static(frame.verlet):
            steps.predators.drift(predators, numbers, b, counts[1])
        for survey in ti.static(surveys):
            survey(prey, predators, board, numbers, integer[b, TRIAL], integer[b, TICK], b, counts, key_low, key_high)
        quarry = swarm_of(prey, b, counts[0], clock[b, AGE])
        target = see.target_of(numbers, b)
        limits = see.limits_of(numbers, b, at.predators)
        for i in range(counts[1]):
            a = (b * counts[1] + i) * predator_rows
            me = predator_at(predators, a, i, limits)
            pull = flock_predators(predators, numbers, b, counts[1], me)
            course = [rate + part for rate, part in ti.static(zip(motion(me), pull, strict=True))]
            for k in ti.static(range(dim)):
                course[k] += predators[a + rows.field[k]]
            steps.wall_turn(course, me, numbers, b)
            for p in ti.static(pursuits):
                weights = see.weights_of(p, numbers, b)
                notes = sensed.notes_of_predator(p, prey, numbers, b, counts[0], me, quarry, weights)
                way = p.strategy.pursue(me, quarry, target, notes, weights)
                goal = numbers[n + at.predators.goal]
                if ti.static(p.strategy.rules):
                    for k in ti.static(range(dim)):
                        course[k] = ti.select(weights.on > 0.5, goal * way[k], course[k])
                else:
                    goal = weights.on * goal
                    for k in ti.static(range(dim)):
                        course[k] += goal * way[k]
            turn_predators(course, obstacles, numbers, b, counts[2], me)
            steps.predators.limited(course, me, numbers, b)
            if ti.static(deflected["predators"]):
                dice = dice_of(integer, b, i, rng.PREDATOR_DEFLECTION, key_low, key_high)
                deflect_predators(course, obstacles, numbers, b, counts[2], me, target, dice)
            steps.predators.advance(predators, a, course, me, numbers, b)
        steps.predators.commit(predators, numbers, b, counts[1])

    return SimpleNamespace(move_prey=move_prey, move_predators=move_predators)
