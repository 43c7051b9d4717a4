"""Running: polarisation, neighbours, energies, swept ground and the like, while a trial runs; recorded.py defines them all."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.rows import AGE, DONE, MEASURED, ON
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.measures import formulas, standing, traps
from tiswarm.measures.formulas import AHEAD, COUNT, ENERGY, SPEED
from tiswarm.scenario.measures import COVERED, TRAPS
from tiswarm.simd.lanes import Bundle, anywhere, dot, larger, place, safe, smaller
from tiswarm.simd.runtime import LANES, Func, Types
from tiswarm.space import box, box_lanes

# Rows of a block's sums behind two for each measure (sum and number of states): cells swept so far, and cells there are.
CLEAN, FREE, GROUND_ROWS = range(3)


@dataclass(frozen=True)
class Measures:
    """Funcs that measure a block's trials."""

    measure: Func  # measure each state once: a trial may pause between two ticks
    spread_ground: Func
    height: int
    cells: int
    count: int


def build(layout: ParameterTable, types: Types, see: Views) -> Measures:
    """Build `measure` and `spread_ground`, and tell how many rows of sums and cells of ground a block has, and measures.

    sums: [block * row]; ground: [block * cell], in how many states an agent's tool lay on a cell, -1 where there is no ground.
    """
    lanes = types.lanes
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    frame = layout.structure.frame
    wraps = box.wraps(frame.boundary)
    names = frame.measures
    height = 2 * len(names) + GROUND_ROWS
    across, down = frame.cells
    cells = across * down
    prey_rows, prey_mate = layout.agent_rows["prey"], see.mate_at["prey"]
    pair_names = {"nearest", "potential", "least-distance"} & set(names)
    stands, measure_standing = bool({"stalled", "corrected"} & set(names)), standing.build(layout, types, see)
    trapping = bool(set(TRAPS) & set(names))
    watch = traps.build(layout, types, see).watch if trapping else None

    @ti.func
    def add(sums: ti.template(), b, k: ti.template(), counted, value):
        s = b * height + 2 * k
        sums[s] = sums[s] + ti.select(counted, value, 0.0)
        sums[s + 1] = sums[s + 1] + ti.select(counted, 1.0, 0.0)

    @ti.func
    def keep(sums: ti.template(), b, k: ti.template(), counted, value):
        s = b * height + 2 * k
        sums[s] = ti.select(counted, value, sums[s])
        sums[s + 1] = ti.select(counted, 1.0, sums[s + 1])

    @ti.func
    def keep_least(sums: ti.template(), b, k: ti.template(), counted, value):
        s = b * height + 2 * k
        keep(sums, b, k, counted & ((sums[s + 1] < 0.5) | (value < sums[s])), value)

    @ti.func
    def measure_motion(sums: ti.template(), prey: ti.template(), numbers: ti.template(), b, count, counted):
        """Polarisation, mean speed, milling, kinetic energy, hits."""
        own = [lanes(0.0) for _ in ti.static(range(AHEAD + 2 * dim))]
        origin = [lanes(0.0) for _ in ti.static(range(dim))]
        period = [numbers[b * width + column] for column in ti.static(at.size if wraps else [])]
        spin = [lanes(0.0) for _ in ti.static(range(3))]
        hits = lanes(0.0)
        for i in range(count):
            me = prey_mate(prey, (b * count + i) * prey_rows, i)
            if ti.static(wraps):
                for k in ti.static(range(dim)):
                    origin[k] = ti.select((me.alive > 0.5) & (own[COUNT] < 0.5), place(me)[k], origin[k])
            formulas.add_motion(own, me, origin, period)
            hits += prey[(b * count + i) * prey_rows + rows.hit]
        share = 1.0 / larger(own[COUNT], 1.0)
        if ti.static("milling" in names):
            for i in range(count):
                me = prey_mate(prey, (b * count + i) * prey_rows, i)
                centre = [origin[k] + share * own[AHEAD + dim + k] for k in ti.static(range(dim))]
                formulas.add_spin(spin, me, centre, period)
        there = counted & (own[COUNT] > 0.5)
        for k in ti.static(range(len(names))):
            if ti.static(names[k] == "polarisation"):
                total = [own[AHEAD + k] for k in ti.static(range(dim))]
                add(sums, b, k, there, share * ti.sqrt(dot(total, total)))
            if ti.static(names[k] == "speed"):
                add(sums, b, k, there, share * own[SPEED])
            if ti.static(names[k] == "milling"):
                add(sums, b, k, there, share * ti.sqrt(dot(spin, spin)))
            if ti.static(names[k] == "kinetic"):
                add(sums, b, k, there, own[ENERGY])
            if ti.static(names[k] == "hits"):
                keep(sums, b, k, counted, hits)

    @ti.func
    def measure_pairs(sums: ti.template(), prey: ti.template(), numbers: ti.template(), b, count, counted):
        """Mean distance to the nearest neighbour, least distance of any two, and potential energy."""
        n = b * width
        spacing2 = numbers[n + at.prey.spacing] * numbers[n + at.prey.spacing]
        reach2 = numbers[n + at.prey.perception] * numbers[n + at.prey.perception]
        alive, nearest, potential = lanes(0.0), lanes(0.0), lanes(0.0)
        closest = lanes(1e30)
        for i in range(count):
            me = prey_mate(prey, (b * count + i) * prey_rows, i)
            least = lanes(1e30)
            for j in range(count):
                if i != j:
                    mate = prey_mate(prey, (b * count + j) * prey_rows, j)
                    away = see.gap(me, mate, numbers, b)
                    distance2 = dot(away, away)
                    least = ti.select(mate.alive > 0.5, smaller(least, distance2), least)
                    if ti.static("potential" in names):
                        potential += 0.5 * me.alive * mate.alive * formulas.pair_energy(distance2, reach2, spacing2)
            alive += me.alive
            nearest += me.alive * ti.sqrt(least)
            closest = ti.select(me.alive > 0.5, smaller(closest, least), closest)
        pairs = counted & (alive > 1.5)
        for k in ti.static(range(len(names))):
            if ti.static(names[k] == "nearest"):
                add(sums, b, k, pairs, nearest / larger(alive, 1.0))
            if ti.static(names[k] == "least-distance"):
                keep_least(sums, b, k, pairs, ti.sqrt(closest))
            if ti.static(names[k] == "potential"):
                add(sums, b, k, counted & (alive > 0.5), potential)

    @ti.func
    def measure_groups(sums: ti.template(), prey: ti.template(), numbers: ti.template(), b, count, counted):
        """Count the groups: sets of prey joined by chains of distances within `measures.distance`."""
        reach = numbers[b * width + at.distance]
        for i in range(count):
            prey[(b * count + i) * prey_rows + rows.label] = lanes(0.0) + ti.cast(i, types.real)
        changes = 1
        while changes == 1:
            changes = 0
            for i in range(count):
                a = (b * count + i) * prey_rows
                me = prey_mate(prey, a, i)
                for j in range(count):
                    c = (b * count + j) * prey_rows
                    mate = prey_mate(prey, c, j)
                    away = see.gap(me, mate, numbers, b)
                    joined = (dot(away, away) <= reach * reach) & (me.alive * mate.alive > 0.5)
                    lower = joined & (prey[c + rows.label] < prey[a + rows.label])
                    if anywhere(lower):
                        prey[a + rows.label] = ti.select(lower, prey[c + rows.label], prey[a + rows.label])
                        changes = 1
        groups, alive = lanes(0.0), lanes(0.0)
        for i in range(count):
            a = (b * count + i) * prey_rows
            own = prey[a + rows.label] - ti.cast(i, types.real)
            groups += ti.select(own * own < 0.25, prey[a + rows.alive], 0.0)
            alive += prey[a + rows.alive]
        add(sums, b, ti.static(names.index("groups")), counted & (alive > 0.5), groups)

    @ti.func
    def measure_traps(sums: ti.template(), prey: ti.template(), numbers: ti.template(), clock: ti.template(), b, count, unseen):
        """Share of the prey that were ever trapped, for how long, and how far they circled meanwhile."""
        caught, time, spin, most = watch(prey, numbers, clock, b, count, unseen)
        n = b * width
        for k in ti.static(range(len(names))):
            if ti.static(names[k] == "trapped"):
                keep(sums, b, k, unseen, caught / numbers[n + at.prey.count])
            if ti.static(names[k] == "trapped-time"):
                keep(sums, b, k, unseen, time * numbers[n + at.dt] / numbers[n + at.prey.count])
            if ti.static(names[k] == "trapped-milling"):
                keep(sums, b, k, unseen & (most > 0.0), spin / safe(most))

    @ti.func
    def visit(here: ti.template(), cell):
        """Count a visit of a cell in one lane, and the cell if it is the first."""
        at_cell = here.b * cells + cell
        lane = here.lane
        if here.ground[at_cell][lane] > -0.5:
            if here.ground[at_cell][lane] < 0.5:
                here.sums[here.clean][lane] = here.sums[here.clean][lane] + 1.0
            here.ground[at_cell][lane] = here.ground[at_cell][lane] + 1.0

    @ti.func
    def sweep(sums: ti.template(), ground: ti.template(), prey: ti.template(), numbers: ti.template(), b, count, unseen):
        """Count a visit of every cell whose centre lies under a prey's tool, or under its nearest image."""
        n = b * width
        s = b * height + ti.static(2 * len(names))
        for lane in range(LANES):
            if ti.select(unseen, 1.0, 0.0)[lane] > 0.5:
                side = numbers[n + at.cell][lane]
                tool = numbers[n + at.tool][lane]
                for i in range(count):
                    a = (b * count + i) * prey_rows
                    if prey[a + rows.alive][lane] > 0.5:
                        x, y = prey[a + rows.place[0]][lane], prey[a + rows.place[1]][lane]
                        period = [numbers[n + column][lane] for column in ti.static(at.size if wraps else [])]
                        here = Bundle(sums=sums, ground=ground, b=b, lane=lane, clean=s + CLEAN)
                        formulas.visit_cells(x, y, side, tool, across, down, period, visit, here)

    @ti.func
    def measure_ground(sums: ti.template(), numbers: ti.template(), clock: ti.template(), b, unseen):
        """Covered share, and the time at which it passed certain shares."""
        s = b * height + ti.static(2 * len(names))
        share = sums[s + CLEAN] / larger(sums[s + FREE], 1.0)
        time = clock[b, AGE] * numbers[b * width + at.dt]
        for k in ti.static(range(len(names))):
            if ti.static(names[k] == "coverage"):
                keep(sums, b, k, unseen, share)
            if ti.static(names[k] in COVERED):
                passed = unseen & (share >= ti.static(COVERED.get(names[k], 1.0))) & (sums[b * height + 2 * k + 1] < 0.5)
                keep(sums, b, k, passed, time)

    @ti.func
    def spread_ground(
        sums: ti.template(), ground: ti.template(), obstacles: ti.template(), numbers: ti.template(), b, count, fresh
    ):
        """Prepare sums and grid of lanes that start: what lies outside the world or under obstacles cannot be swept."""
        for k in range(height):
            sums[b * height + k] = ti.select(fresh, 0.0, sums[b * height + k])
        if ti.static(cells > 0):
            side = numbers[b * width + at.cell]
            free = lanes(0.0)
            for cell in range(cells):
                x = (ti.cast(cell % across, types.real) + 0.5) * side
                y = (ti.cast(cell // across, types.real) + 0.5) * side
                size = [numbers[b * width + column] for column in ti.static(at.size)]
                outside = box_lanes.beyond(frame.boundary, [x + lanes(0.0), y + lanes(0.0)], size)
                under = ti.select(outside, 1.0, lanes(0.0))
                for j in range(count):
                    obstacle = see.obstacle_at(obstacles, b, count, j)
                    off = see.gap(see.Spot(x + lanes(0.0), y + lanes(0.0)), obstacle, numbers, b)
                    under = larger(under, ti.select(dot(off, off) < obstacle.radius * obstacle.radius, 1.0, 0.0))
                ground[b * cells + cell] = ti.select(fresh, 0.0 - under, ground[b * cells + cell])
                free += 1.0 - under
            s = b * height + ti.static(2 * len(names)) + FREE
            sums[s] = ti.select(fresh, free, sums[s])

    @ti.func
    def vary(sums: ti.template(), ground: ti.template(), clock: ti.template(), b):
        """Coefficient of variation of the cells' visits, when a trial ends."""
        n, total, squares = lanes(0.0), lanes(0.0), lanes(0.0)
        for cell in range(cells):
            visits = ground[b * cells + cell]
            free = ti.select(visits > -0.5, 1.0, 0.0)
            n += free
            total += free * visits
            squares += free * visits * visits
        mean = total / larger(n, 1.0)
        variance = larger(squares / larger(n, 1.0) - mean * mean, 0.0)
        ended = (clock[b, DONE] > 0.5) & (mean > 0.0)
        keep(sums, b, ti.static(names.index("visit-variation")), ended, ti.sqrt(variance) / safe(mean))

    @ti.func
    def measure(
        prey: ti.template(),
        numbers: ti.template(),
        clock: ti.template(),
        sums: ti.template(),
        ground: ti.template(),
        b,
        counts,
    ):
        """Measure each state once: a trial may pause between two ticks."""
        if ti.static(len(names) > 0 or cells > 0):
            unseen = (clock[b, MEASURED] < clock[b, AGE] + 0.5) & (clock[b, ON] > 0.5)
            if anywhere(unseen):
                after = smaller(numbers[b * width + at.after], numbers[b * width + at.ticks])
                counted = unseen & (clock[b, AGE] > after - 0.5)
                if anywhere(counted):
                    measure_motion(sums, prey, numbers, b, counts[0], counted)
                    if ti.static(bool(pair_names)):
                        measure_pairs(sums, prey, numbers, b, counts[0], counted)
                    if ti.static(stands):
                        measure_standing(add, sums, prey, numbers, clock, b, counts[0], counted)
                    if ti.static("groups" in names):
                        measure_groups(sums, prey, numbers, b, counts[0], counted)
                if ti.static(trapping):
                    measure_traps(sums, prey, numbers, clock, b, counts[0], unseen)
                if ti.static(cells > 0):
                    sweep(sums, ground, prey, numbers, b, counts[0], unseen)
                    measure_ground(sums, numbers, clock, b, unseen)
                if ti.static("visit-variation" in names):  # noqa: SIM102 - one branch at compile time, one at run time
                    if anywhere(clock[b, DONE] > 0.5):
                        vary(sums, ground, clock, b)
                clock[b, MEASURED] = ti.select(unseen, clock[b, AGE] + 1.0, clock[b, MEASURED])

    return Measures(measure=measure, spread_ground=spread_ground, height=height, cells=cells, count=len(names))
