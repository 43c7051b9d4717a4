"""What a network is told: nearest obstacle and opponent, target and swarm, in the world's axes or in the agent's own frame."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import dot, larger, motion, safe, scaled, unit, vector

NOTES = ("ahead*", "obstacle", "obstacle*", "size", "opponent", "opponent*", "n", "along*")
"""Notes of a network: where ahead is; the nearest obstacle's and opponent's 1/d, 0 for none, and the way to them; the radius of
that obstacle; how many neighbours, and the sum of their velocities."""

FAR_AWAY = 1000.0
"""How far off what is absent is put in the thesis's inputs [m]."""

THERE = 1e16
"""Squared distance beyond which an obstacle is none [m²]."""


@ti.func
def note_obstacle(notes: ti.template(), obstacle, away, reach):
    """Keep the nearest obstacle by its edge. reach: how far edges are seen [m]."""
    distance2 = dot(away, away)
    edge = larger(ti.sqrt(safe(distance2)) - obstacle.radius, 1e-3)
    near = ti.select((distance2 < THERE) & (edge < reach), 1.0 / edge, 0.0)
    closer = near > notes.obstacle
    notes.obstacle = ti.select(closer, near, notes.obstacle)
    notes.size = ti.select(closer, obstacle.radius, notes.size)
    for k in ti.static(range(len(away))):
        vector(notes, "obstacle")[k] = ti.select(closer, -1.0 * away[k], vector(notes, "obstacle")[k])


@ti.func
def note_opponent(notes: ti.template(), opponent, away, reach):
    """Keep the nearest opponent in sight."""
    distance2 = dot(away, away)
    seen = (distance2 <= reach * reach) & (opponent.alive > 0.5)
    near = ti.select(seen, 1.0 / ti.sqrt(safe(distance2)), 0.0)
    closer = near > notes.opponent
    notes.opponent = ti.select(closer, near, notes.opponent)
    for k in ti.static(range(len(away))):
        vector(notes, "opponent")[k] = ti.select(closer, -1.0 * away[k], vector(notes, "opponent")[k])


@ti.func
def note_neighbour(notes: ti.template(), other, away, reach):
    """Count a neighbour in sight, and add up its velocity."""
    near = ti.select(dot(away, away) <= reach * reach, other.alive, 0.0)
    notes.n += near
    for k in ti.static(range(len(away))):
        vector(notes, "along")[k] += near * motion(other)[k]


class Led:
    """What the neural strategies of both sides share: their network, and how they note an obstacle."""

    networked = True
    notes = NOTES

    @dataclass(frozen=True)
    class Weights:
        """The network."""

        network: str = "networks/thesis-gains.npz"  # its file, beside the preset or those that ship

    @staticmethod
    @ti.func
    def notice(notes: ti.template(), me, obstacle, away, weights):  # noqa: ARG004 - as all hooks
        """Note an obstacle of a tick."""
        note_obstacle(notes, obstacle, away, me.perception)


@ti.func
def find_ahead(notes: ti.template(), me, way):
    """Note where ahead is: along the velocity, at rest towards the target, and there along x."""
    ahead, goal = unit(motion(me)), unit(way)
    still = ti.select(dot(ahead, ahead) < 0.5, 1.0, 0.0)
    lost = ti.select(dot(goal, goal) < 0.5, still, 0.0)
    vector(notes, "ahead")[0] = (1.0 - still) * ahead[0] + (still - lost) * goal[0] + lost
    vector(notes, "ahead")[1] = (1.0 - still) * ahead[1] + (still - lost) * goal[1]


@ti.func
def own(notes, x, y):
    """Turn a vector into the agent's frame: ahead and to the left."""
    return [notes.ahead_x * x + notes.ahead_y * y, notes.ahead_x * y - notes.ahead_y * x]


@ti.func
def world(notes, ahead, left):
    """Turn a vector of the agent's frame into the world's."""
    return [notes.ahead_x * ahead - notes.ahead_y * left, notes.ahead_y * ahead + notes.ahead_x * left]


@ti.func
def thesis_inputs(me, way, swarm, notes, dice):
    """Give the ways to target, nearest obstacle, middle of the prey and nearest opponent [m]; a random far place for none."""
    far_x, far_y = FAR_AWAY * (2.0 * dice.a - 1.0), FAR_AWAY * (2.0 * dice.b - 1.0)
    clear, alone = notes.obstacle < 1e-9, notes.opponent < 1e-9
    return [
        way[0],
        way[1],
        ti.select(clear, far_x, notes.obstacle_x),
        ti.select(clear, far_y, notes.obstacle_y),
        swarm.x - me.x,
        swarm.y - me.y,
        ti.select(alone, far_x, notes.opponent_x),
        ti.select(alone, far_y, notes.opponent_y),
    ]


@ti.func
def own_inputs(me, way, swarm, notes, dice):  # noqa: ARG001 - as thesis_inputs
    """Give thirteen numbers of about one, in the agent's own frame, whatever is absent being zero.

    Target and middle of the prey: their direction times d / (d + perception). Nearest obstacle and opponent: their direction
    times 1 - d / perception, zero at the edge of sight. Own speed, that obstacle's radius over perception, neighbours as
    n / (n + 5), and their mean velocity less one's own, over the greatest speed.
    """
    reach, speed = 1.0 / larger(me.perception, 1e-6), 1.0 / larger(me.max_speed, 1e-6)
    gather = [swarm.x - me.x, swarm.y - me.y]
    goal = scaled(way, 1.0 / (ti.sqrt(dot(way, way)) + me.perception))
    middle = scaled(gather, 1.0 / (ti.sqrt(dot(gather, gather)) + me.perception))
    blocked = ti.select(notes.obstacle > 1e-9, 1.0, 0.0)
    wall = unit([notes.obstacle_x, notes.obstacle_y])
    edge = blocked * larger(1.0 - reach / larger(notes.obstacle, 1e-9), 0.0)
    hunted = ti.select(notes.opponent > 1e-9, 1.0, 0.0)
    foe = unit([notes.opponent_x, notes.opponent_y])
    danger = hunted * larger(1.0 - reach / larger(notes.opponent, 1e-9), 0.0)
    company = ti.select(notes.n > 0.5, 1.0, 0.0)
    share = 1.0 / larger(notes.n, 1.0)
    drift = [speed * company * (share * notes.along_x - me.vx), speed * company * (share * notes.along_y - me.vy)]
    first, second = own(notes, goal[0], goal[1]), own(notes, edge * wall[0], edge * wall[1])
    third, fourth = own(notes, middle[0], middle[1]), own(notes, danger * foe[0], danger * foe[1])
    fifth = own(notes, drift[0], drift[1])
    pace = speed * ti.sqrt(dot(motion(me), motion(me)))
    rest = [pace, blocked * reach * notes.size, notes.n / (notes.n + 5.0)]
    return first + second + third + fourth + rest + fifth
