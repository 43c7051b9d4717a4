"""Move: what agents see, how they steer, and one step of their motion; all read one snapshot."""

from types import SimpleNamespace

import taichi as ti

from tiswarm.flocking import flock, see_mate
from tiswarm.lanes import capped
from tiswarm.layout import (
    AGE,
    ALIVE,
    FIELD_X,
    FIELD_Y,
    NEXT_VX,
    NEXT_VY,
    NEXT_X,
    NEXT_Y,
    OBSTACLE_RADIUS,
    OBSTACLE_ROWS,
    OBSTACLE_X,
    OBSTACLE_Y,
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


def structs(types: SimpleNamespace) -> SimpleNamespace:
    """Build what hooks see of the world, in lanes (numbers of agents are the same in every lane)."""
    lanes = types.lanes

    def struct(names: str, **others):
        return ti.types.struct(**dict.fromkeys(names.split(), lanes), **others)

    return SimpleNamespace(
        Me=struct("x y vx vy alive radius perception max_speed", number=ti.i32),
        Mate=struct("x y vx vy alive", number=ti.i32),
        Mates=struct("n x y vx vy push_x push_y"),  # see flocking.see_mate
        Threat=struct("n x y"),  # n: predators in sight; x, y: Σ (p - q) over them
        Swarm=struct("n x y vx vy age"),  # alive prey: how many, mean position and velocity; ticks run
        Target=struct("x y radius"),
        Obstacle=struct("x y radius"),
        Course=struct("x y"),  # velocity after all terms, before turn and cap
        Dice=struct("a b"),  # uniform in [0, 1)
    )


def build(layout: Layout, types: SimpleNamespace, structs: SimpleNamespace, uniform) -> SimpleNamespace:
    """Build `move_prey` and `move_predators` for a structure."""
    lanes = types.lanes
    at = layout.at
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
    strategies = layout.parts("prey", "strategy")
    pursuits = layout.parts("predators", "strategy")
    remembering = [p for p in strategies if p.memory]
    watching = layout.structure.hunted and any(p.strategy.watches for p in strategies)

    @ti.func
    def agent(agents: ti.template(), r, i):
        return structs.Mate(
            x=agents[r + X, i],
            y=agents[r + Y, i],
            vx=agents[r + VX, i],
            vy=agents[r + VY, i],
            alive=agents[r + ALIVE, i],
            number=i + 1,
        )

    def flocks(kind: str):
        columns, rows = getattr(at, kind), layout.agent_rows[kind]
        choosy = layout.parts(kind, "strategy", "mates")

        @ti.func
        def steer_by_mates(agents: ti.template(), numbers: ti.template(), b, count, me):
            """Separation, cohesion and alignment: what the mates in sight add to the velocity."""
            r = b * rows
            reach = numbers[b, columns.perception]
            spacing = ti.min(numbers[b, columns.spacing], reach)
            perception2 = reach * reach
            spacing2 = spacing * spacing
            mates = structs.Mates(*[lanes(0.0) for _ in ti.static(range(7))])
            for j in range(count):
                mate = agent(agents, r, j)
                counts = mate.alive
                for p in ti.static(choosy):
                    weights = p.Weights(*[numbers[b, column] for column in ti.static(p.columns)])
                    chosen = p.strategy.mates(me, mate, weights)
                    if ti.static(p.part.mixed):
                        counts = counts * (1.0 - weights.on * (1.0 - chosen))
                    else:
                        counts = counts * chosen
                see_mate(mates, me, mate, counts, perception2, spacing2)
            # The loop has no branch that leaves the agent itself out: its distance is zero, so only these know.
            mates.n += -1.0 * me.alive
            mates.vx += -1.0 * me.alive * me.vx
            mates.vy += -1.0 * me.alive * me.vy
            return flock(me, mates, numbers[b, columns.cohesion], numbers[b, columns.separation], numbers[b, columns.alignment])

        return steer_by_mates

    def turns(kind: str):
        rows = layout.agent_rows[kind]  # noqa: F841
        turning = layout.parts(kind, "avoidance", "blocks")

        @ti.func
        def turned(obstacles: ti.template(), numbers: ti.template(), b, count, me, x, y):
            """Rotate the course once if any obstacle blocks it."""
            o = b * OBSTACLE_ROWS
            for p in ti.static(turning):
                weights = p.Weights(*[numbers[b, column] for column in ti.static(p.columns)])
                course = structs.Course(x=x, y=y)
                blocked = lanes(0.0)
                for j in range(count):
                    obstacle = structs.Obstacle(
                        x=obstacles[o + OBSTACLE_X, j], y=obstacles[o + OBSTACLE_Y, j], radius=obstacles[o + OBSTACLE_RADIUS, j]
                    )
                    blocked = ti.max(blocked, p.strategy.blocks(me, course, obstacle, weights))
                if ti.static(p.part.mixed):
                    blocked = blocked * weights.on
                cosine, sine = p.strategy.turn(weights)
                cosine = 1.0 + blocked * (cosine - 1.0)
                sine = blocked * sine
                x = cosine * course.x - sine * course.y
                y = sine * course.x + cosine * course.y
            return x, y

        return turned

    @ti.func
    def self_of(agents: ti.template(), numbers: ti.template(), b, r, i, columns: ti.template()):
        return structs.Me(
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

    @ti.func
    def target_of(numbers: ti.template(), b):
        return structs.Target(x=numbers[b, at.target.x], y=numbers[b, at.target.y], radius=numbers[b, at.target.radius])

    @ti.func
    def swarm_of(prey: ti.template(), b, count, age):
        """Give the means over the alive prey, zero when there are none."""
        r = b * prey_rows
        swarm = structs.Swarm(n=lanes(0.0), x=lanes(0.0), y=lanes(0.0), vx=lanes(0.0), vy=lanes(0.0), age=age)
        for i in range(count):
            alive = prey[r + ALIVE, i]
            swarm.n += alive
            swarm.x += alive * prey[r + X, i]
            swarm.y += alive * prey[r + Y, i]
            swarm.vx += alive * prey[r + VX, i]
            swarm.vy += alive * prey[r + VY, i]
        share = 1.0 / ti.max(swarm.n, 1.0)
        swarm.x = share * swarm.x
        swarm.y = share * swarm.y
        swarm.vx = share * swarm.vx
        swarm.vy = share * swarm.vy
        return swarm

    @ti.func
    def threat_to(me, predators: ti.template(), b, count):
        h = b * predator_rows
        threat = structs.Threat(n=lanes(0.0), x=lanes(0.0), y=lanes(0.0))
        if ti.static(watching):
            reach2 = me.perception * me.perception
            for j in range(count):
                x = me.x - predators[h + X, j]
                y = me.y - predators[h + Y, j]
                seen = ti.select(x * x + y * y <= reach2, predators[h + ALIVE, j], 0.0)
                threat.n += seen
                threat.x += seen * x
                threat.y += seen * y
        return threat

    @ti.func
    def notes_of(p: ti.template(), prey: ti.template(), b, count, me, weights):
        """Let a strategy collect what it needs of its mates beyond flocking."""
        r = b * prey_rows
        notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
        if ti.static(bool(p.strategy.notes)):
            first = agent(prey, r, 0)
            second = agent(prey, r, ti.min(1, count - 1))
            for j in range(count):
                p.strategy.observe(notes, me, agent(prey, r, j), first, second, weights)
        return notes

    flock_prey, flock_predators = flocks("prey"), flocks("predators")
    turn_prey, turn_predators = turns("prey"), turns("predators")

    @ti.func
    def commit(agents: ti.template(), r, count):
        """Take the next state over; those who are gone stay where they went, at finite places."""
        for i in range(count):
            here = agents[r + ALIVE, i] > 0.5
            agents[r + X, i] = ti.select(here, agents[r + NEXT_X, i], agents[r + X, i])
            agents[r + Y, i] = ti.select(here, agents[r + NEXT_Y, i], agents[r + Y, i])
            agents[r + VX, i] = agents[r + NEXT_VX, i]
            agents[r + VY, i] = agents[r + NEXT_VY, i]

    @ti.func
    def remember(prey: ti.template(), numbers: ti.template(), b, count):
        """Let strategies update the agents' memory from what was seen in this move."""
        r = b * prey_rows
        swarm_seen = lanes(0.0)
        for i in range(count):
            swarm_seen += prey[r + ALIVE, i] * prey[r + SEEN, i]
        for i in range(count):
            for p in ti.static(remembering):
                weights = p.Weights(*[numbers[b, column] for column in ti.static(p.columns)])
                memory = p.Memory(*[prey[r + row, i] for row in ti.static(p.memory_rows)])
                p.strategy.remember(memory, prey[r + SEEN, i], swarm_seen, weights)
                for k in ti.static(range(len(p.memory))):
                    prey[r + p.memory_rows[k], i] = ti.static([getattr(memory, name) for name in p.memory])[k]

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
        r = b * prey_rows
        swarm = swarm_of(prey, b, counts[0], clock[b, AGE])
        target = target_of(numbers, b)
        dt = numbers[b, at.dt]
        for i in range(counts[0]):
            me = self_of(prey, numbers, b, r, i, at.prey)
            threat = threat_to(me, predators, b, counts[1])
            x, y = flock_prey(prey, numbers, b, counts[0], me)
            goal = numbers[b, at.prey.goal]
            x = me.vx + x + goal * (target.x - me.x) + prey[r + FIELD_X, i]
            y = me.vy + y + goal * (target.y - me.y) + prey[r + FIELD_Y, i]
            for p in ti.static(strategies):
                weights = p.Weights(*[numbers[b, column] for column in ti.static(p.columns)])
                memory = p.Memory(*[prey[r + row, i] for row in ti.static(p.memory_rows or [X])])
                notes = notes_of(p, prey, b, counts[0], me, weights)
                steer_x, steer_y = p.strategy.steer(me, threat, swarm, notes, memory, weights)
                if ti.static(p.part.mixed):
                    x += weights.on * steer_x
                    y += weights.on * steer_y
                else:
                    x += steer_x
                    y += steer_y
            x, y = turn_prey(obstacles, numbers, b, counts[2], me, x, y)
            x, y = capped(x, y, me.max_speed)
            for p in ti.static([each for each in strategies if each.strategy.dice]):
                weights = p.Weights(*[numbers[b, column] for column in ti.static(p.columns)])
                memory = p.Memory(*[prey[r + row, i] for row in ti.static(p.memory_rows or [X])])
                dice_a, dice_b, _, _ = uniform(key_low, key_high, integer[b, TRIAL], STRATEGY, i, integer[b, TICK])
                kick_x, kick_y = p.strategy.kick(threat, structs.Dice(a=dice_a, b=dice_b), memory, weights)
                if ti.static(p.part.mixed):
                    x += weights.on * kick_x
                    y += weights.on * kick_y
                else:
                    x += kick_x
                    y += kick_y
            prey[r + SEEN, i] = threat.n
            prey[r + NEXT_VX, i] = x
            prey[r + NEXT_VY, i] = y
            prey[r + NEXT_X, i] = me.x + x * dt
            prey[r + NEXT_Y, i] = me.y + y * dt
        commit(prey, r, counts[0])
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
        r = b * predator_rows
        quarry = swarm_of(prey, b, counts[0], clock[b, AGE])
        target = target_of(numbers, b)
        dt = numbers[b, at.dt]
        for i in range(counts[1]):
            me = self_of(predators, numbers, b, r, i, at.predators)
            x, y = flock_predators(predators, numbers, b, counts[1], me)
            goal = numbers[b, at.predators.goal]
            x = me.vx + x + predators[r + FIELD_X, i]
            y = me.vy + y + predators[r + FIELD_Y, i]
            for p in ti.static(pursuits):
                weights = p.Weights(*[numbers[b, column] for column in ti.static(p.columns)])
                pursue_x, pursue_y = p.strategy.pursue(me, quarry, target, weights)
                if ti.static(p.part.mixed):
                    x += weights.on * goal * pursue_x
                    y += weights.on * goal * pursue_y
                else:
                    x += goal * pursue_x
                    y += goal * pursue_y
            x, y = turn_predators(obstacles, numbers, b, counts[2], me, x, y)
            x, y = capped(x, y, me.max_speed)
            predators[r + NEXT_VX, i] = x
            predators[r + NEXT_VY, i] = y
            predators[r + NEXT_X, i] = me.x + x * dt
            predators[r + NEXT_Y, i] = me.y + y * dt
        commit(predators, r, counts[1])

    return SimpleNamespace(move_prey=move_prey, move_predators=move_predators)
