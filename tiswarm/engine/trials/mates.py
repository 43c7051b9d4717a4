"""Mates: what all agents of a kind see of their mates in a tick, summed up before any of them moves.

Cohesion and alignment share one sum, as both end as a share of the mates in sight: of what each mate lends, alignment v +
cohesion p, computed once for all who see it; an agent takes n cohesion p of its own off at the end. What follows for an agent,
with its roots and divisions, stands in a loop of its own, so that one agent's overlaps the next one's.
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.sight_terms import MateTerms
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import NOTHING, bounded, dot, place, row_of, scaled, vector
from tiswarm.simd.runtime import Func, Types
from tiswarm.strategies.flocking import draw_together

# Rows of an agent in `met`: how far it is seen, squared, -1 for the gone; mates in sight; an axis each: Σ lent, Σ push, lent.
REACH2, COUNT, SUMS = range(3)


def height(layout: ParameterTable) -> int:
    """Count the rows that an agent has in `met`."""
    return SUMS + 3 * len(layout.axes) | 1  # odd: see lanes.bounded


def lends(layout: ParameterTable, kind: str) -> bool:
    """Tell whether agents of a kind see their mates so.

    All flock by the same gains, ways are differences of places, and how far one sees does not depend on who is nearest.
    """
    frame = layout.structure.frame
    networked = any(p.strategy.networked for p in layout.parts(kind, "strategy"))
    alike = not networked and kind not in layout.commands
    return layout.flocks(kind) and alike and not frame.wrap_sight and kind not in frame.choosy


@dataclass(frozen=True)
class Mates:
    """The sums over the mates of one kind."""

    meet: Func  # sum up what everybody of a block's trials sees
    pull: Func  # as NeighbourSearch.pull


def build(layout: ParameterTable, types: Types, see: Views, kind: str, own: MateTerms, alone: Func) -> Mates:
    """Build `meet` and `pull` for a kind; own: what it makes of its mates; alone: `pull` for an agent by itself."""
    lanes, dim = types.lanes, len(layout.axes)
    width, tall = len(layout.paths), height(layout)
    rows, agent_rows, columns = layout.rows, layout.agent_rows[kind], getattr(layout.at, kind)
    lent_sum, push_sum, lent = ([SUMS + dim * k + axis for axis in range(dim)] for k in range(3))
    which = 0 if kind == "prey" else 1
    picky = own.vision.narrow or bool(layout.parts(kind, "strategy", "mates"))
    me_at, mate_at = see.me_at[kind], see.mate_at[kind]

    @ti.func
    def first_of(counts, b):
        """Give where a block begins in `met`, which has room for the more numerous kind."""
        return b * ti.max(counts[0], counts[1]) * tall

    @ti.func
    def lend(block: ti.template(), perception2):
        """Write down how far everybody sees, and what everybody lends."""
        b, count = block.b, block.counts[which]
        agents, numbers, met = ti.static(block.of(kind), block.numbers, block.met)
        first = first_of(block.counts, b)
        cohesion, alignment = numbers[b * width + columns.cohesion], numbers[b * width + columns.alignment]
        for i in range(count):
            a = row_of(b * count + i, agent_rows)
            m = bounded(first + i * tall)
            met[m + REACH2] = ti.select(agents[a + rows.alive] > 0.5, perception2, -1.0)
            for k in ti.static(range(dim)):
                met[m + lent[k]] = alignment * agents[a + rows.motion[k]] + cohesion * agents[a + rows.place[k]]

    @ti.func
    def meet(block: ti.template()):
        """Sum up what everybody of a block's trials sees: itself too, for want of a branch, and taken off again."""
        b, count = block.b, block.counts[which]
        agents, numbers, met = ti.static(block.of(kind), block.numbers, block.met)
        first = first_of(block.counts, b)
        limits = see.limits_of(numbers, b, columns)
        perception2, spacing2 = own.reaches(numbers, b, limits)
        lend(block, perception2)
        for i in range(count):
            me = me_at(agents, row_of(b * count + i, agent_rows), i, limits)
            m = bounded(first + i * tall)
            own_lent = [met[m + row] for row in ti.static(lent)]
            seen = lanes(0.0)
            drawn = [lanes(0.0) for _ in ti.static(range(dim))]
            push = [lanes(0.0) for _ in ti.static(range(dim))]
            itself = own.counted(numbers, b, me, me, scaled(place(me), 0.0))
            for j in range(count):
                o = bounded(first + j * tall)
                mate = mate_at(agents, row_of(b * count + j, agent_rows), j)
                away = see.sight(me, mate, numbers, b)
                distance2 = dot(away, away)
                near = distance2 <= met[o + REACH2]
                if ti.static(picky):
                    near = near & (own.counted(numbers, b, me, mate, away) > 0.5)
                close = near & (distance2 <= spacing2)
                seen += ti.select(near, 1.0, NOTHING)
                for k in ti.static(range(dim)):
                    drawn[k] += ti.select(near, met[o + lent[k]], NOTHING)
                    push[k] += ti.select(close, away[k], NOTHING)
            met[m + COUNT] = seen - itself
            for k in ti.static(range(dim)):
                met[m + lent_sum[k]] = drawn[k] - itself * own_lent[k]
                met[m + push_sum[k]] = push[k]

    @ti.func
    def pull_of(mates: ti.template(), here: ti.template(), me: ti.template()):
        """Give what the mates in sight add to the velocity."""
        met = ti.static(here.met)
        if ti.static(layout.structure.terms):  # who notes terms wants cohesion and alignment apart
            alone(mates, here, me)
        m = bounded(first_of(here.counts, here.b) + here.i * tall)
        mates.n = met[m + COUNT]
        drawn = [met[m + row] for row in ti.static(lent_sum)]
        for k in ti.static(range(dim)):
            vector(mates, "push")[k] = met[m + push_sum[k]]
            drawn[k] = drawn[k] - mates.n * me.cohesion * place(me)[k]
        pull = draw_together(me, mates, drawn)
        return own.eased(pull, here.numbers, here.b)

    return Mates(meet=meet, pull=pull_of)
