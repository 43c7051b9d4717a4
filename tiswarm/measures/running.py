"""Running: polarisation, neighbours, energies, swept ground and the like, while a trial runs; recorded.py defines them all."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.rows import AGE, DONE, MEASURED, ON
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.measures import coverage, formulas, standing, traps
from tiswarm.measures import tally as tallies
from tiswarm.measures.formulas import AHEAD, COUNT, ENERGY, SPEED
from tiswarm.measures.tally import Tally
from tiswarm.scenario.measures import SETTLED, TRAPS
from tiswarm.simd.lanes import anywhere, dot, larger, place, safe, smaller
from tiswarm.simd.runtime import Func, Types
from tiswarm.space import box


@dataclass(frozen=True)
class Measures:
    """Funcs that measure a block's trials."""

    measure: Func  # measure each state once: a trial may pause between two ticks
    spread_ground: Func
    height: int
    cells: int
    count: int


def _motion(layout: ParameterTable, types: Types, see: Views, tally: Tally) -> Func:
    lanes = types.lanes
    at, rows, dim, width = layout.at, layout.rows, len(layout.axes), len(layout.paths)
    names, wraps = layout.structure.frame.measures, box.wraps(layout.structure.frame.boundary)
    prey_rows, prey_mate = layout.agent_rows["prey"], see.mate_at["prey"]

    @ti.func
    def measure_motion(
        sums: ti.template(), prey: ti.template(), numbers: ti.template(), clock: ti.template(), b, count, counted
    ):
        """Polarisation, mean speed and when it had settled, milling, kinetic energy, hits."""
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
                tally.add(sums, b, k, there, share * ti.sqrt(dot(total, total)))
            if ti.static(names[k] == "speed"):
                tally.add(sums, b, k, there, share * own[SPEED])
            if ti.static(names[k] == "settling-time"):
                moving = there & (share * own[SPEED] > SETTLED * tally.peak(sums, b, k, there, share * own[SPEED]))
                last = sums[b * tally.height + 2 * k]
                tally.keep(sums, b, k, there, ti.select(moving, clock[b, AGE] * numbers[b * width + at.dt], last))
            if ti.static(names[k] == "milling"):
                tally.add(sums, b, k, there, share * ti.sqrt(dot(spin, spin)))
            if ti.static(names[k] == "kinetic"):
                tally.add(sums, b, k, there, own[ENERGY])
            if ti.static(names[k] == "hits"):
                tally.keep(sums, b, k, counted, hits)

    return measure_motion


def _pairs(layout: ParameterTable, types: Types, see: Views, tally: Tally) -> Func:
    lanes = types.lanes
    at, width, names = layout.at, len(layout.paths), layout.structure.frame.measures
    prey_rows, prey_mate = layout.agent_rows["prey"], see.mate_at["prey"]

    @ti.func
    def measure_pairs(sums: ti.template(), prey: ti.template(), numbers: ti.template(), b, count, counted):
        """Mean distance to the nearest neighbour and by how much it was greater before, the least of all, potential energy."""
        n = b * width
        spacing2 = numbers[n + at.prey.spacing] * numbers[n + at.prey.spacing]
        reach2 = numbers[n + at.prey.perception] * numbers[n + at.prey.perception]
        alive, nearest, potential = lanes(0.0), lanes(0.0), lanes(0.0)
        closest = lanes(1e30)
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
            closest = ti.select(me.alive > 0.5, smaller(closest, least), closest)
        pairs = counted & (alive > 1.5)
        for k in ti.static(range(len(names))):
            if ti.static(names[k] == "nearest"):
                tally.add(sums, b, k, pairs, nearest / larger(alive, 1.0))
            if ti.static(names[k] == "least-distance"):
                tally.keep_least(sums, b, k, pairs, ti.sqrt(closest))
            if ti.static(names[k] == "overshoot"):
                apart = nearest / larger(alive, 1.0)
                tally.keep(sums, b, k, pairs, tally.peak(sums, b, k, pairs, apart) / safe(apart) - 1.0)
            if ti.static(names[k] == "potential"):
                tally.add(sums, b, k, counted & (alive > 0.5), potential)

    return measure_pairs


