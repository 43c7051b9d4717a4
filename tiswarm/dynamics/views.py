"""Views: what terms and strategies see of the world, as structs of lanes read from a block's arrays."""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.simd.lanes import coordinates, minus, place, row_of
from tiswarm.simd.runtime import Func, Types
from tiswarm.space import box, box_lanes

FAR = 1e9
"""Where lanes with fewer obstacles than others keep the rest: out of everyone's reach [m]."""


def _itself(_me, other, *_):
    return other


def _its_place(_me, other, _away):
    return coordinates(other)


def _plain(give):
    """Let kernels call a function of Python: it hands on what it is given, and no instruction comes of it."""
    give._is_taichi_function = False
    return give


@dataclass(frozen=True)
class Views:
    """Structs of lanes that terms see, and the funcs that read them."""

    Me: dict[str, Any]  # with what strategies show of their memory; number: 1, 2, ...; odd: 1 where that is odd, else 0
    Mate: dict[str, Any]
    Mates: Any  # see flocking.see_mate
    Threat: Any  # n: predators in sight; x, y: Σ (p - q) over them
    Swarm: Any  # alive prey: how many, mean position and velocity; ticks run
    Obstacle: Any
    Spot: Any  # a place
    Dice: Any  # a, b: uniform in [0, 1)
    me_at: dict[str, Func]
    mate_at: dict[str, Func]
    limits_of: Func
    obstacle_at: Func
    target_of: Func
    weights_of: Func
    sight: Func  # the way to me from what I see: across a periodic edge where that is shorter and sight wraps
    gap: Func  # the way to me from another body, whatever anybody sees
    image: Func  # a copy of something, where it is nearest to me
    spot: Func  # where I see something, from the way to it
    obstacle_seen: Func  # an obstacle where I see it


def _ways(layout: ParameterTable, types: Types, struct_of_obstacle: Any) -> dict[str, Func]:
    """Build the funcs of where an agent sees what: `sight`, `gap`, `image`, `spot` and `obstacle_seen`."""
    at, width, dim = layout.at, len(layout.paths), layout.structure.frame.dim
    periodic = box.wraps(layout.structure.frame.boundary)
    wrap_sight = layout.structure.frame.wrap_sight

    @ti.func
    def away(me: ti.template(), other: ti.template(), numbers: ti.template(), b, wrapped: ti.template()):
        """Give the way from the other to me; where it is wrapped, the shortest of its images in a periodic world."""
        way = [p - q for p, q in ti.static(zip(coordinates(me), coordinates(other), strict=True))]
        if ti.static(wrapped):
            for k in ti.static(range(dim)):
                short = box_lanes.displacement(way[k], numbers[b * width + at.size[k]])
                if ti.static("alive" not in other.keys):  # an obstacle that a trial does not have stays far away
                    short = ti.select(place(other)[k] < 0.5 * FAR, short, way[k])
                way[k] = short
        return way

    @ti.func
    def sight(me: ti.template(), other: ti.template(), numbers: ti.template(), b):
        """Give the way to me from what I see: across a periodic edge where that is shorter and sight wraps."""
        return away(me, other, numbers, b, wrap_sight)

    @ti.func
    def gap(me: ti.template(), other: ti.template(), numbers: ti.template(), b):
        """Give the way to me from another body, whatever anybody sees."""
        return away(me, other, numbers, b, periodic)

    # Of what repeats itself, an agent sees the image that is nearest to it: what a hook is given lies where `away` says, and
    # differences of places mean what they do in an open world. In other worlds these three give what they were given.

    @ti.func
    def image(me: ti.template(), other, numbers: ti.template(), b):
        """Give a copy of something, where it is nearest to me."""
        away = sight(me, other, numbers, b)
        for k in ti.static(range(dim)):
            place(other)[k] = place(me)[k] - away[k]
        return other

    @ti.func
    def spot(me: ti.template(), other: ti.template(), away: ti.template()):  # noqa: ARG001 - as its sister
        """Give where I see something that is `away` from me."""
        return minus(place(me), away)

    @ti.func
    def obstacle_seen(me: ti.template(), obstacle: ti.template(), away: ti.template()):
        """Give an obstacle where I see it."""
        return struct_of_obstacle(*spot(me, obstacle, away), types.lanes(obstacle.radius))

    return {
        "sight": sight,
        "gap": gap,
        "image": image if wrap_sight else _plain(_itself),
        "spot": spot if wrap_sight else _plain(_its_place),
        "obstacle_seen": obstacle_seen if wrap_sight else _plain(_itself),
    }


