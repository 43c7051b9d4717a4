"""Ranking: how far the nearest mates of a block's agents are, found by a walk through their cells before that which sums up."""

from typing import Any

import taichi as ti

from tiswarm.dynamics.vision import ROOM
from tiswarm.simd.lanes import Bundle, coordinates, dot, place, scaled
from tiswarm.simd.runtime import Func


def build(sight: Any, own: Any, kind: str) -> Func:
    """Build what tells how far the nearest mates that count are. sight: near_cells.py's; own: the terms of the kind."""
    away_from, mate_of = sight.away_in(kind), sight.slots[kind].mate_of

    @ti.func
    def meet_ranked(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        away = away_from(here, agents, j, reals)
        counts = own.counted(view.numbers, 0, view.me, mate_of(agents, view.whole, j), away)
        own.vision.rank(view.ranks, dot(away, away), counts, view.perception2)

    around = getattr(sight.near, kind).walks(meet_ranked).around

    @ti.func
    def nearest2(here: ti.template(), me: ti.template()):
        """Give the square of how far the nearest mates that count are."""
        perception2, _ = own.reaches(here.numbers, 0, me)
        ranks = own.vision.ranking(here.numbers, 0, own.counted(here.numbers, 0, me, me, scaled(place(me), 0.0)))
        crowd = here.of(kind)
        view = Bundle(ranks=ranks, me=me, numbers=here.numbers, whole=crowd.whole, perception2=perception2)
        p = ti.static(coordinates(me))
        around(view, p, crowd.agents, crowd.whole, crowd.reals, here.trial, here.block, here.end)
        return ranks[ROOM - 1]

    return nearest2
