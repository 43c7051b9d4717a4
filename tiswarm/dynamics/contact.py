"""Contact: the rules of who dies, arrives and bounces, for one agent in lanes; whose turn it is, each engine's loops say."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.rows import ARRIVED, CRASHED
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import NOTHING, anywhere, dot, larger, near, rates, safe, smaller, unit
from tiswarm.simd.runtime import Func, Types
from tiswarm.space import box, box_lanes


@dataclass(frozen=True)
class ContactRules:
    """The rules of contact, each for one agent in lanes."""

    meet_obstacle: dict[str, Func]
    crash: dict[str, Func]
    touches: Func
    nearest: Func  # the way between two bodies where a touch is judged
    travel_of: Func
    die: Func  # take an agent out of the trial where `dies` is 1
    arrive: Func
    rebound: Func


@dataclass(frozen=True)
class _Geometry:
    """How two bodies' touch is judged."""

    touches: Func
    nearest: Func
    travel_of: Func


def _geometry(layout: ParameterTable, types: Types) -> _Geometry:
    lanes = types.lanes
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    frame = layout.structure.frame

    @ti.func
    def touches(way: ti.template(), reach):
        """Tell whether two bodies overlap. way: between their centres; reach: the sum of their radii [m]."""
        return dot(way, way) < reach * reach

    @ti.func
    def travel_of(agents: ti.template(), a):
        """Give how far an agent came in the last tick; zeros where nobody asks."""
        way = [lanes(0.0) for _ in ti.static(range(dim))]
        for k, row in ti.static(enumerate(rows.travel)):
            way[k] = agents[a + row]
        return way

    @ti.func
    def nearest(way: ti.template(), travel: ti.template(), numbers: ti.template(), b):
        """Give the way between two bodies where a touch is judged: after the move, or where they came closest in the tick.

        travel: of the one at the end of `way` against the other. Both moved evenly on straight lines from their last places, so
        that the way between them ran from way - travel to way.
        """
        found = [1.0 * way[k] for k in ti.static(range(dim))]
        if ti.static(frame.swept):
            for k in ti.static(range(dim)):
                found[k] = way[k] - 0.5 * travel[k]
                if ti.static(box.wraps(frame.boundary)):
                    found[k] = box_lanes.adjacent(found[k], numbers[b * width + at.size[k]])
            share = larger(smaller(0.0 - dot(found, travel) / safe(dot(travel, travel)), 0.5), -0.5)
            for k in ti.static(range(dim)):
                found[k] += share * travel[k]
        return found

    return _Geometry(touches=touches, nearest=nearest, travel_of=travel_of)