def build(layout: ParameterTable, types: Types) -> Views:
    """Build the structs and the funcs that fill them.

    The n-th agent of block b begins at row (b * count + n) * rows of its array: one index an agent, its numbers side by
    side. More indices or one array per number cost more instructions to address than the term itself.
    """
    lanes, real = types.lanes, types.real
    at, rows = layout.at, layout.rows
    width = len(layout.paths)
    dim = layout.structure.frame.dim
    target_columns = [*at.target.place, at.target.radius]

    def axes(*names: str) -> list[str]:
        return [name + axis for name in names for axis in "xyz"[:dim]]

    def struct(names: list[str], **others):
        return ti.types.struct(**dict.fromkeys(names, lanes), **others)

    state = axes("", "v")
    limits = ["radius", "perception", "spacing", "max_speed", "cohesion", "separation", "alignment"]
    limits += axes("period_") if layout.structure.frame.wrap_sight else []
    own = {kind: struct([*state, "alive", *limits, *layout.shown(kind)], number=real, odd=real) for kind in layout.agent_rows}
    mates = {kind: struct([*state, "alive", *layout.shown(kind)], number=real, odd=real) for kind in layout.agent_rows}
    limits_struct, target_struct = struct(limits), struct([*axes(""), "radius"])

    @ti.func
    def limits_of(numbers: ti.template(), b, columns: ti.template()):
        n = b * width
        return limits_struct(*[numbers[n + column] for column in ti.static([getattr(columns, name) for name in limits])])

    def sees(kind: str):
        Me, Mate = own[kind], mates[kind]  # noqa: N806 - types
        shown = list(layout.shown(kind).values())
        first = [*rows.place, *rows.motion, rows.alive]
        mate_rows = [*first, *shown]

        @ti.func
        def me_at(agents: ti.template(), a, i, limits: ti.template()):
            return Me(
                *[agents[a + row] for row in ti.static(first)],
                *ti.static([getattr(limits, name) for name in limits.keys]),
                *[agents[a + row] for row in ti.static(shown)],
                ti.cast(i + 1, real),
                ti.cast((i + 1) & 1, real),
            )

        @ti.func
        def mate_at(agents: ti.template(), a, i):
            state = [agents[a + row] for row in ti.static(mate_rows)]
            return Mate(*state, ti.cast(i + 1, real), ti.cast((i + 1) & 1, real))

        return me_at, mate_at

    seen = {kind: sees(kind) for kind in layout.agent_rows}

    @ti.func
    def obstacle_at(obstacles: ti.template(), b, count, j):
        o = row_of(b * count + j, layout.obstacle_rows)
        return target_struct(*[obstacles[o + row] for row in ti.static(range(dim + 1))])

    @ti.func
    def target_of(numbers: ti.template(), b):
        n = b * width
        return target_struct(*[numbers[n + column] for column in ti.static(target_columns)])

    @ti.func
    def weights_of(p: ti.template(), numbers: ti.template(), b):
        n = b * width
        return p.Weights(*[numbers[n + column] for column in ti.static(p.columns)])

    return Views(
        Me=own,
        Mate=mates,
        Mates=struct(["n", *state, *axes("push_")]),
        Threat=struct(["n", *axes("")]),
        Swarm=struct(["n", *state, "age"]),
        Obstacle=target_struct,
        Spot=struct(axes("")),
        Dice=struct(["a", "b"]),
        me_at={kind: me_at for kind, (me_at, _) in seen.items()},
        mate_at={kind: mate_at for kind, (_, mate_at) in seen.items()},
        limits_of=limits_of,
        obstacle_at=obstacle_at,
        target_of=target_of,
        weights_of=weights_of,
        **_ways(layout, types, target_struct),
    )
