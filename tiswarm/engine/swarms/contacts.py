"""Contacts: who of large swarms dies and arrives, and what the obstacles' fields do; the rules are dynamics/contact.py's."""

from types import SimpleNamespace

import taichi as ti

from tiswarm.dynamics.table import ARRIVED, CAPTURED, CRASHED, Layout
from tiswarm.engine.swarms import transfer
from tiswarm.engine.swarms.kernels import MOVED
from tiswarm.engine.swarms.transfer import LOOP, share_of
from tiswarm.simd.lanes import Together, anywhere, dot, larger, place, safe
from tiswarm.simd.lanes import near as within
from tiswarm.simd.runtime import LANES, TASK
from tiswarm.space.cells import CELLS, HEAD, SLOTS, TRIALS


def build(
    layout: Layout, types: SimpleNamespace, see: SimpleNamespace, senses: SimpleNamespace, near: SimpleNamespace
) -> SimpleNamespace:
    """Build the kernel `judge`, and `cull` (kind -> kernel), which takes the dead out of the cells."""
    lanes, real = types.lanes, types.real
    dim, rows, frame = len(layout.axes), layout.rows, layout.structure.frame
    hunted = layout.structure.hunted
    at = layout.at
    carried = {kind: transfer.build(layout, types, see, senses, kind, True) for kind in ("prey", "predators")}
    deep = transfer.scratch_rows(layout)
    flat = types.lane_array(1)
    cold_array = ti.types.ndarray(dtype=real, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)
    from_obstacle = senses.away_in("obstacles")

    def obstacle_walk(kind: str):
        fields = layout.parts(kind, "avoidance", "field")

        @ti.func
        def meet_obstacle(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            obstacle = senses.obstacle_of(agents, j)
            away = from_obstacle(here, agents, j, reals)
            distance2 = dot(away, away)
            size = view.me.radius + obstacle.radius
            view.found[0] += ti.select(distance2 < size * size, 1.0, 0.0)
            for p in ti.static(fields):
                weights = see.weights_of(p, view.numbers, 0)
                reach = larger(obstacle.radius + p.strategy.reach(weights), 0.0)
                inside = distance2 <= reach * reach
                if anywhere(inside):
                    push = p.strategy.field(away, safe(distance2), view.me, obstacle, view.target, weights)
                    share = ti.select(inside, weights.on, 0.0)
                    for k in ti.static(range(dim)):
                        view.pull[k] += share * push[k]

        return senses.crosses("obstacles", meet_obstacle)

    def opponent_walk(kind: str):
        """Build the walk of agents through those of the other kind: what touches them, unless an obstacle has killed it."""
        from_other, other = senses.away_in(kind), carried[kind]

        @ti.func
        def meet_opponent(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            away = from_other(here, agents, j, reals)
            touch = dot(away, away) < view.reach2
            if anywhere(touch):
                whom = view.trial * view.count + other.number_in(view.crowd.whole, j)
                alive = view.crowd.cold[whom * other.wide]
                view.found[0] = larger(view.found[0], ti.select(touch, alive, 0.0))

        return senses.crosses(kind, meet_opponent)

    @ti.func
    def reached(me: ti.template(), target: ti.template(), numbers: ti.template(), depth):
        inside = lanes(0.0)
        if ti.static(frame.targeted):
            way = see.gap(me, target, numbers, 0)
            inside = within(dot(way, way), depth)
        return inside

    @ti.func
    def die(scratch: ti.template(), a, dies, fate: ti.template()):
        scratch[a + rows.alive] = ti.select(dies > 0.5, 0.0, scratch[a + rows.alive])
        scratch[a + rows.fate] = ti.select(dies > 0.5, float(fate), scratch[a + rows.fate])

    def crashes(kind: str):
        ferry, walk, alive_end = carried[kind], obstacle_walk(kind), getattr(near, kind).alive_end
        field = bool(layout.parts(kind, "avoidance", "field"))

        @ti.func
        def crash(
            crowd: ti.template(),
            obstacles: ti.template(),
            scratch: ti.template(),
            a,
            numbers: ti.template(),
            block,
            count,
            moved,
        ):
            """Let obstacles, and for predators the target, kill a block's agents; keep what fields add to their velocity."""
            trial = block * LANES // crowd.whole[SLOTS]
            end = ti.min((block + 1) * LANES, alive_end(crowd.whole, trial))
            if end > block * LANES:
                me, _ = ferry.load(scratch, a, crowd, numbers, count, block, end)
                scratch[a + rows.alive] = lanes(1.0)
                target = see.target_of(numbers, 0)
                found = [lanes(0.0)]
                pull = [lanes(0.0) for _ in ti.static(range(dim))]
                view = Together(found=found, pull=pull, me=me, numbers=numbers, target=target)
                walk(view, place(me), obstacles, trial)
                touched = ti.select(found[0] > 0.5, lanes(moved), 0.0)
                if ti.static(field):
                    for k in ti.static(range(dim)):
                        scratch[a + rows.field[k]] = pull[k]
                if ti.static(frame.counts_hits):
                    scratch[a + rows.hit] = larger(scratch[a + rows.hit], touched)
                elif ti.static(kind == "predators"):
                    die(scratch, a, ti.max(touched, moved * reached(me, target, numbers, target.radius)), CRASHED)
                else:
                    die(scratch, a, touched, CRASHED)
                ferry.save_rows(scratch, a, crowd, count, block, end)

        return crash

    def touches(kind: str, opponents: str):
        ferry, walk, alive_end = carried[kind], opponent_walk(opponents), getattr(near, kind).alive_end

        @ti.func
        def touch(
            crowd: ti.template(),
            others: ti.template(),
            scratch: ti.template(),
            a,
            numbers: ti.template(),
            block,
            count,
            other_count,
            moved,
            marks: ti.template(),
        ):
            """Mark who of a block touches an opponent that is alive; all are judged on the same lists."""
            trial = block * LANES // crowd.whole[SLOTS]
            end = ti.min((block + 1) * LANES, alive_end(crowd.whole, trial))
            if end > block * LANES:
                me, _ = ferry.load(scratch, a, crowd, numbers, count, block, end)
                found = [lanes(0.0)]
                reach = numbers[at.prey.radius] + numbers[at.predators.radius]
                view = Together(found=found, crowd=others, reach2=reach * reach, trial=trial, count=other_count)
                walk(view, place(me), others, trial)
                hit = moved * scratch[a + rows.alive] * found[0]
                for lane in ti.static(range(LANES)):
                    if block * LANES + lane < end:
                        marks[block * LANES + lane] = hit[lane]

        return touch

    crash_prey, crash_predators = crashes("prey"), crashes("predators")
    touch_predators = touches("prey", "predators") if hunted else None
    touch_prey = touches("predators", "prey") if hunted else None

    @ti.func
    def settle_prey(
        prey: ti.template(),
        scratch: ti.template(),
        a,
        numbers: ti.template(),
        block,
        count,
        moved,
        marks: ti.template(),
        tally: ti.template(),
    ):
        """Let marked prey die and the others arrive; count for each block who is alive, arrived, captured and crashed."""
        trial = block * LANES // prey.whole[SLOTS]
        end = ti.min((block + 1) * LANES, near.prey.alive_end(prey.whole, trial))
        for k in ti.static(range(4)):
            tally[block * 4 + k] = 0
        if end > block * LANES:
            me, _ = carried["prey"].load(scratch, a, prey, numbers, count, block, end)
            was = scratch[a + rows.alive]
            captured = was * lanes([marks[block * LANES + lane] for lane in ti.static(range(LANES))])
            die(scratch, a, captured, CAPTURED)
            target = see.target_of(numbers, 0)
            depth = larger(target.radius - numbers[at.prey.radius], 0.0)
            arrived = moved * scratch[a + rows.alive] * reached(me, target, numbers, depth)
            die(scratch, a, arrived, ARRIVED)
            alive = scratch[a + rows.alive]
            for lane in ti.static(range(LANES)):
                if block * LANES + lane < end:
                    tally[block * 4] += ti.cast(alive[lane], ti.i32)
                    tally[block * 4 + 1] += ti.cast(arrived[lane], ti.i32)
                    tally[block * 4 + 2] += ti.cast(captured[lane], ti.i32)
                    tally[block * 4 + 3] += 1 - ti.cast(was[lane], ti.i32)
            carried["prey"].save_rows(scratch, a, prey, count, block, end)

    @ti.func
    def settle_predators(predators: ti.template(), block, count, marks: ti.template()):
        """Let marked predators die."""
        trial = block * LANES // predators.whole[SLOTS]
        wide = carried["predators"].wide
        for slot in range(block * LANES, ti.min((block + 1) * LANES, near.predators.alive_end(predators.whole, trial))):
            whom = (trial * count + carried["predators"].number_in(predators.whole, slot)) * wide
            if marks[slot] > 0.5 and predators.cold[whom] > 0.5:
                predators.cold[whom] = real(0.0)
                predators.cold[whom + 1] = float(CAPTURED)

    @ti.kernel
    def judge(
        prey_agents: near.prey.agent_array, prey_whole: whole_array, prey_reals: near.prey.real_array, prey_cold: cold_array,
        predator_agents: near.predators.agent_array, predator_whole: whole_array, predator_reals: near.predators.real_array,
        predator_cold: cold_array,
        obstacle_agents: near.obstacles.agent_array, obstacle_whole: whole_array, obstacle_reals: near.obstacles.real_array,
        scratch: flat, numbers: flat, prey_marks: cold_array, predator_marks: cold_array, tally: whole_array,
        clock: whole_array,
        prey_count: ti.i32, predator_count: ti.i32,
    ):  # fmt: skip
        for index in range(LOOP):
            if index % TASK == 0:
                prey = Together(agents=prey_agents, whole=prey_whole, reals=prey_reals, cold=prey_cold)
                predators = Together(agents=predator_agents, whole=predator_whole, reals=predator_reals, cold=predator_cold)
                obstacles = Together(agents=obstacle_agents, whole=obstacle_whole, reals=obstacle_reals)
                chunk = index // TASK
                moved = ti.cast(clock[MOVED], real)
                begin, end = share_of(chunk, prey_whole[SLOTS] * prey_whole[TRIALS] // LANES)
                for block in range(begin, end):
                    crash_prey(prey, obstacles, scratch, chunk * deep, numbers, block, prey_count, moved)
                if ti.static(hunted):
                    begin, end = share_of(chunk, predator_whole[SLOTS] * predator_whole[TRIALS] // LANES)
                    for block in range(begin, end):
                        crash_predators(predators, obstacles, scratch, chunk * deep, numbers, block, predator_count, moved)
        for index in range(LOOP):
            if index % TASK == 0:  # noqa: SIM102 - one branch at run time, one at compile time
                if ti.static(hunted and frame.contact in ("deadly", "eaten")):
                    prey = Together(agents=prey_agents, whole=prey_whole, reals=prey_reals, cold=prey_cold)
                    predators = Together(agents=predator_agents, whole=predator_whole, reals=predator_reals, cold=predator_cold)
                    chunk = index // TASK
                    moved = ti.cast(clock[MOVED], real)
                    begin, end = share_of(chunk, prey_whole[SLOTS] * prey_whole[TRIALS] // LANES)
                    for block in range(begin, end):
                        touch_predators(
                            prey,
                            predators,
                            scratch,
                            chunk * deep,
                            numbers,
                            block,
                            prey_count,
                            predator_count,
                            moved,
                            prey_marks,
                        )
                    begin, end = share_of(chunk, predator_whole[SLOTS] * predator_whole[TRIALS] // LANES)
                    for block in range(begin, end):
                        touch_prey(
                            predators,
                            prey,
                            scratch,
                            chunk * deep,
                            numbers,
                            block,
                            predator_count,
                            prey_count,
                            moved,
                            predator_marks,
                        )
        for index in range(LOOP):
            if index % TASK == 0:
                prey = Together(agents=prey_agents, whole=prey_whole, reals=prey_reals, cold=prey_cold)
                predators = Together(agents=predator_agents, whole=predator_whole, reals=predator_reals, cold=predator_cold)
                chunk = index // TASK
                moved = ti.cast(clock[MOVED], real)
                begin, end = share_of(chunk, prey_whole[SLOTS] * prey_whole[TRIALS] // LANES)
                for block in range(begin, end):
                    settle_prey(
                        prey,
                        scratch,
                        chunk * deep,
                        numbers,
                        block,
                        prey_count,
                        moved,
                        prey_marks,
                        tally,
                    )
                if ti.static(hunted and frame.contact == "deadly"):
                    begin, end = share_of(chunk, predator_whole[SLOTS] * predator_whole[TRIALS] // LANES)
                    for block in range(begin, end):
                        settle_predators(predators, block, predator_count, predator_marks)

    def culls(kind: str):
        funcs, ferry = getattr(near, kind), carried[kind]

        @ti.kernel
        def cull(agents: funcs.agent_array, whole: whole_array, reals: funcs.real_array, cold: cold_array, count: ti.i32):
            """Put agents where the sort expects moved ones; those who are dead lose their place in the table."""
            total = whole[SLOTS] * whole[TRIALS]
            for slot in range(total):
                trial = slot // whole[SLOTS]
                place = whole[CELLS] - 1
                if slot < funcs.alive_end(whole, trial):  # noqa: SIM102 - no row is read past the end
                    if cold[(trial * count + ferry.number_in(whole, slot)) * ferry.wide] > 0.5:
                        place = funcs.place_of(agents[slot], whole, reals)
                whole[HEAD + slot] = trial * whole[CELLS] + place
                whole[HEAD + 2 * total + slot] = whole[HEAD + total + slot]
                agents[total + slot] = agents[slot]

        return cull

    return SimpleNamespace(judge=judge, cull_prey=culls("prey"), cull_predators=culls("predators"))
