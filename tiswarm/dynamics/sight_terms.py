"""Sight terms: what an agent makes of its mates and of the predators that it sees, whichever way they were found."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics import vision
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.dynamics.vision import Vision
from tiswarm.simd.lanes import NOTHING, dot, motion, place, scaled
from tiswarm.simd.runtime import Func, Types
from tiswarm.strategies.flocking import flock


def watching(layout: ParameterTable) -> bool:
    """Tell whether any prey strategy needs to know which predators are in sight."""
    return layout.structure.hunted and any(p.strategy.watches for p in layout.parts("prey", "strategy"))


@dataclass(frozen=True)
class MateTerms:
    """What one kind of agents makes of its mates."""

    vision: Vision
    counted: Func  # give 1 for a mate that is there, in view, and that all strategies count as one, else 0
    reaches: Func  # give the squares of how far mates are seen, and how near they are pushed away
    flocked: Func  # separation, cohesion and alignment: what the mates in sight add to the velocity
    eased: Func  # give a pull without what strategies that flock by rules of their own do not want


@dataclass(frozen=True)
class SightTerms:
    """What both kinds make of whom they see; every neighbour search has them."""

    prey: MateTerms
    predators: MateTerms
    see_hunter: Func  # add one predator to what a prey sees of them


def build(layout: ParameterTable, types: Types, see: Views) -> SightTerms:
    """Build what both ways of visiting share."""
    at = layout.at
    width = len(layout.paths)

    def terms(kind: str):
        columns = getattr(at, kind)
        choosy = layout.parts(kind, "strategy", "mates")
        loners = [p for p in layout.parts(kind, "strategy") if not p.strategy.flocks]

        sight = vision.build(layout, types, kind)

        @ti.func
        def counted(numbers: ti.template(), b, me: ti.template(), mate: ti.template(), away: ti.template()):
            """Give 1 for a mate that is there, in view, and that all strategies count as one, else 0."""
            counts = types.lanes(1.0) * mate.alive  # which may be one number for all lanes
            if ti.static(sight.narrow):
                counts = counts * sight.in_view(numbers, b, me, away)
            for p in ti.static(choosy):
                weights = see.weights_of(p, numbers, b)
                chosen = p.strategy.mates(me, mate, weights)
                if ti.static(p.part.mixed):  # noqa: SIM108 - a branch at compile time
                    counts = counts * (1.0 - weights.on * (1.0 - chosen))
                else:
                    counts = counts * chosen
            return counts

        @ti.func
        def reaches(numbers: ti.template(), b, me: ti.template()):
            """Give the squares of how far mates are seen, and how near they are pushed away."""
            spacing = ti.min(numbers[b * width + columns.spacing], me.perception)
            return me.perception * me.perception, spacing * spacing

        @ti.func
        def flocked(mates: ti.template(), numbers: ti.template(), b, me: ti.template()):
            """Separation, cohesion and alignment: what the mates in sight add to the velocity.

            The sums hold the agent itself, at no distance: loops have no branch that leaves it out.
            """
            own = counted(numbers, b, me, me, scaled(place(me), 0.0))
            mates.n += -1.0 * own
            for k in ti.static(range(len(layout.axes))):
                motion(mates)[k] += -1.0 * own * motion(me)[k]
            pull = flock(me, mates, me.cohesion, me.separation, me.alignment)
            return eased(pull, numbers, b)

        @ti.func
        def eased(pull: ti.template(), numbers: ti.template(), b):
            """Give a pull without what strategies that flock by rules of their own do not want."""
            for p in ti.static(loners):
                for k in ti.static(range(len(layout.axes))):
                    pull[k] = pull[k] * (1.0 - see.weights_of(p, numbers, b).on)
            return pull

        return MateTerms(vision=sight, counted=counted, reaches=reaches, flocked=flocked, eased=eased)

    @ti.func
    def see_hunter(threat: ti.template(), hunter: ti.template(), away: ti.template(), reach2):
        """Add one predator to what a prey sees of them."""
        seen = (dot(away, away) <= reach2) & (hunter.alive > 0.5)
        threat.n += ti.select(seen, 1.0, NOTHING)
        for k in ti.static(range(len(layout.axes))):
            place(threat)[k] += ti.select(seen, away[k], NOTHING)

    return SightTerms(prey=terms("prey"), predators=terms("predators"), see_hunter=see_hunter)
