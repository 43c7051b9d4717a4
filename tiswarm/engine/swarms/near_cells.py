"""Near cells: the senses of large swarms: eight agents a block see their neighbours, opponents and obstacles through grids.

The funcs are those of perception.py. Here a crowd is a namespace of a grid's arrays: agents, whole, reals, and order, which
maps numbers to slots where a strategy needs it.
"""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics import perception
from tiswarm.dynamics.perception import NeighbourSearch
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import Bundle, coordinates, place, rates
from tiswarm.simd.runtime import LANES, Func, Types
from tiswarm.space.cells import HEAD, REACH_X, SLOTS, TRIALS
from tiswarm.strategies.flocking import see_mate

FAR = 1e15
"""Where lanes wait that do not visit: out of everyone's reach [m]."""


@dataclass(frozen=True)
class Known:
    """How agents of one kind are read."""

    me_of: Func  # give the agents of a block from their scratch rows. number: lanes, counted from 1
    mate_of: Func  # give the agent in a slot
    other_than: Func  # give a mate, where I see it, who is not there in the lane that it is itself
    seen: Func  # give an agent where I see it
    missing: Func


@dataclass(frozen=True)
class CellSearch(NeighbourSearch):
    """The neighbour search through cell lists, and what other loops of large swarms need of it."""

    crosses: Func  # (kind, meet) -> a walk of any block through the agents of a kind
    away_in: Func
    obstacle_of: Func
    me_of: dict[str, Func]
    mate_of: dict[str, Func]


