"""Near cells: the senses of large swarms: a block's agents see their neighbours, opponents and obstacles through grids.

The funcs are those of perception.py. Here a crowd is a namespace of a grid's arrays: agents, whole, reals, and order, which
maps numbers to slots where a strategy needs it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics import sight_terms
from tiswarm.dynamics.perception import NeighbourSearch
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.dynamics.vision import BEYOND, Vision
from tiswarm.engine.swarms import crossing, near_obstacles, ranking, slots
from tiswarm.engine.swarms.slots import Slots
from tiswarm.simd.lanes import Bundle, coordinates, place, smaller
from tiswarm.simd.runtime import Func, Types
from tiswarm.strategies.flocking import see_mate


@dataclass(frozen=True)
class CellSearch(NeighbourSearch):
    """The neighbour search through cell lists, and what other loops of large swarms need of it."""

    crosses: Func  # (kind, meet) -> a walk of any block through the agents of a kind
    away_in: Func
    obstacle_of: Func
    me_of: dict[str, Func]
    mate_of: dict[str, Func]


@dataclass(frozen=True)
class Sight:
    """What every walk of large swarms is built of. near: prey, predators, obstacles -> the funcs of their grids."""

    layout: ParameterTable
    types: Types
    see: Views
    near: Any
    slots: dict[str, Slots]

    @property
    def axes(self) -> range:
        """Number the axes of the world."""
        return range(len(self.layout.axes))

    def away_in(self, kind: str) -> Func:
        """Give the func for the way from the agent of a kind in a slot."""
        across, axes = getattr(self.near, kind).across, self.axes

        @ti.func
        def away_from(here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            return [across(here[k] - agents[j][k], k, reals) for k in ti.static(axes)]

        return away_from

    def crosses(self, kind: str, meet: Callable[..., Any]) -> Func:
        """Build a walk of a block of any crowd through the agents of a kind; `meet` as for a grid's own walks."""
        return crossing.build(getattr(self.near, kind), self.types, len(self.axes), meet)


def build(layout: ParameterTable, types: Types, see: Views, near: Any) -> CellSearch:
    """Build the search. away_in: kind -> func that gives the way from its agent in a slot.

    near: prey, predators, obstacles -> the funcs of their grids.
    here: prey, predators, obstacles (crowds), numbers; trial; block, end: slots of who looks; count: prey at the start.
    """
    kinds = ("prey", "predators")
    terms = sight_terms.build(layout, types, see)
    sight = Sight(layout, types, see, near, {kind: slots.build(layout, types, see, kind) for kind in kinds})
    obstacle_of = near_obstacles.build_obstacle(sight)
    blocked, look = near_obstacles.build_avoiding(sight, obstacle_of)
    return CellSearch(
        pull={kind: _gathering(sight, getattr(terms, kind), kind) for kind in kinds},
        heed=_heeding(sight, terms),
        chase=_chasing(sight, terms.predators.vision),
        blocked=blocked,
        look=look,
        crosses=sight.crosses,
        away_in=sight.away_in,
        obstacle_of=obstacle_of,
        me_of={kind: sight.slots[kind].me_of for kind in kinds},
        mate_of={kind: sight.slots[kind].mate_of for kind in kinds},
    )


