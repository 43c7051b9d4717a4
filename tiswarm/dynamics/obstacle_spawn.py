"""Obstacle spawn: draw where a trial's obstacles lie, clear of the target and of where prey start."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import FAR
from tiswarm.simd import philox
from tiswarm.simd.lanes import dot, larger
from tiswarm.simd.runtime import LANES, Func, Types

TRIES = 32
"""Draws until a place is inside a ball or clear of others. One ball in 10¹⁰ needs more, and takes its centre; an obstacle that
finds no clear place in so many is left out, an agent that finds none apart from the others takes the farthest."""


@dataclass(frozen=True)
class ObstacleStarts:
    """Where obstacles lie when a trial starts."""

    drawn: Func
    place: Func


def build(layout: ParameterTable, types: Types, uniform: Func, within: Func) -> ObstacleStarts:
    """Build the funcs that lay a trial's obstacles out."""
    lanes, integers = types.lanes, types.integer_lanes
    at, dim, frame = layout.at, len(layout.axes), layout.structure.frame
    width = len(layout.paths)
    region, radius = at.obstacles.region, at.obstacles.radius
    order = list(range(LANES))

    @ti.func
    def obstacle_shares(key_low, key_high, trial, index, attempt):
        """Draw shares of the sides of the obstacles' region and, behind them, of the range of radii."""
        a, b, c, d = uniform(key_low, key_high, trial, philox.OBSTACLES, index, integers(ti.cast(attempt, ti.u32)))
        return ti.static([a, b, c, d][: dim + 1])

    @ti.func
    def is_clear(centre: ti.template(), size, numbers: ti.template(), b):
        """Tell whether a disc keeps off the target and off the region where prey start."""
        n = b * width
        low, high = ti.static(at.prey.region.low, at.prey.region.high)
        outside = [
            larger(larger(numbers[n + low[k]] - centre[k], centre[k] - numbers[n + high[k]]), 0.0)
            for k in ti.static(range(dim))
        ]
        clear = dot(outside, outside) > size * size
        if ti.static(frame.targeted):
            way = [centre[k] - numbers[n + at.target.place[k]] for k in ti.static(range(dim))]
            keep = size + numbers[n + at.target.radius]
            clear = clear & (dot(way, way) > keep * keep)
        return clear

    @ti.func
    def drawn_obstacle(index, numbers: ti.template(), b, trial, key_low, key_high):
        """Draw centre, radius, and 1 where no clear place was found, in one list. index: integer lanes."""
        n = b * width
        smallest = numbers[n + radius[0]]
        share = obstacle_shares(key_low, key_high, trial, index, 0)
        centre = within(share, region, numbers, b)
        size = smallest + share[dim] * (numbers[n + radius[1]] - smallest)
        missing = lanes(0.0)
        if ti.static(frame.clear):
            missing = ti.select(is_clear(centre, size, numbers, b), 0.0, 1.0)
            for attempt in range(1, TRIES):
                again = obstacle_shares(key_low, key_high, trial, index, attempt)
                other = within(again, region, numbers, b)
                other_size = smallest + again[dim] * (numbers[n + radius[1]] - smallest)
                taken = (missing > 0.5) & is_clear(other, other_size, numbers, b)
                for k in ti.static(range(dim)):
                    centre[k] = ti.select(taken, other[k], centre[k])
                size = ti.select(taken, other_size, size)
                missing = ti.select(taken, 0.0, missing)
        return centre + [size, missing]  # noqa: RUF005 - Taichi knows no stars in lists

    @ti.func
    def place(obstacles: ti.template(), count, numbers: ti.template(), one, b, lane, trial, key_low, key_high):
        """Put the obstacles of one lane's trial. one: the block whose lanes all have that trial's numbers."""
        for part in range((count + LANES - 1) // LANES):
            first = part * LANES
            drawn = drawn_obstacle(integers(order) + ti.cast(first, ti.u32), numbers, one, trial, key_low, key_high)
            last = numbers[one * width + at.obstacles.count] - ti.cast(first, types.real) - 0.5
            exists = (last > lanes(order)) & (drawn[dim + 1] < 0.5)
            told = [ti.select(exists, drawn[k], FAR) for k in ti.static(range(dim))] + [ti.select(exists, drawn[dim], 0.0)]
            for j in range(ti.min(count - first, LANES)):
                o = (b * count + first + j) * layout.obstacle_rows
                for k in ti.static(range(dim + 1)):
                    obstacles[o + k][lane] = told[k][j]

    return ObstacleStarts(drawn=drawn_obstacle, place=place)
