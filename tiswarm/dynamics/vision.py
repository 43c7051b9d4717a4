"""Vision: whom an agent sees of those within reach: nobody behind it (field of view), and the nearest of its mates alone.

A kind that sees all around and heeds all mates in reach has neither, and a kernel no code for it. What an agent does not see
of others has `alive` = 0, as the gone have; obstacles, the target and means over a whole swarm are known wherever they are.
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.scenario.parts import MOST_NEAREST
from tiswarm.simd.lanes import anywhere, dot, larger, motion, smaller
from tiswarm.simd.runtime import Func, Types

ROOM = MOST_NEAREST + 1  # an agent meets itself, too
NONE = -1.0
"""Nearer than anybody: what fills the places of a ranking that has fewer [m²]."""
BEYOND = 1e30
"""Farther than anybody [m²]."""


@dataclass(frozen=True)
class Vision:
    """What one kind sees."""

    narrow: bool  # whether there is anything behind it that it does not see
    choosy: bool  # whether it heeds the nearest mates alone
    in_view: Func  # give 1 where somebody is in the field of view, else 0. away: the way from there to me
    ranking: Func  # give an empty ranking of the nearest, of a trial's number of them. own: whether it ranks itself
    rank: Func  # enter a mate into a ranking; its last place is then the square of how far the nearest are
    heeded: Func  # give 1 where a mate is in view and among the nearest. reach2: a ranking's last place


def build(layout: ParameterTable, types: Types, kind: str) -> Vision:
    """Build the vision of a kind, "prey" or "predators"."""
    lanes = types.lanes
    width, columns, frame = len(layout.paths), getattr(layout.at, kind), layout.structure.frame
    narrow, choosy = kind in frame.narrow, kind in frame.choosy

    @ti.func
    def in_view(numbers: ti.template(), b, me: ti.template(), away: ti.template()):
        """Give 1 where somebody is in the field of view, else 0: w · v >= cos(φ/2) |w| |v|, w the way there, v my velocity.

        Who stands has no behind, and who is where I am is seen.
        """
        seen = lanes(1.0)
        if ti.static(narrow):
            least = numbers[b * width + columns.view]
            ahead = 0.0 - dot(away, motion(me))
            seen = ti.select(ahead >= least * ti.sqrt(dot(away, away) * dot(motion(me), motion(me))), 1.0, 0.0)
        return seen

    @ti.func
    def ranking(numbers: ti.template(), b, own):
        """Give an empty ranking of the nearest, of a trial's number of them. own: 1 where an agent meets itself, too, else 0.

        Places that are left over hold what nobody is nearer than, so that the last place is always that of the last one.
        """
        count = numbers[b * width + columns.nearest] + own
        return [ti.select(count < ROOM - k - 0.5, NONE, lanes(BEYOND)) for k in ti.static(range(ROOM))]

    @ti.func
    def rank(ranks: ti.template(), distance2, counts, reach2):
        """Enter a mate into a ranking if it counts and is within reach."""
        entered = (counts > 0.5) & (distance2 <= reach2) & (distance2 < ranks[ROOM - 1])
        if anywhere(entered):
            moved = ti.select(entered, distance2, BEYOND)
            for k in ti.static(range(ROOM)):
                kept = smaller(ranks[k], moved)
                moved = larger(ranks[k], moved)
                ranks[k] = kept

    @ti.func
    def heeded(numbers: ti.template(), b, me: ti.template(), away: ti.template(), reach2, feels: ti.template()):
        """Give 1 where a mate is in view and among the nearest, or where it is felt: within the spacing."""
        distance2 = dot(away, away)
        seen = ti.select(distance2 <= reach2, in_view(numbers, b, me, away), 0.0)
        if ti.static(feels):
            spacing = numbers[b * width + columns.spacing]
            seen = ti.select(distance2 <= spacing * spacing, 1.0, seen)
        return seen

    return Vision(narrow=narrow, choosy=choosy, in_view=in_view, ranking=ranking, rank=rank, heeded=heeded)
