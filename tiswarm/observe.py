"""Observe: what terms and strategies see of the world, as structs of lanes read from a block's arrays."""

from types import SimpleNamespace

import taichi as ti

from tiswarm.layout import ALIVE, OBSTACLE_RADIUS, OBSTACLE_ROWS, OBSTACLE_X, OBSTACLE_Y, VX, VY, Layout, X, Y


def build(layout: Layout, types: SimpleNamespace) -> SimpleNamespace:
    """Build the structs and the funcs that fill them.

    The n-th agent of block b begins at row (b * count + n) * rows of its array: one index an agent, its numbers side by
    side. More indices or one array per number cost more instructions to address than the term itself.
    """
    lanes = types.lanes
    at = layout.at
    width = len(layout.paths)

    def struct(names: str, **others):
        return ti.types.struct(**dict.fromkeys(names.split(), lanes), **others)

    see = SimpleNamespace(
        Me=struct("x y vx vy alive radius perception max_speed", number=ti.i32),  # number: 1, 2, ...
        Mate=struct("x y vx vy alive", number=ti.i32),
        Mates=struct("n x y vx vy push_x push_y"),  # see flocking.see_mate
        Threat=struct("n x y"),  # n: predators in sight; x, y: Σ (p - q) over them
        Swarm=struct("n x y vx vy age"),  # alive prey: how many, mean position and velocity; ticks run
        Target=struct("x y radius"),
        Obstacle=struct("x y radius"),
        Course=struct("x y"),  # velocity after all terms, before turn and cap
        Dice=struct("a b"),  # uniform in [0, 1)
        Limits=struct("radius perception max_speed"),
    )

    @ti.func
    def limits_of(numbers: ti.template(), b, columns: ti.template()):
        n = b * width
        return see.Limits(
            radius=numbers[n + columns.radius],
            perception=numbers[n + columns.perception],
            max_speed=numbers[n + columns.max_speed],
        )

    @ti.func
    def me_at(agents: ti.template(), a, i, limits):
        return see.Me(
            x=agents[a + X],
            y=agents[a + Y],
            vx=agents[a + VX],
            vy=agents[a + VY],
            alive=agents[a + ALIVE],
            radius=limits.radius,
            perception=limits.perception,
            max_speed=limits.max_speed,
            number=i + 1,
        )

    @ti.func
    def mate_at(agents: ti.template(), a, i):
        return see.Mate(
            x=agents[a + X], y=agents[a + Y], vx=agents[a + VX], vy=agents[a + VY], alive=agents[a + ALIVE], number=i + 1
        )

    @ti.func
    def obstacle_at(obstacles: ti.template(), b, count, j):
        o = (b * count + j) * OBSTACLE_ROWS
        return see.Obstacle(x=obstacles[o + OBSTACLE_X], y=obstacles[o + OBSTACLE_Y], radius=obstacles[o + OBSTACLE_RADIUS])

    @ti.func
    def target_of(numbers: ti.template(), b):
        n = b * width
        return see.Target(x=numbers[n + at.target.x], y=numbers[n + at.target.y], radius=numbers[n + at.target.radius])

    @ti.func
    def weights_of(p: ti.template(), numbers: ti.template(), b):
        n = b * width
        return p.Weights(*[numbers[n + column] for column in ti.static(p.columns)])

    see.limits_of, see.me_at, see.mate_at, see.obstacle_at = limits_of, me_at, mate_at, obstacle_at
    see.target_of, see.weights_of = target_of, weights_of
    return see
