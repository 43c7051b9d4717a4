"""Coverage: the ground that prey's tools sweep, cell by cell, while a trial runs; ground.py does so for recordings."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.rows import AGE, DONE
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.measures import formulas
from tiswarm.measures.tally import CLEAN, FREE, Tally
from tiswarm.scenario.measures import COVERED
from tiswarm.simd.lanes import Bundle, dot, larger, safe
from tiswarm.simd.runtime import LANES, Func, Types
from tiswarm.space import box, box_lanes


@dataclass(frozen=True)
class Ground:
    """Funcs that work on a block's ground: [block * cell], in how many states a tool lay on a cell, -1 where there is none."""

    sweep: Func
    measure: Func
    spread: Func
    vary: Func


def build(layout: ParameterTable, types: Types, see: Views, tally: Tally) -> Ground:
    """Build the funcs. sums: rows of `tally`."""
    frame, names, height = layout.structure.frame, layout.structure.frame.measures, tally.height
    spread = _spread(layout, types, see, height)
    lanes = types.lanes
    at, rows, width = layout.at, layout.rows, len(layout.paths)
    prey_rows = layout.agent_rows["prey"]
    wraps = box.wraps(frame.boundary)
    across, down = frame.cells
    cells = across * down

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
                tally.keep(sums, b, k, unseen, share)
            if ti.static(names[k] in COVERED):
                passed = unseen & (share >= ti.static(COVERED.get(names[k], 1.0))) & (sums[b * height + 2 * k + 1] < 0.5)
                tally.keep(sums, b, k, passed, time)

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
        tally.keep(sums, b, ti.static(names.index("visit-variation")), ended, ti.sqrt(variance) / safe(mean))

    return Ground(sweep=sweep, measure=measure_ground, spread=spread, vary=vary)


def _spread(layout: ParameterTable, types: Types, see: Views, height: int) -> Func:
    lanes = types.lanes
    at, width, frame = layout.at, len(layout.paths), layout.structure.frame
    names = frame.measures
    across, down = frame.cells
    cells = across * down

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

    return spread_ground
