"""Pairs: what mates in sight add to each other's velocity, each pair of a trial met once for both sides.

Both see each other or neither does, at the same distance; so the distance, the tests and the push apart are had once. Cohesion
and alignment share one sum, since both end as a share of the mates in sight: of what each mate lends, `lent`.
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.perception import SightTerms
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import bounded, dot, place, row_of, vector
from tiswarm.simd.runtime import Func, Types
from tiswarm.strategies.flocking import draw_together

# Rows of an agent in `met`: how far it sees, squared, -1 for the gone; mates in sight; and one an axis of Σ lent, Σ push, lent.
REACH2, COUNT, SUMS = range(3)


def height(layout: ParameterTable) -> int:
    """Count the rows that an agent has in `met`."""
    return SUMS + 3 * len(layout.axes) | 1  # odd: see lanes.bounded


def mutual(layout: ParameterTable, kind: str) -> bool:
    """Tell whether agents of a kind flock, all by the same gains, so that what one lends is the same for all."""
    return layout.flocks(kind) and not any(p.strategy.networked for p in layout.parts(kind, "strategy"))


@dataclass(frozen=True)
class Pairs:
    """The sums over pairs of one kind."""

    meet: Func  # sum up all pairs of a block's trials
    pull: Func  # as NeighbourSearch.pull


def build(layout: ParameterTable, types: Types, see: Views, kind: str, own: SightTerms, alone: Func) -> Pairs:
    """Build `meet` and `pull` for a kind; own: what it makes of its mates; alone: `pull` for an agent by itself."""
    lanes, dim = types.lanes, len(layout.axes)
    width, tall = len(layout.paths), height(layout)
    rows, agent_rows, columns = layout.rows, layout.agent_rows[kind], getattr(layout.at, kind)
    lent_sum, push_sum, lent = ([SUMS + dim * k + axis for axis in range(dim)] for k in range(3))
    which = 0 if kind == "prey" else 1
    choosy = bool(layout.parts(kind, "strategy", "mates"))
    wrapping = layout.structure.frame.wrap_sight
    me_at, mate_at = see.me_at[kind], see.mate_at[kind]

    @ti.func
    def first_of(counts, b):
        """Give where a block begins in `met`, which has room for the more numerous kind."""
        return b * ti.max(counts[0], counts[1]) * tall

    @ti.func
    def lend(block: ti.template(), perception2):
        """Write down how far everybody sees and what everybody lends; no pair is met yet.

        lent: alignment v + cohesion p, of which an agent takes cohesion times its own p off at the end. Where sight wraps, the
        way between two is not the difference of their places, and each pair adds it.
        """
        b, count = block.b, block.counts[which]
        agents, numbers, met = ti.static(block.of(kind), block.numbers, block.met)
        first = first_of(block.counts, b)
        cohesion, alignment = numbers[b * width + columns.cohesion], numbers[b * width + columns.alignment]
        for i in range(count):
            a = row_of(b * count + i, agent_rows)
            m = bounded(first + i * tall)
            met[m + REACH2] = ti.select(agents[a + rows.alive] > 0.5, perception2, -1.0)
            for k in ti.static(range(dim)):
                met[m + lent[k]] = alignment * agents[a + rows.motion[k]]
                if ti.static(not wrapping):
                    met[m + lent[k]] = met[m + lent[k]] + cohesion * agents[a + rows.place[k]]

    @ti.func
    def meet(block: ti.template()):
        """Sum up all pairs of a block's trials, an agent with itself included, so that the loop has no branch."""
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
            itself = own.counted(numbers, b, me, me)
            for j in range(count):
                o = bounded(first + j * tall)
                mate = mate_at(agents, row_of(b * count + j, agent_rows), j)
                away = see.sight(me, mate, numbers, b)
                distance2 = dot(away, away)
                near = distance2 <= met[o + REACH2]
                if ti.static(choosy):
                    near = near & (own.counted(numbers, b, me, mate) > 0.5)
                close = near & (distance2 <= spacing2)
                seen += ti.select(near, 1.0, 0.0)
                for k in ti.static(range(dim)):
                    theirs = met[o + lent[k]]
                    if ti.static(wrapping):
                        theirs = theirs - me.cohesion * away[k]
                    drawn[k] += ti.select(near, theirs, 0.0)
                    push[k] += ti.select(close, away[k], 0.0)
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
            if ti.static(not wrapping):
                drawn[k] = drawn[k] - mates.n * me.cohesion * place(me)[k]
        pull = draw_together(me, mates, drawn)
        return own.eased(pull, here.numbers, here.b)

    return Pairs(meet=meet, pull=pull_of)
