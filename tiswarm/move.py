"""Move: how agents steer and one step of their motion; all of a kind read one snapshot."""

from types import SimpleNamespace

import taichi as ti

from tiswarm.flocking import flock, see_mate
from tiswarm.lanes import capped, larger
from tiswarm.layout import (
    AGE,
    ALIVE,
    FIELD_X,
    FIELD_Y,
    NEXT_VX,
    NEXT_VY,
    NEXT_X,
    NEXT_Y,
    SEEN,
    TICK,
    TRIAL,
    VX,
    VY,
    Layout,
    X,
    Y,
)
from tiswarm.rng import STRATEGY


def build(layout: Layout, types: SimpleNamespace, see: SimpleNamespace, uniform) -> SimpleNamespace:
    """Build `move_prey` and `move_predators` for a structure."""
    lanes = types.lanes
    at = layout.at
    width = len(layout.paths)
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
    strategies = layout.parts("prey", "strategy")
    pursuits = layout.parts("predators", "strategy")
    remembering = [p for p in strategies if p.memory]
    kicking = [p for p in strategies if p.strategy.dice]
    watching = layout.structure.hunted and any(p.strategy.watches for p in strategies)

    def flocks(kind: str):
        columns, rows = getattr(at, kind), layout.agent_rows[kind]
        choosy = layout.parts(kind, "strategy", "mates")

        @ti.func
        def counted(numbers: ti.template(), b, me, mate):
            """Give 1 for a mate that is there and that all strategies count as one, else 0."""
            counts = mate.alive
            for p in ti.static(choosy):
                weights = see.weights_of(p, numbers, b)
                chosen = p.strategy.mates(me, mate, weights)
                if ti.static(p.part.mixed):  # noqa: SIM108 - a branch at compile time
                    counts = counts * (1.0 - weights.on * (1.0 - chosen))
                else:
                    counts = counts * chosen
            return counts

        @ti.func
        def steer_by_mates(agents: ti.template(), numbers: ti.template(), b, count, me):
            """Separation, cohesion and alignment: what the mates in sight add to the velocity."""
            n = b * width
            spacing = ti.min(numbers[n + columns.spacing], me.perception)
            perception2 = me.perception * me.perception
            spacing2 = spacing * spacing
            mates = see.Mates(*[lanes(0.0) for _ in ti.static(range(7))])
            for j in range(count):
                mate = see.mate_at(agents, (b * count + j) * rows, j)
                see_mate(mates, me, mate, counted(numbers, b, me, mate), perception2, spacing2)
            # The loop has no branch that leaves the agent itself out: its distance is zero, so only these know.
            own = counted(numbers, b, me, me)
            mates.n += -1.0 * own
            mates.vx += -1.0 * own * me.vx
            mates.vy += -1.0 * own * me.vy
            return flock(
                me, mates, numbers[n + columns.cohesion], numbers[n + columns.separation], numbers[n + columns.alignment]
            )

        return steer_by_mates

    def turns(kind: str):
        turning = layout.parts(kind, "avoidance", "blocks")

        @ti.func
        def turned(obstacles: ti.template(), numbers: ti.template(), b, count, me, x, y):
            """Rotate the course once if any obstacle blocks it."""
            for p in ti.static(turning):
                weights = see.weights_of(p, numbers, b)
                course = see.Course(x=x, y=y)
                blocked = lanes(0.0)
                for j in range(count):
                    blocked += p.strategy.blocks(me, course, see.obstacle_at(obstacles, b, count, j), weights)
                cosine, sine = p.strategy.turn(weights)
                rotated = (blocked > 0.5) & (weights.on > 0.5)
                cosine = ti.select(rotated, cosine, 1.0)
                sine = ti.select(rotated, sine, 0.0)
                x = cosine * course.x - sine * course.y
                y = sine * course.x + cosine * course.y
            return x, y

        return turned

    @ti.func
    def swarm_of(prey: ti.template(), b, count, age):
        """Give the means over the alive prey, zero when there are none."""
        swarm = see.Swarm(n=lanes(0.0), x=lanes(0.0), y=lanes(0.0), vx=lanes(0.0), vy=lanes(0.0), age=age)
        for i in range(count):
            a = (b * count + i) * prey_rows
            alive = prey[a + ALIVE]
            swarm.n += alive
            swarm.x += alive * prey[a + X]
            swarm.y += alive * prey[a + Y]
            swarm.vx += alive * prey[a + VX]
            swarm.vy += alive * prey[a + VY]
        share = 1.0 / larger(swarm.n, 1.0)
        swarm.x = share * swarm.x
        swarm.y = share * swarm.y
        swarm.vx = share * swarm.vx
        swarm.vy = share * swarm.vy
        return swarm

    @ti.func
    def threat_to(me, predators: ti.template(), b, count):
        threat = see.Threat(n=lanes(0.0), x=lanes(0.0), y=lanes(0.0))
        if ti.static(watching):
            reach2 = me.perception * me.perception
            for j in range(count):
                q = (b * count + j) * predator_rows
                x = me.x - predators[q + X]
                y = me.y - predators[q + Y]
                seen = ti.select(x * x + y * y <= reach2, predators[q + ALIVE], 0.0)
                threat.n += seen
                threat.x += seen * x
                threat.y += seen * y
        return threat

    @ti.func
    def notes_of(p: ti.template(), prey: ti.template(), b, count, me, weights):
        """Let a strategy collect what it needs of its mates beyond flocking."""
        notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
        if ti.static(bool(p.strategy.notes)):
            first = see.mate_at(prey, b * count * prey_rows, 0)
            second = see.mate_at(prey, (b * count + ti.min(1, count - 1)) * prey_rows, 1)
            for j in range(count):
                p.strategy.observe(notes, me, see.mate_at(prey, (b * count + j) * prey_rows, j), first, second, weights)
        return notes

    @ti.func
    def memory_of(p: ti.template(), prey: ti.template(), a):
        return p.Memory(*[prey[a + row] for row in ti.static(p.memory_rows or [X])])

    flock_prey, flock_predators = flocks("prey"), flocks("predators")
    turn_prey, turn_predators = turns("prey"), turns("predators")

    @ti.func
    def commit(agents: ti.template(), b, count, rows: ti.template()):
        """Take the next state over; those who are gone stay where they went, at finite places."""
        for i in range(count):
            a = (b * count + i) * rows
            here = agents[a + ALIVE] > 0.5
            agents[a + X] = ti.select(here, agents[a + NEXT_X], agents[a + X])
            agents[a + Y] = ti.select(here, agents[a + NEXT_Y], agents[a + Y])
            agents[a + VX] = agents[a + NEXT_VX]
            agents[a + VY] = agents[a + NEXT_VY]

    @ti.func
    def remember(prey: ti.template(), numbers: ti.template(), b, count):
        """Let strategies update the agents' memory from what was seen in this move."""
        swarm_seen = lanes(0.0)
        for i in range(count):
            a = (b * count + i) * prey_rows
            swarm_seen += prey[a + ALIVE] * prey[a + SEEN]
        for i in range(count):
            a = (b * count + i) * prey_rows
            for p in ti.static(remembering):
                memory = memory_of(p, prey, a)
                p.strategy.remember(memory, prey[a + SEEN], swarm_seen, see.weights_of(p, numbers, b))
                for k in ti.static(range(len(p.memory))):
                    prey[a + p.memory_rows[k]] = ti.static([getattr(memory, name) for name in p.memory])[k]

    @ti.func
    def kicks(threat, prey: ti.template(), numbers: ti.template(), integer: ti.template(), b, i, a, key_low, key_high):
        """Give what strategies add after the cap."""
        x = lanes(0.0)
        y = lanes(0.0)
        for p in ti.static(kicking):
            weights = see.weights_of(p, numbers, b)
            first, second, _, _ = uniform(key_low, key_high, integer[b, TRIAL], STRATEGY, i, integer[b, TICK])
            kick_x, kick_y = p.strategy.kick(threat, see.Dice(a=first, b=second), memory_of(p, prey, a), weights)
            x += weights.on * kick_x
            y += weights.on * kick_y
        return x, y

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
        swarm = swarm_of(prey, b, counts[0], clock[b, AGE])
        target = see.target_of(numbers, b)
        limits = see.limits_of(numbers, b, at.prey)
        for i in range(counts[0]):
            a = (b * counts[0] + i) * prey_rows
            me = see.me_at(prey, a, i, limits)
            threat = threat_to(me, predators, b, counts[1])
            flock_x, flock_y = flock_prey(prey, numbers, b, counts[0], me)
            goal = numbers[n + at.prey.goal]
            x = me.vx + flock_x + goal * (target.x - me.x) + prey[a + FIELD_X]
            y = me.vy + flock_y + goal * (target.y - me.y) + prey[a + FIELD_Y]
            for p in ti.static(strategies):
                weights = see.weights_of(p, numbers, b)
                notes = notes_of(p, prey, b, counts[0], me, weights)
                steer_x, steer_y = p.strategy.steer(me, threat, swarm, notes, memory_of(p, prey, a), weights)
                x += weights.on * steer_x
                y += weights.on * steer_y
            x, y = turn_prey(obstacles, numbers, b, counts[2], me, x, y)
            x, y = capped(x, y, me.max_speed)
            if ti.static(bool(kicking)):
                kick_x, kick_y = kicks(threat, prey, numbers, integer, b, i, a, key_low, key_high)
                x += kick_x
                y += kick_y
            prey[a + SEEN] = threat.n
            prey[a + NEXT_VX] = x
            prey[a + NEXT_VY] = y
            prey[a + NEXT_X] = me.x + x * numbers[n + at.dt]
            prey[a + NEXT_Y] = me.y + y * numbers[n + at.dt]
        commit(prey, b, counts[0], prey_rows)
        if ti.static(bool(remembering)):
            remember(prey, numbers, b, counts[0])

    @ti.func
    def move_predators(
        prey: ti.template(),
        predators: ti.template(),
        obstacles: ti.template(),
        numbers: ti.template(),
        clock: ti.template(),
        b,
        counts,
    ):
        """V += flocking + pursuit + field; turn; cap; p += v dt. The prey have moved already, and none has been removed yet."""
        n = b * width
        quarry = swarm_of(prey, b, counts[0], clock[b, AGE])
        target = see.target_of(numbers, b)
        limits = see.limits_of(numbers, b, at.predators)
        for i in range(counts[1]):
            a = (b * counts[1] + i) * predator_rows
            me = see.me_at(predators, a, i, limits)
            flock_x, flock_y = flock_predators(predators, numbers, b, counts[1], me)
            x = me.vx + flock_x + predators[a + FIELD_X]
            y = me.vy + flock_y + predators[a + FIELD_Y]
            for p in ti.static(pursuits):
                weights = see.weights_of(p, numbers, b)
                pursue_x, pursue_y = p.strategy.pursue(me, quarry, target, weights)
                goal = weights.on * numbers[n + at.predators.goal]
                x += goal * pursue_x
                y += goal * pursue_y
            x, y = turn_predators(obstacles, numbers, b, counts[2], me, x, y)
            x, y = capped(x, y, me.max_speed)
            predators[a + NEXT_VX] = x
            predators[a + NEXT_VY] = y
            predators[a + NEXT_X] = me.x + x * numbers[n + at.dt]
            predators[a + NEXT_Y] = me.y + y * numbers[n + at.dt]
        commit(predators, b, counts[1], predator_rows)

    return SimpleNamespace(move_prey=move_prey, move_predators=move_predators)
