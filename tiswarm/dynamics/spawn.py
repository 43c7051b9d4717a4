"""Spawn: draw a trial's start state from its scenario, seed and number."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.rows import STAYS, TRIAL
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import FAR
from tiswarm.simd import philox
from tiswarm.simd.lanes import anywhere, capped, dot, larger, smaller
from tiswarm.simd.runtime import Func, Types
from tiswarm.space import box, box_lanes

TRIES = 32
"""Draws until a place is inside a ball or clear of others. One ball in 10¹⁰ needs more, and takes its centre; an obstacle that
finds no clear place in so many is left out, an agent that finds none apart from the others takes the farthest."""


@dataclass(frozen=True)
class AgentStarts:
    """How the agents of one kind start."""

    drawn: Func
    spawn: Func


@dataclass(frozen=True)
class ObstacleStarts:
    """Where obstacles lie when a trial starts."""

    drawn: Func
    spawn: Func


@dataclass(frozen=True)
class Starts:
    """Start states drawn in lanes."""

    spawn: Func
    uniform: Func
    prey: Func
    predators: Func
    obstacles: Func


@ti.func
def store(agents: ti.template(), row, fresh, value):
    """Write a value into the lanes that are fresh."""
    agents[row] = ti.select(fresh, value, agents[row])


def _within(layout: ParameterTable) -> Func:
    width = len(layout.paths)

    @ti.func
    def within(shares: ti.template(), box: ti.template(), numbers: ti.template(), b):
        """Give the place in a box that lies at these shares of its sides; more shares than sides do no harm."""
        n = b * width
        return [
            numbers[n + low] + share * (numbers[n + high] - numbers[n + low])
            for share, low, high in ti.static(zip(shares, box.low, box.high, strict=False))
        ]

    return within


def _shares(layout: ParameterTable, types: Types, uniform: Func) -> Func:
    """Build the func that draws shares of the sides of an agent's region and of its velocity's box."""
    integers = types.integer_lanes

    @ti.func
    def flat_shares(key_low, key_high, trial, purpose: ti.template(), index, attempt):
        """Draw them for two axes; each attempt has numbers of its own."""
        a, b, c, d = uniform(key_low, key_high, trial, purpose, index, integers(ti.cast(attempt, ti.u32)))
        return [a, b], [c, d]

    @ti.func
    def deep_shares(key_low, key_high, trial, purpose: ti.template(), index, attempt):
        """Draw them for three axes."""
        a, b, c, _ = uniform(key_low, key_high, trial, purpose, index, integers(ti.cast(2 * attempt, ti.u32)))
        d, e, f, _ = uniform(key_low, key_high, trial, purpose, index, integers(ti.cast(2 * attempt + 1, ti.u32)))
        return [a, b, c], [d, e, f]

    return flat_shares if len(layout.axes) == 2 else deep_shares


def _agents(layout: ParameterTable, types: Types, kind: str, draw_shares: Func, within: Func) -> AgentStarts:
    """Build the funcs that start the agents of a kind."""
    lanes, integers = types.lanes, types.integer_lanes
    rows, dim, frame = layout.rows, len(layout.axes), layout.structure.frame
    width = len(layout.paths)
    columns, own_rows = getattr(layout.at, kind), layout.agent_rows[kind]
    group = 0 if kind == "prey" else 1
    purpose = (philox.PREY, philox.PREDATORS)[group]
    cleared = [*rows.travel, *([rows.corrected] if frame.safety else [])]

    @ti.func
    def ball_shares(key_low, key_high, trial, index):
        """Draw shares until they lie in the ball inside the unit cube."""
        kept = [lanes(0.5) for _ in ti.static(range(dim))]
        missing = lanes(1.0)
        for attempt in range(1, TRIES):
            share, _ = draw_shares(key_low, key_high, trial, purpose, index, attempt)
            off = [2.0 * each - 1.0 for each in ti.static(share)]
            taken = (missing > 0.5) & (dot(off, off) <= 1.0)
            for k in ti.static(range(dim)):
                kept[k] = ti.select(taken, share[k], kept[k])
            missing = ti.select(taken, 0.0, missing)
        return kept

    @ti.func
    def drawn(index, numbers: ti.template(), b, trial, key_low, key_high):
        """Draw where an agent starts and how fast, one after the other in one list. index: integer lanes."""
        share, rate = draw_shares(key_low, key_high, trial, purpose, index, 0)
        if ti.static(frame.shapes[group] == "ball"):
            kept = ball_shares(key_low, key_high, trial, index)
            for k in ti.static(range(dim)):
                share[k] = kept[k]
        here = within(share, columns.region, numbers, b)
        velocity = within(rate, columns.velocity, numbers, b)
        if ti.static(frame.capped[group]):
            slow = capped(velocity, numbers[b * width + columns.max_speed])
            for k in ti.static(range(dim)):
                velocity[k] = slow[k]
        return here + velocity

    @ti.func
    def least_distance2(place: ti.template(), agents: ti.template(), b, count, i, numbers: ti.template()):
        """Give the squared distance of a place to the nearest of the agents before the i-th."""
        least = lanes(FAR)
        for j in range(i):
            off = [place[k] - agents[(b * count + j) * own_rows + rows.place[k]] for k in ti.static(range(dim))]
            if ti.static(box.wraps(frame.boundary)):
                for k in ti.static(range(dim)):
                    off[k] = box_lanes.displacement(off[k], numbers[b * width + layout.at.size[k]])
            least = smaller(least, dot(off, off))
        return least

    @ti.func
    def keep_apart(
        state: ti.template(), agents: ti.template(), b, count, i, numbers: ti.template(), fresh, trial, key_low, key_high
    ):
        """Draw the place of agent i anew until it is far enough from those before it; failing that, take the farthest."""
        apart = numbers[b * width + columns.apart]
        nearest2 = least_distance2(state, agents, b, count, i, numbers)
        attempt = 1
        while attempt < TRIES and anywhere(fresh & (nearest2 < apart * apart)):
            share, _ = draw_shares(key_low, key_high, trial, purpose, integers(ti.cast(i, ti.u32)), attempt)
            other = within(share, columns.region, numbers, b)
            other2 = least_distance2(other, agents, b, count, i, numbers)
            better = (nearest2 < apart * apart) & (other2 > nearest2)
            for k in ti.static(range(dim)):
                state[k] = ti.select(better, other[k], state[k])
            nearest2 = ti.select(better, other2, nearest2)
            attempt += 1

    @ti.func
    def spawn(agents: ti.template(), count, numbers: ti.template(), b, trial, fresh, key_low, key_high):
        n = b * width
        for i in range(count):
            a = (b * count + i) * own_rows
            state = drawn(integers(ti.cast(i, ti.u32)), numbers, b, trial, key_low, key_high)
            if ti.static(kind in frame.apart):
                keep_apart(state, agents, b, count, i, numbers, fresh, trial, key_low, key_high)
            for k in ti.static(range(dim)):
                store(agents, a + rows.place[k], fresh, state[k])
                store(agents, a + rows.motion[k], fresh, state[dim + k])
            exists = ti.select(numbers[n + columns.count] > ti.cast(i, types.real) + 0.5, 1.0, 0.0)
            store(agents, a + rows.alive, fresh, exists)
            store(agents, a + rows.fate, fresh, lanes(float(STAYS)))
            store(agents, a + rows.seen, fresh, lanes(0.0))
            store(agents, a + rows.hit, fresh, lanes(0.0))
            for row in ti.static(cleared):
                store(agents, a + row, fresh, lanes(0.0))
            for row in range(rows.count, own_rows):  # the strategies' memory
                store(agents, a + row, fresh, lanes(0.0))

    return AgentStarts(drawn=drawn, spawn=spawn)


def _obstacles(layout: ParameterTable, types: Types, uniform: Func, within: Func) -> ObstacleStarts:
    """Build the funcs that lay a trial's obstacles out."""
    lanes, integers = types.lanes, types.integer_lanes
    at, dim, frame = layout.at, len(layout.axes), layout.structure.frame
    width = len(layout.paths)
    region, radius = at.obstacles.region, at.obstacles.radius

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
    def spawn_obstacles(obstacles: ti.template(), count, numbers: ti.template(), b, trial, fresh, key_low, key_high):
        for i in range(count):
            o = (b * count + i) * layout.obstacle_rows
            drawn = drawn_obstacle(integers(ti.cast(i, ti.u32)), numbers, b, trial, key_low, key_high)
            exists = (numbers[b * width + at.obstacles.count] > ti.cast(i, types.real) + 0.5) & (drawn[dim + 1] < 0.5)
            for k in ti.static(range(dim)):
                store(obstacles, o + k, fresh, ti.select(exists, drawn[k], FAR))
            store(obstacles, o + dim, fresh, ti.select(exists, drawn[dim], 0.0))

    return ObstacleStarts(drawn=drawn_obstacle, spawn=spawn_obstacles)


