"""Contacts: who of large swarms dies and arrives, and what the obstacles' fields do; the rules are dynamics/contact.py's.

A verdict asks nothing of strategies, so that swarms of many structures share its kernel (compiled.py), which has numbers of
its own, laid out for that. An agent's cold columns begin with those that it knows, and it is told how many there are.
"""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics import contact
from tiswarm.dynamics.rows import CAPTURED
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.engine.swarms import transfer
from tiswarm.engine.swarms.clock import MOVED
from tiswarm.engine.swarms.near_cells import CellSearch
from tiswarm.engine.swarms.transfer import LOOP, share_of
from tiswarm.simd.lanes import Bundle, anywhere, larger, place
from tiswarm.simd.runtime import LANES, TASK, Func, Types
from tiswarm.space.cells import CELLS, HEAD, SLOTS, TRIALS


@dataclass(frozen=True)
class ContactKernels:
    """Kernels that judge a swarm's tick, and the layout of the numbers that they are given."""

    layout: ParameterTable
    judge: Func
    cull_prey: Func
    cull_predators: Func


@dataclass(frozen=True)
class _Parts:
    """What a verdict is made of."""

    layout: ParameterTable
    types: Types
    see: Views
    senses: CellSearch
    near: Any
    rules: contact.ContactRules
    carried: dict[str, Any]  # kind -> what brings its agents into lanes and back


