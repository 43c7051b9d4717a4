"""Barrier: how fast bodies may near each other and walls, and the velocity next to a commanded one that keeps within bounds.

Wang, Ames and Egerstedt, "Safety barrier certificates for collisions-free multirobot systems", IEEE T-RO 2017, in the form of
the Robotarium: of two points x apart with h = |x|² - r², -2 x·(u - u') <= γ h³; of a wall b beyond r/2, n·u <= share γ b³.

A bound of h/dt (b/dt) more holds in both, which makes them true of ticks, too: |x + (u - u') dt|² - r² >= h - dt h/dt = 0.
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.simd.lanes import dot, smaller
from tiswarm.simd.runtime import Func, Types

NO_BOUND = (0.0, 0.0, 1.0)
"""A normal and a bound that every velocity keeps."""

NOWHERE = 1e30
"""The squared distance of a velocity that cannot be taken [m²/s²]."""


def tolerance(types: Types) -> float:
    """Give to what a solution is exact, m²/s for pairs and m/s for walls; sums round to less.

    What is exceeded is solved for bounds that are tighter by twice as much, so that what rounding leaves does not add up in a
    trial to any way nearer than the radius.
    """
    return 1e-6 if types.real == ti.f32 else 1e-12


@dataclass(frozen=True)
class Barrier:
    """The rules of certificates, for whoever visits whom."""

    point_of: Func
    limits_of: Func
    pair_bound: Func
    wall_bound: Func


def build(layout: ParameterTable) -> Barrier:
    """Build the rules. limits: a list of the squared radius, half of it, the gains of pairs and walls, and ticks a second."""
    at, rows, width = layout.at, layout.rows, len(layout.paths)
    wheeled = "prey" in layout.structure.frame.unicycles

    @ti.func
    def point_of(agents: ti.template(), a, numbers: ti.template(), b):
        """Give the point whose velocity is commanded: the agent's place, or ahead of its axle."""
        place = [1.0 * agents[a + row] for row in ti.static(rows.place)]
        if ti.static(wheeled):
            for k in ti.static(range(2)):
                place[k] += numbers[b * width + at.prey.ahead] * agents[a + rows.heading[k]]
        return place

    @ti.func
    def limits_of(numbers: ti.template(), b):
        n = b * width
        radius, gain = numbers[n + at.barrier.radius], numbers[n + at.barrier.gain]
        return [radius * radius, 0.5 * radius, gain, gain * numbers[n + at.barrier.wall_share], 1.0 / numbers[n + at.dt]]

    @ti.func
    def bound_of(off, gain, rate):
        bound = gain * off * off * off
        return ti.select(off > 0.0, smaller(bound, rate * off), bound)

    @ti.func
    def pair_bound(distance2, limits: ti.template()):
        """Give how large -2 x·(u - u') may be [m²/s]."""
        return bound_of(distance2 - limits[0], limits[2], limits[4])

    @ti.func
    def wall_bound(distance, limits: ti.template()):
        """Give how fast a wall may be neared [m/s]."""
        return bound_of(distance - limits[1], limits[3], limits[4])

    return Barrier(point_of=point_of, limits_of=limits_of, pair_bound=pair_bound, wall_bound=wall_bound)


# The velocity nearest to a commanded one that keeps one more bound n·u <= c, with those that held it before, of whom one or two
# are enough to tell: held is a list of both normals and bounds, zeros and ones where there is none. Of the bounds of a plane's
# convex set two at most matter at a point, so that this, repeated with the bound that is exceeded most, ends at the nearest
# point of all: the distance to the command grows each time.


@ti.func
def excess(u: ti.template(), held: ti.template(), k: ti.template()):
    """Give by how much a velocity exceeds the first or second held bound."""
    return u[0] * held[3 * k] + u[1] * held[3 * k + 1] - held[3 * k + 2]


@ti.func
def corner(line: ti.template(), bound, held: ti.template(), k: ti.template()):
    """Give where two bounds meet, and 1 where they do, in one list."""
    across, up, other = held[3 * k], held[3 * k + 1], held[3 * k + 2]
    turn = line[0] * up - line[1] * across
    meets = ti.select(turn * turn > 1e-12, 1.0, 0.0)
    share = 1.0 / ti.select(turn * turn > 1e-12, turn, 1.0)
    return [share * (bound * up - other * line[1]), share * (other * line[0] - bound * across), meets]


@ti.func
def tightened(
    u: ti.template(), command: ti.template(), line: ti.template(), bound, held: ti.template(), exceeded, slack: ti.template()
):
    """Move u, in place, to the velocity nearest to the command that keeps the held bounds and one more, where that is exceeded.

    line: its normal, of length one; exceeded: a mask; slack: what rounding may exceed.
    """
    over = command[0] * line[0] + command[1] * line[1] - bound
    alone = [command[k] - over * line[k] for k in ti.static(range(2))]
    fits = (excess(alone, held, 0) <= slack) & (excess(alone, held, 1) <= slack)
    first, second = corner(line, bound, held, 0), corner(line, bound, held, 1)
    ways = [[p[k] - command[k] for k in ti.static(range(2))] for p in ti.static([first, second])]
    fits_first = (first[2] > 0.5) & (excess(first, held, 1) <= slack)
    fits_second = (second[2] > 0.5) & (excess(second, held, 0) <= slack)
    off = ti.select(fits_first, dot(ways[0], ways[0]), NOWHERE)
    off_second = ti.select(fits_second, dot(ways[1], ways[1]), NOWHERE)
    straight = fits | (smaller(off, off_second) > 0.5 * NOWHERE)  # nothing fits where bodies overlap: this one is kept, then
    nearer = off_second < off
    for k in ti.static(range(2)):
        found = ti.select(straight, alone[k], ti.select(nearer, second[k], first[k]))
        u[k] = ti.select(exceeded, found, u[k])
    new = line + [bound]  # noqa: RUF005 - Taichi knows no stars in lists
    for k in ti.static(range(3)):
        kept = ti.select(straight, ti.static(NO_BOUND[k]), ti.select(nearer, held[3 + k], held[k]))
        held[k] = ti.select(exceeded, kept, held[k])
        held[3 + k] = ti.select(exceeded, new[k], held[3 + k])