def _groups(layout: ParameterTable, types: Types, see: Views, tally: Tally) -> Func:
    lanes = types.lanes
    at, rows, width, names = layout.at, layout.rows, len(layout.paths), layout.structure.frame.measures
    prey_rows, prey_mate = layout.agent_rows["prey"], see.mate_at["prey"]

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
        tally.add(sums, b, ti.static(names.index("groups")), counted & (alive > 0.5), groups)

    return measure_groups


def _traps(layout: ParameterTable, types: Types, see: Views, tally: Tally) -> Func:
    at, width, names = layout.at, len(layout.paths), layout.structure.frame.measures
    watch = traps.build(layout, types, see).watch

    @ti.func
    def measure_traps(sums: ti.template(), prey: ti.template(), numbers: ti.template(), clock: ti.template(), b, count, unseen):
        """Share of the prey that were ever trapped, for how long, and how far they circled meanwhile."""
        caught, time, spin, most = watch(prey, numbers, clock, b, count, unseen)
        n = b * width
        for k in ti.static(range(len(names))):
            if ti.static(names[k] == "trapped"):
                tally.keep(sums, b, k, unseen, caught / numbers[n + at.prey.count])
            if ti.static(names[k] == "trapped-time"):
                tally.keep(sums, b, k, unseen, time * numbers[n + at.dt] / numbers[n + at.prey.count])
            if ti.static(names[k] == "trapped-milling"):
                tally.keep(sums, b, k, unseen & (most > 0.0), spin / safe(most))

    return measure_traps


def build(layout: ParameterTable, types: Types, see: Views) -> Measures:
    """Build `measure` and `spread_ground`, and tell how many rows of sums and cells of ground a block has, and measures.

    sums: [block * row]; ground: [block * cell], in how many states an agent's tool lay on a cell, -1 where there is no ground.
    """
    at, width = layout.at, len(layout.paths)
    names = layout.structure.frame.measures
    across, down = layout.structure.frame.cells
    cells = across * down
    pair_names = {"nearest", "least-distance", "overshoot", "potential"} & set(names)
    stands = bool({"stalled", "corrected"} & set(names))
    trapping = bool(set(TRAPS) & set(names))
    tally = tallies.build(layout)
    ground_of = coverage.build(layout, types, see, tally)
    measure_motion, measure_pairs, measure_groups = (each(layout, types, see, tally) for each in (_motion, _pairs, _groups))
    measure_standing = standing.build(layout, types, see, tally)
    measure_traps = _traps(layout, types, see, tally) if trapping else None

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
                    measure_motion(sums, prey, numbers, clock, b, counts[0], counted)
                    if ti.static(bool(pair_names)):
                        measure_pairs(sums, prey, numbers, b, counts[0], counted)
                    if ti.static(stands):
                        measure_standing(sums, prey, numbers, clock, b, counts[0], counted)
                    if ti.static("groups" in names):
                        measure_groups(sums, prey, numbers, b, counts[0], counted)
                if ti.static(trapping):
                    measure_traps(sums, prey, numbers, clock, b, counts[0], unseen)
                if ti.static(cells > 0):
                    ground_of.sweep(sums, ground, prey, numbers, b, counts[0], unseen)
                    ground_of.measure(sums, numbers, clock, b, unseen)
                if ti.static("visit-variation" in names):  # noqa: SIM102 - one branch at compile time, one at run time
                    if anywhere(clock[b, DONE] > 0.5):
                        ground_of.vary(sums, ground, clock, b)
                clock[b, MEASURED] = ti.select(unseen, clock[b, AGE] + 1.0, clock[b, MEASURED])

    return Measures(measure=measure, spread_ground=ground_of.spread, height=tally.height, cells=cells, count=len(names))