def build(layout: ParameterTable, types: Types, see: Views) -> ContactRules:
    """Build meet_obstacle and crash (kind -> func), touches, nearest, travel_of, die, arrive and rebound.

    Agents are rows of lanes (`layout.rows`) that begin at row `a`; numbers of block `b`. Masks are 1 or 0 in each lane; `moved`
    is 0 for a start that has not moved yet, which is not judged. Judging the same state twice changes nothing the second time.
    """
    lanes = types.lanes
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    frame = layout.structure.frame
    geometry = _geometry(layout, types)
    touches, nearest, travel_of = geometry.touches, geometry.nearest, geometry.travel_of

    @ti.func
    def reached(me: ti.template(), travel: ti.template(), target, numbers: ti.template(), b, depth):
        """Give 1 where an agent's centre is within `depth` of the target's."""
        inside = lanes(0.0)
        if ti.static(frame.targeted):
            way = nearest(see.gap(me, target, numbers, b), travel, numbers, b)
            inside = near(dot(way, way), depth)
        return inside

    @ti.func
    def die(agents: ti.template(), a, dies, fate: ti.template()):
        """Take an agent out of the trial where `dies` is 1."""
        agents[a + rows.alive] = ti.select(dies > 0.5, 0.0, agents[a + rows.alive])
        agents[a + rows.fate] = ti.select(dies > 0.5, float(fate), agents[a + rows.fate])

    def meets_obstacle(kind: str):
        fields = layout.parts(kind, "avoidance", "field")

        @ti.func
        def meet_obstacle(
            touched: ti.template(), pull: ti.template(), me: ti.template(), travel: ti.template(), obstacle: ti.template(),
            away: ti.template(), target: ti.template(), numbers: ti.template(), b,
        ):  # fmt: skip
            """Count an obstacle that an agent touches in touched[0], and add its fields to `pull`: both need the distance."""
            distance2 = dot(away, away)
            touched[0] += ti.select(touches(nearest(away, travel, numbers, b), me.radius + obstacle.radius), 1.0, NOTHING)
            for p in ti.static(fields):
                weights = see.weights_of(p, numbers, b)
                reach = larger(obstacle.radius + p.strategy.reach(weights), 0.0)
                # Who crashed lies where the field is: the dead would keep all lanes in here.
                inside = (distance2 <= reach * reach) & (me.alive > 0.5)
                if anywhere(inside):
                    seen = see.obstacle_seen(me, obstacle, away)
                    goal = see.image(me, target, numbers, b)
                    push = p.strategy.field(away, safe(distance2), me, seen, goal, weights)
                    for k in ti.static(range(dim)):
                        pull[k] += ti.select(inside, weights.on * push[k], NOTHING)

        return meet_obstacle

    @ti.func
    def crash_prey(agents: ti.template(), a, me: ti.template(), touched, moved, target, numbers: ti.template(), b):  # noqa: ARG001
        """Let a prey die of the obstacles it touches, or only note that it did; give 1 where it dies."""
        hit = moved * me.alive * ti.select(touched > 0.5, 1.0, 0.0)
        crashed = lanes(0.0)
        if ti.static(frame.counts_hits):
            agents[a + rows.hit] = larger(agents[a + rows.hit], hit)
        else:
            crashed = hit
            die(agents, a, crashed, CRASHED)
        return crashed

    @ti.func
    def crash_predator(agents: ti.template(), a, me: ti.template(), touched, moved, target, numbers: ti.template(), b):
        """Let a predator die of obstacles and of the target, unless obstacles only count; give 1 where it dies."""
        crashed = lanes(0.0)
        if ti.static(not frame.counts_hits):
            hit = ti.select(touched > 0.5, 1.0, 0.0)
            crashed = moved * me.alive * larger(hit, reached(me, travel_of(agents, a), target, numbers, b, target.radius))
            die(agents, a, crashed, CRASHED)
        return crashed

    @ti.func
    def arrive(agents: ti.template(), a, me: ti.template(), moved, target, numbers: ti.template(), b):
        """Take a prey that lies wholly inside the target out of the trial; give 1 where it arrives."""
        depth = larger(target.radius - numbers[b * width + at.prey.radius], 0.0)
        arrived = moved * agents[a + rows.alive] * reached(me, travel_of(agents, a), target, numbers, b, depth)
        die(agents, a, arrived, ARRIVED)
        return arrived

    @ti.func
    def rebound(me: ti.template(), mate: ti.template(), away: ti.template(), reach):
        """Give what a body loses to another of equal mass that it touches and approaches, and that one gains: [axis], m/s.

        They exchange their velocities along the line of centres, which conserves momentum and kinetic energy.
        """
        line = unit(away)
        apart = [mine - other for mine, other in ti.static(zip(rates(me), rates(mate), strict=True))]
        closing = dot(apart, line)
        touch = touches(away, reach) & (me.alive * mate.alive > 0.5)
        given = ti.select(touch & (closing < 0.0), closing, 0.0)
        return [given * line[k] for k in ti.static(range(dim))]

    return ContactRules(
        meet_obstacle={kind: meets_obstacle(kind) for kind in ("prey", "predators")},
        crash={"prey": crash_prey, "predators": crash_predator},
        **vars(geometry),
        die=die,
        arrive=arrive,
        rebound=rebound,
    )