def build(layout: ParameterTable, types: Types) -> Starts:
    """Build the funcs that draw a trial's start into fresh lanes, in lanes themselves."""
    uniform, within = philox.build(types).uniform, _within(layout)
    shares = _shares(layout, types, uniform)
    prey_starts, predator_starts = (_agents(layout, types, kind, shares, within) for kind in ("prey", "predators"))
    obstacle_starts = _obstacles(layout, types, uniform, within)

    @ti.func
    def spawn(
        prey: ti.template(),
        predators: ti.template(),
        obstacles: ti.template(),
        counts,
        numbers: ti.template(),
        integer: ti.template(),
        b,
        fresh,
        key_low,
        key_high,
    ):
        """Draw prey, predators and obstacles of the lanes that are fresh (a mask)."""
        trial = integer[b, TRIAL]
        prey_starts.spawn(prey, counts[0], numbers, b, trial, fresh, key_low, key_high)
        if ti.static(layout.structure.hunted):
            predator_starts.spawn(predators, counts[1], numbers, b, trial, fresh, key_low, key_high)
        obstacle_starts.spawn(obstacles, counts[2], numbers, b, trial, fresh, key_low, key_high)

    return Starts(
        spawn=spawn,
        uniform=uniform,
        prey=prey_starts.drawn,
        predators=predator_starts.drawn,
        obstacles=obstacle_starts.drawn,
    )
