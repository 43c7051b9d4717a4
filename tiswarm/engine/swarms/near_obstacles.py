"""Near obstacles: what agents of large swarms sense of the obstacles around them, by walks through those near a block."""

from typing import Any

import taichi as ti

from tiswarm.engine.swarms.crossing import FAR
from tiswarm.simd.lanes import Bundle, place
from tiswarm.simd.runtime import Func


def build_obstacle(sight: Any) -> Func:
    """Build what reads an obstacle in a slot. sight: near_cells.Sight."""
    real, members = sight.types.real, len(sight.axes) + 1
    Obstacle = ti.types.struct(**dict.fromkeys(sight.see.Obstacle.members, real))  # noqa: N806 - a type

    @ti.func
    def obstacle_of(agents: ti.template(), j):
        return Obstacle(*[agents[j][k] for k in ti.static(range(members))])

    return obstacle_of


def build_avoiding(sight: Any, obstacle_of: Func) -> tuple[Func, Func]:
    """Build what counts the obstacles that block a course, and what lets an avoidance note more of them."""
    layout, see, lanes = sight.layout, sight.see, sight.types.lanes
    from_obstacle = sight.away_in("obstacles")

    def blocks_walk(p: Any) -> Func:
        @ti.func
        def meet_blocking(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            obstacle = obstacle_of(agents, j)
            away = from_obstacle(here, agents, j, reals)
            seen = see.obstacle_seen(view.me, obstacle, away)
            blocks = p.strategy.blocks(view.me, view.course, away, seen, view.weights)
            view.found[0] += ti.select(here[0] < 0.5 * FAR, blocks, 0.0)

        return sight.crosses("obstacles", meet_blocking)

    def look_walk(p: Any) -> Func:
        @ti.func
        def meet_looking(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
            away = from_obstacle(here, agents, j, reals)
            seen = see.obstacle_seen(view.me, obstacle_of(agents, j), away)
            p.strategy.look(view.notes, view.me, view.course, away, seen, view.weights)

        return sight.crosses("obstacles", meet_looking)

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

    return blocked, look
