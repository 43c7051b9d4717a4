"""Perception: what an agent makes of its mates, its opponents and the obstacles in a tick, before it moves.

`build` visits everybody of a trial, for `kernel.py`; `near_cells.py` has the same funcs for large swarms, which visit
neighbours through grids. Both take `here`, a namespace with the arrays and the place of the agent in them, which tick.py only
hands on.
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics import sight_terms, vision
from tiswarm.dynamics.sight_terms import SightTerms
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import APART, NOTHING, dot, larger, motion, place, row_of, scaled, smaller
from tiswarm.simd.runtime import Func, Types
from tiswarm.space import box_lanes
from tiswarm.strategies.flocking import see_mate


@dataclass(frozen=True)
class NeighbourSearch:
    """Who visits whom: what steering asks of an engine, whichever way that finds neighbours."""

    pull: dict[str, Func]  # give what mates in sight add to the velocity, and note in `mates` what is seen of them
    heed: Func
    chase: Func  # let a predator strategy collect what it needs of single prey
    blocked: Func  # count the obstacles that block the course
    look: Func  # let an avoidance note what the obstacles tell about the course


@dataclass(frozen=True)
class AllPairs(NeighbourSearch):
    """The search that visits everybody of a trial."""

    terms: SightTerms
    notice: Func  # let a network note the obstacles
    swarm_of: Func  # give the means over the alive prey, zero when there are none


def _gathering(layout: ParameterTable, see: Views, terms: SightTerms, kind: str) -> tuple[Func, Func]:
    """Build pull, and how far the nearest mates are that count, for a kind."""
    own_rows, mate_at, own = layout.agent_rows[kind], see.mate_at[kind], getattr(terms, kind)
    place_of_count = 0 if kind == "prey" else 1

    @ti.func
    def nearest2(here: ti.template(), me: ti.template()):
        """Give the square of how far the nearest mates that count are."""
        agents = ti.static(getattr(here, kind))
        count = here.counts[place_of_count]
        perception2, _ = own.reaches(here.numbers, here.b, me)
        itself = own.counted(here.numbers, here.b, me, me, scaled(place(me), 0.0))
        ranks = own.vision.ranking(here.numbers, here.b, itself)
        for j in range(count):
            mate = mate_at(agents, row_of(here.b * count + j, own_rows), j)
            away = see.sight(me, mate, here.numbers, here.b)
            own.vision.rank(ranks, dot(away, away), own.counted(here.numbers, here.b, me, mate, away), perception2)
        return ranks[vision.ROOM - 1]

    @ti.func
    def gather(mates: ti.template(), here: ti.template(), me: ti.template()):
        """Add all mates to what an agent sees of its swarm, itself included."""
        agents = ti.static(getattr(here, kind))
        count = here.counts[place_of_count]
        perception2, spacing2 = own.reaches(here.numbers, here.b, me)
        if ti.static(own.vision.choosy):
            perception2 = smaller(perception2, nearest2(here, me))
        for j in range(count):
            mate = mate_at(agents, row_of(here.b * count + j, own_rows), j)
            away = see.sight(me, mate, here.numbers, here.b)
            see_mate(mates, mate, away, own.counted(here.numbers, here.b, me, mate, away), perception2, spacing2)

    @ti.func
    def pull(mates: ti.template(), here: ti.template(), me: ti.template()):
        """Give what mates in sight add to the velocity."""
        gather(mates, here, me)
        return own.flocked(mates, here.numbers, here.b, me)

    return pull, nearest2


def _heeding(layout: ParameterTable, types: Types, see: Views, terms: SightTerms, nearest_prey2: Func) -> Func:
    """Build what a prey makes of predators and single mates."""
    lanes, prey_sight = types.lanes, terms.prey.vision
    prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
    prey_mate, predator_mate = see.mate_at["prey"], see.mate_at["predators"]
    hunted, watched = layout.structure.hunted, sight_terms.watching(layout)
    observing = bool(layout.parts("prey", "strategy", "observe"))

    @ti.func
    def observe(p: ti.template(), notes: ti.template(), here: ti.template(), me: ti.template(), near2, weights: ti.template()):
        """Let a strategy collect what it needs of single mates."""
        b = here.b
        counts = here.counts
        numbers = ti.static(here.numbers)
        first = see.image(me, prey_mate(here.prey, b * counts[0] * prey_rows, 0), numbers, b)
        last = (b * counts[0] + ti.min(1, counts[0] - 1)) * prey_rows
        second = see.image(me, prey_mate(here.prey, last, 1), numbers, b)
        for j in range(counts[0]):
            mate = prey_mate(here.prey, row_of(b * counts[0] + j, prey_rows), j)
            if j != here.i:
                away = see.sight(me, mate, numbers, b)
                seen = see.image(me, mate, numbers, b)
                if ti.static(prey_sight.narrow or prey_sight.choosy):
                    seen.alive = seen.alive * prey_sight.heeded(numbers, b, me, away, near2, p.strategy.feels)
                p.strategy.observe(notes, me, seen, away, first, second, weights)

    @ti.func
    def beware(p: ti.template(), notes: ti.template(), here: ti.template(), me: ti.template(), weights: ti.template()):
        """Let a strategy collect what it needs of single predators."""
        b = here.b
        counts = here.counts
        numbers = ti.static(here.numbers)
        for j in range(counts[1]):
            hunter = predator_mate(here.predators, row_of(b * counts[1] + j, predator_rows), j)
            away = see.sight(me, hunter, numbers, b)
            if ti.static(prey_sight.narrow):
                hunter.alive = hunter.alive * prey_sight.in_view(numbers, b, me, away)
            p.strategy.beware(notes, me, see.image(me, hunter, numbers, b), away, weights)

    @ti.func
    def heed(notes: ti.template(), threat: ti.template(), here: ti.template(), me: ti.template()):
        """Let a prey see the predators in sight, and its strategies collect what they need beyond flocking.

        notes: one struct for each prey strategy of the layout.
        """
        b = here.b
        counts = here.counts
        numbers = ti.static(here.numbers)
        near2 = lanes(vision.BEYOND)
        if ti.static(prey_sight.choosy and observing):
            near2 = nearest_prey2(here, me)
        if ti.static(watched):
            for j in range(counts[1]):
                hunter = predator_mate(here.predators, row_of(b * counts[1] + j, predator_rows), j)
                away = see.sight(me, hunter, numbers, b)
                if ti.static(prey_sight.narrow):
                    hunter.alive = hunter.alive * prey_sight.in_view(numbers, b, me, away)
                terms.see_hunter(threat, hunter, away, me.perception * me.perception)
        for k, p in ti.static(enumerate(layout.parts("prey", "strategy"))):
            if APART:
                weights = see.weights_of(p, numbers, b)
                if ti.static("observe" in p.own):
                    observe(p, notes[k], here, me, near2, weights)
                if ti.static(hunted and "beware" in p.own):
                    beware(p, notes[k], here, me, weights)

    return heed


def _chasing(layout: ParameterTable, see: Views, terms: SightTerms) -> Func:
    prey_rows, prey_mate, predator_sight = layout.agent_rows["prey"], see.mate_at["prey"], terms.predators.vision

    @ti.func
    def chase(p: ti.template(), notes: ti.template(), here: ti.template(), me: ti.template(), quarry: ti.template(), weights):
        """Let a predator strategy collect what it needs of single prey."""
        for j in range(here.counts[0]):
            each = prey_mate(here.prey, row_of(here.b * here.counts[0] + j, prey_rows), j)
            away = see.sight(me, each, here.numbers, here.b)
            if ti.static(predator_sight.narrow):
                each.alive = each.alive * predator_sight.in_view(here.numbers, here.b, me, away)
            p.strategy.observe(notes, me, see.image(me, each, here.numbers, here.b), away, quarry, weights)

    return chase


def _obstacles(types: Types, see: Views) -> tuple[Func, Func, Func]:
    """Build blocked, look and notice."""
    lanes = types.lanes

    @ti.func
    def blocked(p: ti.template(), here: ti.template(), me: ti.template(), course: ti.template(), weights):
        """Count the obstacles that block the course."""
        found = lanes(0.0)
        for j in range(here.counts[2]):
            obstacle = see.obstacle_at(here.obstacles, here.b, here.counts[2], j)
            away = see.sight(me, obstacle, here.numbers, here.b)
            blocks = p.strategy.blocks(me, course, away, see.obstacle_seen(me, obstacle, away), weights)
            found += ti.select(blocks > 0.5, 1.0, NOTHING)
        return found

    @ti.func
    def look(p: ti.template(), notes: ti.template(), here: ti.template(), me: ti.template(), course: ti.template(), weights):
        """Let an avoidance note what the obstacles tell about the course."""
        for j in range(here.counts[2]):
            obstacle = see.obstacle_at(here.obstacles, here.b, here.counts[2], j)
            away = see.sight(me, obstacle, here.numbers, here.b)
            p.strategy.look(notes, me, course, away, see.obstacle_seen(me, obstacle, away), weights)

    @ti.func
    def notice(p: ti.template(), notes: ti.template(), here: ti.template(), me: ti.template(), weights):
        """Let a network note the obstacles."""
        for j in range(here.counts[2]):
            obstacle = see.obstacle_at(here.obstacles, here.b, here.counts[2], j)
            away = see.sight(me, obstacle, here.numbers, here.b)
            p.strategy.notice(notes, me, see.obstacle_seen(me, obstacle, away), away, weights)

    return blocked, look, notice


def _means(layout: ParameterTable, types: Types, see: Views) -> Func:
    lanes, dim, width = types.lanes, len(layout.axes), len(layout.paths)
    prey_rows, prey_mate, wrapping = layout.agent_rows["prey"], see.mate_at["prey"], layout.structure.frame.wrap_sight

    @ti.func
    def swarm_of(prey: ti.template(), numbers: ti.template(), b, count, age):
        """Give the means over the alive prey, zero when there are none.

        Where sight wraps, places are those nearest to the first prey that is alive: a mean about one of its own is the plain
        mean of every swarm less than half a world wide. Means of angles are not, and cost a sine and a cosine an agent.
        """
        origin = [lanes(0.0) for _ in ti.static(range(dim))]
        swarm = see.Swarm(*[lanes(0.0) for _ in ti.static(range(2 * dim + 1))], age)
        for i in range(count):
            mate = prey_mate(prey, row_of(b * count + i, prey_rows), i)
            if ti.static(wrapping):
                first = (mate.alive > 0.5) & (swarm.n < 0.5)
                for k in ti.static(range(dim)):
                    origin[k] = ti.select(first, place(mate)[k], origin[k])
                    place(mate)[k] = box_lanes.displacement(place(mate)[k] - origin[k], numbers[b * width + layout.at.size[k]])
            swarm.n += mate.alive
            for k in ti.static(range(dim)):
                place(swarm)[k] += mate.alive * place(mate)[k]
                motion(swarm)[k] += mate.alive * motion(mate)[k]
        share = 1.0 / larger(swarm.n, 1.0)
        for k in ti.static(range(dim)):
            place(swarm)[k] = share * place(swarm)[k]
            if ti.static(wrapping):
                place(swarm)[k] = origin[k] + place(swarm)[k]
            motion(swarm)[k] = share * motion(swarm)[k]
        return swarm

    return swarm_of


def build(layout: ParameterTable, types: Types, see: Views) -> AllPairs:
    """Build pull (kind -> func), heed, chase, blocked, look and swarm_of.

    here: prey, predators, obstacles, numbers; b: the block, which has room for `counts` agents; i: the agent's place among its
    kind.
    """
    terms = sight_terms.build(layout, types, see)
    ways = {kind: _gathering(layout, see, terms, kind) for kind in ("prey", "predators")}
    blocked, look, notice = _obstacles(types, see)
    return AllPairs(
        pull={kind: pull for kind, (pull, _) in ways.items()},
        heed=_heeding(layout, types, see, terms, ways["prey"][1]),
        chase=_chasing(layout, see, terms),
        blocked=blocked,
        look=look,
        terms=terms,
        notice=notice,
        swarm_of=_means(layout, types, see),
    )
