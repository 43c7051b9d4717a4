"""Shared: each prey keeps to half of each pair's bound, and takes the velocity nearest to its command that does."""

import taichi as ti

from tiswarm.dynamics.barrier import NO_BOUND, Barrier, tightened, tolerance
from tiswarm.dynamics.table import ParameterTable
from tiswarm.simd.lanes import anywhere, dot, row_of, safe
from tiswarm.simd.runtime import Func, Types
from tiswarm.space import box, box_lanes

ROUNDS = 64
"""Most bounds that are looked at one after the other; twenty robots in a heap need five."""


def build(layout: ParameterTable, types: Types, rules: Barrier, allow: Func) -> Func:
    """Build `certify` (certificates.py)."""
    at, rows, prey_rows, width = layout.at, layout.rows, layout.agent_rows["prey"], len(layout.paths)
    frame, slack, lanes = layout.structure.frame, tolerance(types), types.lanes

    @ti.func
    def worse(worst: ti.template(), over, line: ti.template(), bound):
        """Take the bound n·u <= c that is exceeded most so far. worst: excess, normal, bound."""
        more = over > worst[0]
        worst[0] = ti.select(more, over, worst[0])
        for k in ti.static(range(2)):
            worst[1 + k] = ti.select(more, line[k], worst[1 + k])
        worst[3] = ti.select(more, bound, worst[3])

    @ti.func
    def meet_walls(worst: ti.template(), point: ti.template(), u: ti.template(), numbers: ti.template(), b, limits):
        for k, side in ti.static([(k, side) for k in range(2) for side in (-1.0, 1.0)]):
            off = numbers[b * width + at.size[k]] - point[k] if ti.static(side > 0) else point[k]
            bound = rules.wall_bound(off, limits)
            line = [lanes(side if ti.static(k == axis) else 0.0) for axis in ti.static(range(2))]
            worse(worst, side * u[k] - bound, line, bound - 2.0 * slack)

    @ti.func
    def worst_of(block: ti.template(), i, point: ti.template(), u: ti.template(), limits: ti.template()):
        """Give by how much u exceeds which of an agent's bounds most, its normal and the bound, in one list."""
        b, count = block.b, block.counts[0]
        prey, numbers = ti.static(block.prey, block.numbers)
        worst = [lanes(0.0) for _ in ti.static(range(4))]
        for j in range(count):
            if j != i:
                q = row_of(b * count + j, prey_rows)
                other = rules.point_of(prey, q, numbers, b)
                away = [point[k] - other[k] for k in ti.static(range(2))]
                if ti.static(box.wraps(frame.boundary)):
                    for k in ti.static(range(2)):
                        away[k] = box_lanes.displacement(away[k], numbers[b * width + at.size[k]])
                distance2 = dot(away, away)
                bound = 0.5 * rules.pair_bound(distance2, limits)
                over = ti.select(prey[q + rows.alive] > 0.5, -2.0 * dot(away, u) - bound, -1.0)
                if anywhere(over > 0.0):
                    length = 1.0 / ti.sqrt(safe(distance2))
                    line = [-1.0 * length * away[k] for k in ti.static(range(2))]
                    worse(worst, 0.5 * length * over, line, 0.5 * length * bound - 2.0 * slack)
        if ti.static(box.walled(frame.boundary)):
            meet_walls(worst, point, u, numbers, b, limits)
        return worst

    @ti.func
    def certify(block: ti.template()):
        """Correct the commands of all prey, one after the other: nobody's depends on another's."""
        b, count = block.b, block.counts[0]
        prey, numbers = ti.static(block.prey, block.numbers)
        limits = rules.limits_of(numbers, b)
        for i in range(count):
            a = row_of(b * count + i, prey_rows)
            point = rules.point_of(prey, a, numbers, b)
            command = [1.0 * prey[a + rows.next_motion[k]] for k in ti.static(range(2))]
            u = [1.0 * command[k] for k in ti.static(range(2))]
            held = [lanes(each) for each in ti.static(NO_BOUND + NO_BOUND)]
            left = ROUNDS
            while left > 0:
                worst = worst_of(block, i, point, u, limits)
                exceeded = worst[0] > 0.0
                left = ti.select(anywhere(exceeded), left - 1, 0)
                if left > 0:
                    tightened(u, command, [worst[1], worst[2]], worst[3], held, exceeded, slack)
            allow(prey, numbers, b, count, i, u)

    return certify
