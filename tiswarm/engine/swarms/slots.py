"""Slots: how the agents of one kind are read, in the slots of their cells or among those of a block."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import rates
from tiswarm.simd.runtime import Func, Types
from tiswarm.space.cells import HEAD, SLOTS, TRIALS


@dataclass(frozen=True)
class Slots:
    """How agents of one kind are read."""

    me_of: Func  # give the agents of a block from their scratch rows. number: lanes, counted from 1
    mate_of: Func  # give the agent in a slot
    other_than: Func  # give a mate, where I see it, who is not there in the lane that it is itself
    seen: Func  # give an agent where I see it
    seen_as: Func  # the same, in each lane as much there as `alive` says
    missing: Func


def build(layout: ParameterTable, types: Types, see: Views, kind: str) -> Slots:
    """Build the readers of a kind, "prey" or "predators"."""
    lanes, real = types.lanes, types.real
    dim = len(layout.axes)
    shown = list(layout.shown(kind))
    names = [*see.Mate[kind].members]
    Me = ti.types.struct(**dict.fromkeys(see.Me[kind].members, lanes))  # noqa: N806 - a type
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
    def seen_as(me: ti.template(), mate: ti.template(), away: ti.template(), alive):
        """Give an agent where I see it, in each lane as much there as `alive` says."""
        told = ti.static([getattr(mate, name) for name in names[2 * dim + 1 :]])
        return Other(*see.spot(me, mate, away), *ti.static(rates(mate)), alive, *told)

    @ti.func
    def other_than(me: ti.template(), mate: ti.template(), away: ti.template()):
        """Give a mate, where I see it, who is not there in the lane that it is itself."""
        return seen_as(me, mate, away, ti.select(me.number == mate.number, 0.0, lanes(1.0)))

    @ti.func
    def seen(me: ti.template(), mate: ti.template(), away: ti.template()):
        """Give an agent where I see it."""
        told = ti.static([getattr(mate, name) for name in names[dim:]])
        return Seen(*see.spot(me, mate, away), *told)

    @ti.func
    def missing():
        return Mate(*[real(0.0) for _ in ti.static(names)])

    return Slots(me_of=me_of, mate_of=mate_of, other_than=other_than, seen=seen, seen_as=seen_as, missing=missing)
