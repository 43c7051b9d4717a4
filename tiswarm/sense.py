"""Sense: what an agent makes of its mates, its opponents and the obstacles in a tick, before it moves."""

from types import SimpleNamespace

import taichi as ti

from tiswarm.flocking import flock, see_mate
from tiswarm.lanes import dot, larger, motion, place
from tiswarm.layout import Layout


def build(layout: Layout, types: SimpleNamespace, see: SimpleNamespace) -> SimpleNamespace:
    """Build flock, turn and look (kind -> func) and swarm_of, threat_to, notes_of, memory_of."""
    lanes = types.lanes
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
    prey_mate, predator_mate = see.mate_at["prey"], see.mate_at["predators"]
    hunted = layout.structure.hunted
    watching = hunted and any(p.strategy.watches for p in layout.parts("prey", "strategy"))

    def flocks(kind: str):
        columns, own_rows, mate_at = getattr(at, kind), layout.agent_rows[kind], see.mate_at[kind]
        choosy = layout.parts(kind, "strategy", "mates")
        loners = [p for p in layout.parts(kind, "strategy") if not p.strategy.flocks]
        sums = range(1 + 3 * dim)

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
            mates = see.Mates(*[lanes(0.0) for _ in ti.static(sums)])
            for j in range(count):
                mate = mate_at(agents, (b * count + j) * own_rows, j)
                away = see.sight(me, mate, numbers, b)
                see_mate(mates, mate, away, counted(numbers, b, me, mate), perception2, spacing2)
            # The loop has no branch that leaves the agent itself out: its distance is zero, so only these know.
            own = counted(numbers, b, me, me)
            mates.n += -1.0 * own
            for k in ti.static(range(dim)):
                motion(mates)[k] += -1.0 * own * motion(me)[k]
            pull = flock(me, mates, me.cohesion, me.separation, me.alignment)
            for p in ti.static(loners):
                for k in ti.static(range(dim)):
                    pull[k] = pull[k] * (1.0 - see.weights_of(p, numbers, b).on)
            return pull

        @ti.func
        def nothing(agents: ti.template(), numbers: ti.template(), b, count, me):  # noqa: ARG001 - as its twin
            return [lanes(0.0) for _ in ti.static(range(dim))]

        return nothing if any(not p.part.mixed for p in loners) else steer_by_mates

    def turns(kind: str):
        turning = layout.parts(kind, "avoidance", "blocks")

        @ti.func
        def turn(course: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, count, me):
            """Rotate the course once if any obstacle blocks it."""
            for p in ti.static(turning):
                weights = see.weights_of(p, numbers, b)
                blocked = lanes(0.0)
                for j in range(count):
                    obstacle = see.obstacle_at(obstacles, b, count, j)
                    away = see.sight(me, obstacle, numbers, b)
                    blocked += p.strategy.blocks(me, course, away, obstacle, weights)
                cosine, sine = p.strategy.turn(weights)
                rotated = (blocked > 0.5) & (weights.on > 0.5)
                cosine = ti.select(rotated, cosine, 1.0)
                sine = ti.select(rotated, sine, 0.0)
                x, y = course[0], course[1]
                course[0] = cosine * x - sine * y
                course[1] = sine * x + cosine * y

        return turn

    def deflects(kind: str):
        looking = layout.parts(kind, "avoidance", "deflect")

        @ti.func
        def deflect(course: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, count, me, target, dice):
            """Let avoidances change the course after the cap."""
            for p in ti.static(looking):
                weights = see.weights_of(p, numbers, b)
                notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
                for j in range(count):
                    obstacle = see.obstacle_at(obstacles, b, count, j)
                    p.strategy.look(notes, me, course, see.sight(me, obstacle, numbers, b), obstacle, weights)
                other = p.strategy.deflect(me, course, notes, target, dice, weights)
                for k in ti.static(range(dim)):
                    course[k] = ti.select(weights.on > 0.5, other[k], course[k])

        return deflect

    @ti.func
    def swarm_of(prey: ti.template(), b, count, age):
        """Give the means over the alive prey, zero when there are none."""
        swarm = see.Swarm(*[lanes(0.0) for _ in ti.static(range(2 * dim + 1))], age)
        for i in range(count):
            mate = prey_mate(prey, (b * count + i) * prey_rows, i)
            swarm.n += mate.alive
            for k in ti.static(range(dim)):
                place(swarm)[k] += mate.alive * place(mate)[k]
                motion(swarm)[k] += mate.alive * motion(mate)[k]
        share = 1.0 / larger(swarm.n, 1.0)
        for k in ti.static(range(dim)):
            place(swarm)[k] = share * place(swarm)[k]
            motion(swarm)[k] = share * motion(swarm)[k]
        return swarm

    @ti.func
    def threat_to(me, predators: ti.template(), numbers: ti.template(), b, count):
        threat = see.Threat(*[lanes(0.0) for _ in ti.static(range(dim + 1))])
        if ti.static(watching):
            reach2 = me.perception * me.perception
            for j in range(count):
                hunter = predator_mate(predators, (b * count + j) * predator_rows, j)
                away = see.sight(me, hunter, numbers, b)
                seen = ti.select(dot(away, away) <= reach2, hunter.alive, 0.0)
                threat.n += seen
                for k in ti.static(range(dim)):
                    place(threat)[k] += seen * away[k]
        return threat

    @ti.func
    def notes_of_prey(
        p: ti.template(), prey: ti.template(), predators: ti.template(), numbers: ti.template(), b, counts, me, weights
    ):
        """Let a prey strategy collect what it needs of its mates beyond flocking, and of its opponents."""
        notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
        if ti.static("observe" in p.own):
            first = prey_mate(prey, b * counts[0] * prey_rows, 0)
            second = prey_mate(prey, (b * counts[0] + ti.min(1, counts[0] - 1)) * prey_rows, 1)
            for j in range(counts[0]):
                mate = prey_mate(prey, (b * counts[0] + j) * prey_rows, j)
                if j + 1 != me.number:
                    p.strategy.observe(notes, me, mate, see.sight(me, mate, numbers, b), first, second, weights)
        if ti.static(hunted and "beware" in p.own):
            for j in range(counts[1]):
                hunter = predator_mate(predators, (b * counts[1] + j) * predator_rows, j)
                p.strategy.beware(notes, me, hunter, see.sight(me, hunter, numbers, b), weights)
        return notes

    @ti.func
    def notes_of_predator(p: ti.template(), prey: ti.template(), numbers: ti.template(), b, count, me, quarry, weights):
        """Let a predator strategy collect what it needs of single prey."""
        notes = p.Notes(*[lanes(0.0) for _ in ti.static(p.note_names)])
        if ti.static("observe" in p.own):
            for j in range(count):
                each = prey_mate(prey, (b * count + j) * prey_rows, j)
                p.strategy.observe(notes, me, each, see.sight(me, each, numbers, b), quarry, weights)
        return notes

    @ti.func
    def memory_of(p: ti.template(), agents: ti.template(), a):
        return p.Memory(*[agents[a + row] for row in ti.static(p.memory_rows or [rows.place[0]])])

    kinds = ("prey", "predators")
    return SimpleNamespace(
        flock={kind: flocks(kind) for kind in kinds},
        turn={kind: turns(kind) for kind in kinds},
        deflect={kind: deflects(kind) for kind in kinds},
        swarm_of=swarm_of,
        threat_to=threat_to,
        notes_of_prey=notes_of_prey,
        notes_of_predator=notes_of_predator,
        memory_of=memory_of,
    )
