"""Spawn: draw a trial's start state from its scenario, seed and number.

Trials begin one by one, now in this lane, now in that: each is drawn with its agents in the lanes, as many at a time as there
are, which takes a fraction of what all lanes take that draw one agent after the other for one of them.
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics import obstacle_spawn
from tiswarm.dynamics.obstacle_spawn import TRIES
from tiswarm.dynamics.rows import STAYS, TRIAL
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import FAR
from tiswarm.simd import philox
from tiswarm.simd.lanes import anywhere, capped, dot, smaller
from tiswarm.simd.runtime import LANES, Func, Types
from tiswarm.space import box, box_lanes


@dataclass(frozen=True)
class AgentStarts:
    """How the agents of one kind start."""

    drawn: Func
    begin: Func
    place: Func


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
    order = list(range(LANES))

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
    def place(agents: ti.template(), count, numbers: ti.template(), one, b, lane, trial, key_low, key_high):
        """Put the agents of one lane's trial where they start. one: the block whose lanes all have that trial's numbers."""
        for part in range((count + LANES - 1) // LANES):
            first = part * LANES
            state = drawn(integers(order) + ti.cast(first, ti.u32), numbers, one, trial, key_low, key_high)
            for j in range(ti.min(count - first, LANES)):
                a = (b * count + first + j) * own_rows
                for k in ti.static(range(dim)):
                    agents[a + rows.place[k]][lane] = state[k][j]
                    agents[a + rows.motion[k]][lane] = state[dim + k][j]

    @ti.func
    def place_apart(agents: ti.template(), count, numbers: ti.template(), b, trial, fresh, key_low, key_high):
        """Put agents where they start, one after the other, since each keeps off those before it."""
        for i in range(count):
            a = (b * count + i) * own_rows
            state = drawn(integers(ti.cast(i, ti.u32)), numbers, b, trial, key_low, key_high)
            keep_apart(state, agents, b, count, i, numbers, fresh, trial, key_low, key_high)
            for k in ti.static(range(dim)):
                store(agents, a + rows.place[k], fresh, state[k])
                store(agents, a + rows.motion[k], fresh, state[dim + k])

    @ti.func
    def begin(agents: ti.template(), count, numbers: ti.template(), b, trial, fresh, key_low, key_high):
        """Let the agents of fresh lanes be there, and know nothing yet."""
        n = b * width
        if ti.static(kind in frame.apart):
            place_apart(agents, count, numbers, b, trial, fresh, key_low, key_high)
        for i in range(count):
            a = (b * count + i) * own_rows
            exists = ti.select(numbers[n + columns.count] > ti.cast(i, types.real) + 0.5, 1.0, 0.0)
            store(agents, a + rows.alive, fresh, exists)
            store(agents, a + rows.fate, fresh, lanes(float(STAYS)))
            store(agents, a + rows.seen, fresh, lanes(0.0))
            store(agents, a + rows.hit, fresh, lanes(0.0))
            for row in ti.static(cleared):
                store(agents, a + row, fresh, lanes(0.0))
            for row in range(rows.count, own_rows):  # the strategies' memory
                store(agents, a + row, fresh, lanes(0.0))

    return AgentStarts(drawn=drawn, begin=begin, place=place)


def build(layout: ParameterTable, types: Types) -> Starts:
    """Build the funcs that draw a trial's start, and put it into fresh lanes."""
    uniform, within = philox.build(types).uniform, _within(layout)
    shares = _shares(layout, types, uniform)
    prey_starts, predator_starts = (_agents(layout, types, kind, shares, within) for kind in ("prey", "predators"))
    obstacle_starts = obstacle_spawn.build(layout, types, uniform, within)
    width, hunted = len(layout.paths), layout.structure.hunted
    placed = [kind for kind in ("prey", "predators") if kind not in layout.structure.frame.apart]

    @ti.func
    def spawn_lane(block: ti.template(), one, lane):
        """Place all of one lane's trial. one: a block of numbers to write that trial's into, in all lanes."""
        b, counts = block.b, block.counts
        numbers = ti.static(block.numbers)
        for column in range(width):
            numbers[one * width + column] = types.lanes(numbers[b * width + column][lane])
        told = types.integer_lanes(block.integer[b, TRIAL][lane])
        key_low, key_high = block.key_low, block.key_high
        if ti.static("prey" in placed):
            prey_starts.place(block.prey, counts[0], numbers, one, b, lane, told, key_low, key_high)
        if ti.static(hunted and "predators" in placed):
            predator_starts.place(block.predators, counts[1], numbers, one, b, lane, told, key_low, key_high)
        obstacle_starts.place(block.obstacles, counts[2], numbers, one, b, lane, told, key_low, key_high)

    @ti.func
    def spawn(block: ti.template(), one, fresh):
        """Draw prey, predators and obstacles of the lanes that are fresh (a mask). one: as for `spawn_lane`."""
        b, counts = block.b, block.counts
        numbers = ti.static(block.numbers)
        trial = block.integer[b, TRIAL]
        prey_starts.begin(block.prey, counts[0], numbers, b, trial, fresh, block.key_low, block.key_high)
        if ti.static(hunted):
            predator_starts.begin(block.predators, counts[1], numbers, b, trial, fresh, block.key_low, block.key_high)
        begins = ti.select(fresh, 1, 0)
        for lane in range(LANES):
            if begins[lane] == 1:
                spawn_lane(block, one, lane)

    return Starts(
        spawn=spawn,
        uniform=uniform,
        prey=prey_starts.drawn,
        predators=predator_starts.drawn,
        obstacles=obstacle_starts.drawn,
    )