def _end_in(parts: _Parts, kind: str) -> Func:
    alive_end = getattr(parts.near, kind).alive_end

    @ti.func
    def end_of(crowd: ti.template(), block):
        """Give the slot behind the last agent of a block that is there."""
        return ti.min((block + 1) * LANES, alive_end(crowd.whole, block * LANES // crowd.whole[SLOTS]))

    return end_of


def _by_chunk(parts: _Parts, kind: str, judge_block: Func) -> Func:
    """Build what judges all blocks of a chunk of a kind."""
    deep = transfer.scratch_rows(parts.layout)

    @ti.func
    def judge_chunk(crowds: ti.template(), scratch: ti.template(), numbers: ti.template(), chunk, moved):
        crowd = crowds.of(kind)
        begin, end = share_of(chunk, crowd.whole[SLOTS] * crowd.whole[TRIALS] // LANES)
        for block in range(begin, end):
            judge_block(crowds, scratch, chunk * deep, numbers, block, moved)

    return judge_chunk


def _crashes(parts: _Parts, kind: str) -> Func:
    """Build what lets obstacles, and for predators the target, kill a chunk's agents."""
    see, senses, rules = parts.see, parts.senses, parts.rules
    lanes, dim, rows = parts.types.lanes, len(parts.layout.axes), parts.layout.rows
    ferry, end_of = parts.carried[kind], _end_in(parts, kind)
    meet_one, crash = rules.meet_obstacle[kind], rules.crash[kind]
    field = bool(parts.layout.parts(kind, "avoidance", "field"))
    from_obstacle = senses.away_in("obstacles")

    @ti.func
    def meet_obstacle(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        away = from_obstacle(here, agents, j, reals)
        obstacle = senses.obstacle_of(agents, j)
        meet_one(view.touched, view.pull, view.me, view.travel, obstacle, away, view.target, view.numbers, 0)

    walk = senses.crosses("obstacles", meet_obstacle)

    @ti.func
    def crash_block(crowds: ti.template(), scratch: ti.template(), a, numbers: ti.template(), block, moved):
        """Let obstacles, and for predators the target, kill a block's agents; keep what fields add to their velocity."""
        crowd = crowds.of(kind)
        end = end_of(crowd, block)
        if end > block * LANES:
            me, _ = ferry.load(scratch, a, crowd, numbers, crowd.count, block, end)
            target = see.target_of(numbers, 0)
            touched = [lanes(0.0)]
            pull = [lanes(0.0) for _ in ti.static(range(dim))]
            travel = rules.travel_of(scratch, a)
            view = Bundle(touched=touched, pull=pull, me=me, travel=travel, numbers=numbers, target=target)
            walk(view, place(me), crowds.obstacles, block * LANES // crowd.whole[SLOTS])
            if ti.static(field):
                for k in ti.static(range(dim)):
                    scratch[a + rows.field[k]] = pull[k]
            crash(scratch, a, me, touched[0], lanes(moved), target, numbers, 0)
            ferry.save_rows(scratch, a, crowd, crowd.count, block, end)

    return _by_chunk(parts, kind, crash_block)


def _touches(parts: _Parts, kind: str, opponents: str) -> Func:
    """Build what marks agents of a kind that touch an opponent, unless an obstacle has killed one of them."""
    senses, rules, at = parts.senses, parts.rules, parts.layout.at
    lanes, dim, rows = parts.types.lanes, len(parts.layout.axes), parts.layout.rows
    ferry, other, end_of = parts.carried[kind], parts.carried[opponents], _end_in(parts, kind)
    from_other = senses.away_in(opponents)
    came = [other.kept.index(row) for row in rows.travel]

    @ti.func
    def meet_opponent(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        whom = (view.trial * view.crowd.count + other.number_in(view.crowd.whole, j)) * view.crowd.wide
        travel = [1.0 * view.travel[k] for k in ti.static(range(dim))]
        for k, column in ti.static(enumerate(came)):
            travel[k] = travel[k] - view.crowd.cold[whom + column]
        away = from_other(here, agents, j, reals)
        touch = rules.touches(rules.nearest(away, travel, view.numbers, 0), view.reach)
        if anywhere(touch):
            alive = view.crowd.cold[whom]
            view.found[0] = larger(view.found[0], ti.select(touch, alive, 0.0))

    walk = senses.crosses(opponents, meet_opponent)

    @ti.func
    def touch_block(crowds: ti.template(), scratch: ti.template(), a, numbers: ti.template(), block, moved):
        """Mark who of a block touches an opponent that is alive; all are judged on the same lists."""
        crowd = crowds.of(kind)
        trial = block * LANES // crowd.whole[SLOTS]
        end = end_of(crowd, block)
        if end > block * LANES:
            me, _ = ferry.load(scratch, a, crowd, numbers, crowd.count, block, end)
            found = [lanes(0.0)]
            reach = numbers[at.prey.radius] + numbers[at.predators.radius]
            travel = rules.travel_of(scratch, a)
            view = Bundle(found=found, crowd=crowds.of(opponents), travel=travel, numbers=numbers, reach=reach, trial=trial)
            walk(view, place(me), crowds.of(opponents), trial)
            hit = moved * scratch[a + rows.alive] * found[0]
            for lane in range(end - block * LANES):
                crowd.marks[block * LANES + lane] = hit[lane]

    return _by_chunk(parts, kind, touch_block)


def _settles(parts: _Parts) -> Func:
    """Build what lets the marked die and the others arrive, once all are judged."""
    see, rules, lanes, real = parts.see, parts.rules, parts.types.lanes, parts.types.real
    rows, deep = parts.layout.rows, transfer.scratch_rows(parts.layout)
    deadly = parts.layout.structure.hunted and parts.layout.structure.frame.contact == "deadly"
    ferry, other = parts.carried["prey"], parts.carried["predators"]
    prey_end, predators_end = _end_in(parts, "prey"), _end_in(parts, "predators")

    @ti.func
    def settle_prey(prey: ti.template(), scratch: ti.template(), a, numbers: ti.template(), block, moved, tally: ti.template()):
        """Let marked prey die and the others arrive; count for each block who is alive, arrived, captured and crashed."""
        end = prey_end(prey, block)
        for k in ti.static(range(4)):
            tally[block * 4 + k] = 0
        if end > block * LANES:
            me, _ = ferry.load(scratch, a, prey, numbers, prey.count, block, end)
            was = scratch[a + rows.alive]
            captured = was * lanes([prey.marks[block * LANES + lane] for lane in ti.static(range(LANES))])
            rules.die(scratch, a, captured, CAPTURED)
            arrived = rules.arrive(scratch, a, me, lanes(moved), see.target_of(numbers, 0), numbers, 0)
            alive = scratch[a + rows.alive]
            for lane in range(end - block * LANES):
                tally[block * 4] += ti.cast(alive[lane], ti.i32)
                tally[block * 4 + 1] += ti.cast(arrived[lane], ti.i32)
                tally[block * 4 + 2] += ti.cast(captured[lane], ti.i32)
                tally[block * 4 + 3] += 1 - ti.cast(was[lane], ti.i32)
            ferry.save_rows(scratch, a, prey, prey.count, block, end)

    @ti.func
    def settle_predators(predators: ti.template(), block):
        """Let marked predators die."""
        trial = block * LANES // predators.whole[SLOTS]
        for slot in range(block * LANES, predators_end(predators, block)):
            whom = (trial * predators.count + other.number_in(predators.whole, slot)) * predators.wide
            if predators.marks[slot] > 0.5 and predators.cold[whom] > 0.5:
                predators.cold[whom] = real(0.0)
                predators.cold[whom + 1] = float(CAPTURED)

    @ti.func
    def settle_chunk(crowds: ti.template(), scratch: ti.template(), numbers: ti.template(), chunk, moved, tally: ti.template()):
        begin, end = share_of(chunk, crowds.prey.whole[SLOTS] * crowds.prey.whole[TRIALS] // LANES)
        for block in range(begin, end):
            settle_prey(crowds.prey, scratch, chunk * deep, numbers, block, moved, tally)
        if ti.static(deadly):
            begin, end = share_of(chunk, crowds.predators.whole[SLOTS] * crowds.predators.whole[TRIALS] // LANES)
            for block in range(begin, end):
                settle_predators(crowds.predators, block)

    return settle_chunk


def _cull(parts: _Parts, kind: str) -> Func:
    """Build the kernel that takes the dead of a kind out of the cells."""
    funcs, ferry = getattr(parts.near, kind), parts.carried[kind]
    cold_array = ti.types.ndarray(dtype=parts.types.real, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)

    @ti.kernel
    def cull(
        agents: funcs.agent_array, whole: whole_array, reals: funcs.real_array, cold: cold_array,
        count: ti.i32, wide: ti.i32,
    ):  # fmt: skip
        """Put agents where the sort expects moved ones; those who are dead lose their place in the table."""
        total = whole[SLOTS] * whole[TRIALS]
        for slot in range(total):
            trial = slot // whole[SLOTS]
            place = whole[CELLS] - 1
            if slot < funcs.alive_end(whole, trial):  # noqa: SIM102 - no row is read past the end
                if cold[(trial * count + ferry.number_in(whole, slot)) * wide] > 0.5:
                    place = funcs.place_of(agents[slot], whole, reals)
            whole[HEAD + slot] = trial * whole[CELLS] + place
            whole[HEAD + 2 * total + slot] = whole[HEAD + total + slot]
            agents[total + slot] = agents[slot]

    return cull


def build(layout: ParameterTable, types: Types, see: Views, senses: CellSearch, near: Any) -> ContactKernels:
    """Build the kernel `judge`, and `cull` (kind -> kernel), which takes the dead out of the cells.

    A crowd is as in near_cells.py, with `cold`, `wide` (how many numbers it holds of an agent) and
    `count` (how many agents a trial starts with) beside.
    """
    real, frame, hunted = types.real, layout.structure.frame, layout.structure.hunted
    carried = {kind: transfer.build(layout, types, see, senses, kind) for kind in ("prey", "predators")}
    parts = _Parts(layout, types, see, senses, near, contact.build(layout, types, see), carried)
    crash_prey, crash_predators = _crashes(parts, "prey"), _crashes(parts, "predators")
    touch_predators = _touches(parts, "prey", "predators") if hunted else None
    touch_prey = _touches(parts, "predators", "prey") if hunted else None
    settle_chunk = _settles(parts)
    flat = types.lane_array(1)
    cold_array = ti.types.ndarray(dtype=real, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)

    @ti.kernel
    def judge(
        prey_agents: near.prey.agent_array, prey_whole: whole_array, prey_reals: near.prey.real_array, prey_cold: cold_array,
        predator_agents: near.predators.agent_array, predator_whole: whole_array, predator_reals: near.predators.real_array,
        predator_cold: cold_array,
        obstacle_agents: near.obstacles.agent_array, obstacle_whole: whole_array, obstacle_reals: near.obstacles.real_array,
        scratch: flat, numbers: flat, prey_marks: cold_array, predator_marks: cold_array, tally: whole_array,
        clock: whole_array,
        prey_count: ti.i32, predator_count: ti.i32, prey_wide: ti.i32, predator_wide: ti.i32,
    ):  # fmt: skip
        """Obstacles and the target kill, then pairs kill, then prey arrive: a parallel loop each."""
        prey = Bundle(
            agents=prey_agents, whole=prey_whole, reals=prey_reals, cold=prey_cold, count=prey_count, marks=prey_marks,
            wide=prey_wide,
        )  # fmt: skip
        predators = Bundle(
            agents=predator_agents, whole=predator_whole, reals=predator_reals, cold=predator_cold, count=predator_count,
            marks=predator_marks, wide=predator_wide,
        )  # fmt: skip
        obstacles = Bundle(agents=obstacle_agents, whole=obstacle_whole, reals=obstacle_reals)
        crowds = Bundle(prey=prey, predators=predators, obstacles=obstacles)
        for index in range(LOOP):
            if index % TASK == 0:
                moved = ti.cast(clock[MOVED], real)
                crash_prey(crowds, scratch, numbers, index // TASK, moved)
                if ti.static(hunted):
                    crash_predators(crowds, scratch, numbers, index // TASK, moved)
        if ti.static(hunted and frame.contact in ("deadly", "eaten")):
            for index in range(LOOP):
                if index % TASK == 0:
                    moved = ti.cast(clock[MOVED], real)
                    touch_predators(crowds, scratch, numbers, index // TASK, moved)
                    touch_prey(crowds, scratch, numbers, index // TASK, moved)
        for index in range(LOOP):
            if index % TASK == 0:
                settle_chunk(crowds, scratch, numbers, index // TASK, ti.cast(clock[MOVED], real), tally)

    return ContactKernels(layout, judge, cull_prey=_cull(parts, "prey"), cull_predators=_cull(parts, "predators"))