def _gathering(sight: Sight, own: Any, kind: str) -> Func:
    """Build what sums up the mates in reach, and gives what they add to the velocity. own: the terms of the kind."""
    away_from, mate_of = sight.away_in(kind), sight.slots[kind].mate_of
    nearest2 = ranking.build(sight, own, kind)

    @ti.func
    def meet_mate(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        mate = mate_of(agents, view.whole, j)
        away = away_from(here, agents, j, reals)
        counts = own.counted(view.numbers, 0, view.me, mate, away)
        see_mate(view.mates, mate, away, counts, view.perception2, view.spacing2)

    around = getattr(sight.near, kind).walks(meet_mate).around

    @ti.func
    def pull(mates: ti.template(), here: ti.template(), me: ti.template()):
        """Add all mates in reach to what agents see of their swarm, and give what they add to the velocity."""
        perception2, spacing2 = own.reaches(here.numbers, 0, me)
        if ti.static(own.vision.choosy):
            perception2 = smaller(perception2, nearest2(here, me))
        crowd = here.of(kind)
        view = Bundle(mates=mates, me=me, numbers=here.numbers, whole=crowd.whole, perception2=perception2, spacing2=spacing2)
        p = ti.static(coordinates(me))
        around(view, p, crowd.agents, crowd.whole, crowd.reals, here.trial, here.block, here.end)
        return own.flocked(mates, here.numbers, 0, me)

    return pull


def _observing(sight: Sight, vision: Vision) -> Func:
    """Build the walk that lets prey strategies collect what they need of their mates."""
    layout, see, prey = sight.layout, sight.see, sight.slots["prey"]
    from_prey = sight.away_in("prey")

    @ti.func
    def meet_observed(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        mate = prey.mate_of(agents, view.whole, j)
        away = from_prey(here, agents, j, reals)
        other = prey.other_than(view.me, mate, away)
        for k, p in ti.static(enumerate(layout.parts("prey", "strategy"))):
            if ti.static("observe" in p.own):
                own = see.weights_of(p, view.numbers, 0)
                if ti.static(vision.narrow or vision.choosy):
                    heeded = vision.heeded(view.numbers, 0, view.me, away, view.near2, p.strategy.feels)
                    seen = prey.seen_as(view.me, mate, away, other.alive * heeded)
                    p.strategy.observe(view.notes[k], view.me, seen, away, view.first, view.second, own)
                else:
                    p.strategy.observe(view.notes[k], view.me, other, away, view.first, view.second, own)

    return sight.near.prey.walks(meet_observed).around


def _watching(sight: Sight, terms: Any, watched: bool) -> Func:
    """Build the walk that lets prey, and their strategies, see the predators in sight."""
    layout, see, predators = sight.layout, sight.see, sight.slots["predators"]
    narrow = terms.prey.vision.narrow
    from_predator = sight.away_in("predators")

    @ti.func
    def meet_hunter(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        hunter = predators.mate_of(agents, view.whole, j)
        away = from_predator(here, agents, j, reals)
        alive = terms.prey.vision.in_view(view.numbers, 0, view.me, away)
        if ti.static(watched):
            perception2 = view.me.perception * view.me.perception
            if ti.static(narrow):
                terms.see_hunter(view.threat, predators.seen_as(view.me, hunter, away, alive), away, perception2)
            else:
                terms.see_hunter(view.threat, hunter, away, perception2)
        for k, p in ti.static(enumerate(layout.parts("prey", "strategy"))):
            if ti.static("beware" in p.own):
                weights = see.weights_of(p, view.numbers, 0)
                if ti.static(narrow):
                    p.strategy.beware(view.notes[k], view.me, predators.seen_as(view.me, hunter, away, alive), away, weights)
                else:
                    p.strategy.beware(view.notes[k], view.me, predators.seen(view.me, hunter, away), away, weights)

    return sight.crosses("predators", meet_hunter)


def _heeding(sight: Sight, terms: Any) -> Func:
    """Build what lets prey see predators, and strategies of prey whom they look at."""
    lanes = sight.types.lanes
    layout, see, prey = sight.layout, sight.see, sight.slots["prey"]
    strategies = layout.parts("prey", "strategy")
    observers = [p for p in strategies if "observe" in p.own]
    led = any(p.strategy.leads for p in observers)
    watched = sight_terms.watching(layout)
    heeds = bool(layout.structure.hunted and (watched or any("beware" in p.own for p in strategies)))
    vision, observed = terms.prey.vision, _observing(sight, terms.prey.vision)
    nearest2 = ranking.build(sight, terms.prey, "prey") if vision.choosy else None
    heeded = _watching(sight, terms, watched) if heeds else None

    @ti.func
    def leader(here: ti.template(), number: ti.template()):
        """Give the agent of a number, not alive once it is gone."""
        found = prey.missing()
        slot = here.prey.order[here.trial * here.count + ti.min(number, here.count - 1)]
        if slot >= 0:
            found = prey.mate_of(here.prey.agents, here.prey.whole, slot)
        return found

    @ti.func
    def heed(notes: ti.template(), threat: ti.template(), here: ti.template(), me: ti.template()):
        """Let prey see the predators in sight, and their strategies collect what they need beyond flocking."""
        if ti.static(bool(observers)):
            first = prey.missing()
            second = prey.missing()
            if ti.static(led):
                first = leader(here, 0)
                second = leader(here, 1)
            one = prey.seen(me, first, see.sight(me, first, here.numbers, 0))
            two = prey.seen(me, second, see.sight(me, second, here.numbers, 0))
            near2 = lanes(BEYOND)
            if ti.static(vision.choosy):
                near2 = nearest2(here, me)
            view = Bundle(notes=notes, me=me, numbers=here.numbers, whole=here.prey.whole, first=one, second=two, near2=near2)
            p = ti.static(coordinates(me))
            observed(view, p, here.prey.agents, here.prey.whole, here.prey.reals, here.trial, here.block, here.end)
        if ti.static(heeds):
            view = Bundle(notes=notes, threat=threat, me=me, numbers=here.numbers, whole=here.predators.whole)
            heeded(view, place(me), here.predators, here.trial)

    return heed


def _chasing(sight: Sight, vision: Vision) -> Func:
    """Build what lets a predator strategy look at single prey. vision: the predators'."""
    see, prey = sight.see, sight.slots["prey"]

    @ti.func
    def chase(p: ti.template(), notes: ti.template(), here: ti.template(), me: ti.template(), quarry: ti.template(), weights):
        """Let a predator strategy collect what it needs of single prey: of all of them, one after the other by number."""
        for number in range(here.count):
            slot = here.prey.order[here.trial * here.count + number]
            if slot >= 0:
                each = prey.mate_of(here.prey.agents, here.prey.whole, slot)
                away = see.sight(me, each, here.numbers, 0)
                if ti.static(vision.narrow):
                    alive = vision.in_view(here.numbers, 0, me, away)
                    p.strategy.observe(notes, me, prey.seen_as(me, each, away, alive), away, quarry, weights)
                else:
                    p.strategy.observe(notes, me, prey.seen(me, each, away), away, quarry, weights)

    return chase