def build(layout: ParameterTable, types: Types, see: Views, near: Any) -> CellSearch:
    """Build gather, flocked, me_of and mate_of (kind -> func), heed, chase, blocked, look and obstacle_of.

    away_in: kind -> func that gives the way from its agent in a slot; crosses: kind, func -> walk through that crowd.

    near: prey, predators, obstacles -> the funcs of their grids.
    here: prey, predators, obstacles (crowds), numbers; trial; block and end of the agents who look, in slots of their crowd;
    count: how many prey a trial starts with.
    """
    lanes, real = types.lanes, types.real
    dim = len(layout.axes)
    terms = perception.build_terms(layout, types, see)
    hunted, watched = layout.structure.hunted, perception.watching(layout)
    observers = [p for p in layout.parts("prey", "strategy") if "observe" in p.own]
    led = any(p.strategy.leads for p in observers)
    bewaring = [p for p in layout.parts("prey", "strategy") if "beware" in p.own]
    Obstacle = ti.types.struct(**dict.fromkeys(see.Obstacle.members, real))  # noqa: N806 - a type

    def knows(kind: str):
        shown = list(layout.shown(kind))
        names = [*see.Mate[kind].members]
        Me = ti.types.struct(**dict.fromkeys(see.Me[kind].members, lanes))  # noqa: N806
        Mate = ti.types.struct(**dict.fromkeys(names, real))  # noqa: N806
        placed = dict.fromkeys("xyz"[:dim], lanes) if layout.structure.frame.wrap_sight else {}  # in each lane where it is seen
        Seen = ti.types.struct(**dict.fromkeys(names, real) | placed)  # noqa: N806
        Other = ti.types.struct(**dict.fromkeys(names, real) | placed | {"alive": lanes})  # noqa: N806
        rows = [*layout.rows.place, *layout.rows.motion, layout.rows.alive]
        shown_rows = list(layout.shown(kind).values())

        @ti.func
        def me_of(scratch: ti.template(), a, limits: ti.template(), number):
            """Give the agents of a block from their scratch rows. number: lanes, counted from 1."""
            odd = number - 2.0 * ti.floor(0.5 * number)
            return Me(
                *[scratch[a + row] for row in ti.static(rows)],
                *ti.static([getattr(limits, name) for name in limits.keys]),
                *[scratch[a + row] for row in ti.static(shown_rows)],
                number,
                odd,
            )

        @ti.func
        def mate_of(agents: ti.template(), whole: ti.template(), j):
            """Give the agent in a slot."""
            number = whole[HEAD + whole[SLOTS] * whole[TRIALS] + j] + 1
            state = [agents[j][k] for k in ti.static(range(2 * dim))]
            told = [agents[j][2 * dim + k] for k in ti.static(range(len(shown)))]
            return Mate(*state, 1.0, *told, ti.cast(number, real), ti.cast(number & 1, real))

        @ti.func
        def other_than(me: ti.template(), mate: ti.template(), away: ti.template()):
            """Give a mate, where I see it, who is not there in the lane that it is itself."""
            told = ti.static([getattr(mate, name) for name in names[2 * dim + 1 :]])
            alive = ti.select(me.number == mate.number, 0.0, lanes(1.0))
            return Other(*see.spot(me, mate, away), *ti.static(rates(mate)), alive, *told)

        @ti.func
        def seen(me: ti.template(), mate: ti.template(), away: ti.template()):
            """Give an agent where I see it."""
            told = ti.static([getattr(mate, name) for name in names[dim:]])
            return Seen(*see.spot(me, mate, away), *told)

        @ti.func
        def missing():
            return Mate(*[real(0.0) for _ in ti.static(names)])

        return Known(me_of=me_of, mate_of=mate_of, other_than=other_than, seen=seen, missing=missing)

    known = {kind: knows(kind) for kind in ("prey", "predators")}

    def away_in(kind: str):
        across = getattr(near, kind).across

        @ti.func
        def away_from(here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            return [across(here[k] - agents[j][k], k, reals) for k in ti.static(range(dim))]

        return away_from

    def crosses(kind: str, meet):
        """Build a walk of a block of any crowd through the agents of a kind; `meet` as for a grid's own walks."""
        funcs = getattr(near, kind)
        box = funcs.walks(meet).box
        hashed = funcs.hashed
        periodic = funcs.periodic

        @ti.func
        def cross(view: ti.template(), p: ti.template(), crowd: ti.template(), trial):
            """Let lanes at p meet all within reach, together where they are close to each other, else one by one."""
            whole = ti.static(crowd.whole)
            first = funcs.cells_of([p[k][0] for k in ti.static(range(dim))], whole, crowd.reals)
            low_x, low_y, low_z = first[0], first[1], first[2]
            high_x, high_y, high_z = first[0], first[1], first[2]
            for lane in ti.static(range(1, LANES)):
                cells = funcs.cells_of([p[k][lane] for k in ti.static(range(dim))], whole, crowd.reals)
                low_x, low_y, low_z = ti.min(low_x, cells[0]), ti.min(low_y, cells[1]), ti.min(low_z, cells[2])
                high_x, high_y, high_z = ti.max(high_x, cells[0]), ti.max(high_y, cells[1]), ti.max(high_z, cells[2])
            spread = ti.Vector([high_x - low_x, high_y - low_y, high_z - low_z])
            close = 1
            for k in ti.static(range(dim)):
                reach = whole[REACH_X + k]
                if spread[k] > 2 * reach + 2:
                    close = 0
                if ti.static(periodic):  # noqa: SIM102 - no cell may be visited twice
                    if spread[k] + 2 * reach >= whole[ti.static(funcs.count_x) + k]:
                        close = 0
                if ti.static(hashed):  # noqa: SIM102 - nor any place in the table
                    if (k > 0 and spread[k] > 0) or (k == 0 and not funcs.fits(whole, low_x, high_x)):
                        close = 0
            if spread[0] + spread[1] + spread[2] == 0:
                close = 1
            for part in range(ti.select(close == 1, 1, LANES)):
                here = [1.0 * p[k] for k in ti.static(range(dim))]
                if close == 0:
                    lane = lanes([float(number) for number in ti.static(range(LANES))])
                    here[0] = ti.select(lane == ti.cast(part, real), p[0], FAR)
                    for lane_of in ti.static(range(LANES)):
                        if lane_of == part:
                            cells = funcs.cells_of([p[k][lane_of] for k in ti.static(range(dim))], whole, crowd.reals)
                            low_x, low_y, low_z = cells[0], cells[1], cells[2]
                            high_x, high_y, high_z = cells[0], cells[1], cells[2]
                reach = ti.Vector([whole[REACH_X], whole[REACH_X + 1], whole[REACH_X + 2]])
                low = ti.Vector([low_x - reach[0], low_y - reach[1], low_z - reach[2]])
                high = ti.Vector([high_x + reach[0], high_y + reach[1], high_z + reach[2]])
                box(view, here, crowd.agents, whole, crowd.reals, trial, low, high)

        return cross

    def gathers(kind: str):
        own, away_from, mate_of = getattr(terms, kind), away_in(kind), known[kind].mate_of

        @ti.func
        def meet_mate(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            mate = mate_of(agents, view.whole, j)
            away = away_from(here, agents, j, reals)
            counts = own.counted(view.numbers, 0, view.me, mate)
            see_mate(view.mates, mate, away, counts, view.perception2, view.spacing2)

        around = getattr(near, kind).walks(meet_mate).around

        @ti.func
        def gather(mates: ti.template(), here: ti.template(), me: ti.template()):
            """Add all mates in reach to what agents see of their swarm, themselves included."""
            perception2, spacing2 = own.reaches(here.numbers, 0, me)
            crowd = here.of(kind)
            view = Bundle(
                mates=mates, me=me, numbers=here.numbers, whole=crowd.whole, perception2=perception2, spacing2=spacing2
            )
            p = ti.static(coordinates(me))
            around(view, p, crowd.agents, crowd.whole, crowd.reals, here.trial, here.block, here.end)

        return gather

    from_prey, from_obstacle = away_in("prey"), away_in("obstacles")

    @ti.func
    def meet_observed(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        mate = known["prey"].mate_of(agents, view.whole, j)
        away = from_prey(here, agents, j, reals)
        other = known["prey"].other_than(view.me, mate, away)
        for k, p in ti.static(enumerate(layout.parts("prey", "strategy"))):
            if ti.static("observe" in p.own):
                weights = see.weights_of(p, view.numbers, 0)
                p.strategy.observe(view.notes[k], view.me, other, away, view.first, view.second, weights)

    observed = near.prey.walks(meet_observed).around

    def hunter_walk():
        from_predator = away_in("predators")

        @ti.func
        def meet_hunter(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            hunter = known["predators"].mate_of(agents, view.whole, j)
            away = from_predator(here, agents, j, reals)
            if ti.static(watched):
                terms.see_hunter(view.threat, hunter, away, view.me.perception * view.me.perception)
            for k, p in ti.static(enumerate(layout.parts("prey", "strategy"))):
                if ti.static("beware" in p.own):
                    seen = known["predators"].seen(view.me, hunter, away)
                    p.strategy.beware(view.notes[k], view.me, seen, away, see.weights_of(p, view.numbers, 0))

        return crosses("predators", meet_hunter)

    heeds = bool(hunted and (watched or bewaring))
    heeded = hunter_walk() if heeds else None

    @ti.func
    def leader(here: ti.template(), number: ti.template()):
        """Give the agent of a number, not alive once it is gone."""
        found = known["prey"].missing()
        slot = here.prey.order[here.trial * here.count + ti.min(number, here.count - 1)]
        if slot >= 0:
            found = known["prey"].mate_of(here.prey.agents, here.prey.whole, slot)
        return found

    @ti.func
    def heed(notes: ti.template(), threat: ti.template(), here: ti.template(), me: ti.template()):
        """Let prey see the predators in sight, and their strategies collect what they need beyond flocking."""
        if ti.static(bool(observers)):
            first = known["prey"].missing()
            second = known["prey"].missing()
            if ti.static(led):
                first = leader(here, 0)
                second = leader(here, 1)
            one = known["prey"].seen(me, first, see.sight(me, first, here.numbers, 0))
            two = known["prey"].seen(me, second, see.sight(me, second, here.numbers, 0))
            view = Bundle(notes=notes, me=me, numbers=here.numbers, whole=here.prey.whole, first=one, second=two)
            p = ti.static(coordinates(me))
            observed(view, p, here.prey.agents, here.prey.whole, here.prey.reals, here.trial, here.block, here.end)
        if ti.static(heeds):
            sight = Bundle(notes=notes, threat=threat, me=me, numbers=here.numbers, whole=here.predators.whole)
            heeded(sight, place(me), here.predators, here.trial)

    @ti.func
    def chase(p: ti.template(), notes: ti.template(), here: ti.template(), me: ti.template(), quarry: ti.template(), weights):
        """Let a predator strategy collect what it needs of single prey: of all of them, one after the other by number."""
        for number in range(here.count):
            slot = here.prey.order[here.trial * here.count + number]
            if slot >= 0:
                each = known["prey"].mate_of(here.prey.agents, here.prey.whole, slot)
                away = see.sight(me, each, here.numbers, 0)
                p.strategy.observe(notes, me, known["prey"].seen(me, each, away), away, quarry, weights)

    @ti.func
    def obstacle_of(agents: ti.template(), j):
        return Obstacle(*[agents[j][k] for k in ti.static(range(dim + 1))])

    def blocks_walk(p: Any):
        @ti.func
        def meet_blocking(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            obstacle = obstacle_of(agents, j)
            away = from_obstacle(here, agents, j, reals)
            seen = see.obstacle_seen(view.me, obstacle, away)
            blocks = p.strategy.blocks(view.me, view.course, away, seen, view.weights)
            view.found[0] += ti.select(here[0] < 0.5 * FAR, blocks, 0.0)

        return crosses("obstacles", meet_blocking)

    def look_walk(p: Any):
        @ti.func
        def meet_looking(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            away = from_obstacle(here, agents, j, reals)
            seen = see.obstacle_seen(view.me, obstacle_of(agents, j), away)
            p.strategy.look(view.notes, view.me, view.course, away, seen, view.weights)

        return crosses("obstacles", meet_looking)

    walks = {"blocks": blocks_walk, "look": look_walk}
    avoiding = {
        (hook, p.part.name): walk(p)
        for kind in ("prey", "predators")
        for hook, walk in walks.items()
        for p in layout.parts(kind, "avoidance", hook)
    }

    @ti.func
    def blocked(p: ti.template(), here: ti.template(), me: ti.template(), course: ti.template(), weights: ti.template()):
        """Count the obstacles that block the course."""
        found = [lanes(0.0)]
        view = Bundle(found=found, me=me, course=course, weights=weights)
        ti.static([avoiding["blocks", p.part.name]])[0](view, place(me), here.obstacles, here.trial)
        return found[0]

    @ti.func
    def look(
        p: ti.template(),
        notes: ti.template(),
        here: ti.template(),
        me: ti.template(),
        course: ti.template(),
        weights: ti.template(),
    ):
        """Let an avoidance note what the obstacles tell about the course."""
        view = Bundle(notes=notes, me=me, course=course, weights=weights)
        ti.static([avoiding["look", p.part.name]])[0](view, place(me), here.obstacles, here.trial)

    return CellSearch(
        gather={kind: gathers(kind) for kind in ("prey", "predators")},
        flocked={"prey": terms.prey.flocked, "predators": terms.predators.flocked},
        heed=heed,
        chase=chase,
        blocked=blocked,
        look=look,
        crosses=crosses,
        away_in=away_in,
        obstacle_of=obstacle_of,
        me_of={kind: known[kind].me_of for kind in known},
        mate_of={kind: known[kind].mate_of for kind in known},
    )
