"""Joint: the commands of all prey of a trial, changed together as little as can be: a quadratic program for each lane.

Minimise Σ |u - û|² over A u <= b. A lane keeps a list of the constraints that it has met exceeded, and solves them by itself
(joint_solution.py); all pairs and walls are looked at, in lanes, before and after, until nothing new is exceeded.
"""

import taichi as ti

from tiswarm.dynamics.barrier import Barrier, tolerance
from tiswarm.dynamics.rows import JOINT_AGENT, JOINT_CONSTRAINT, JOINT_FIRST, JOINT_LENGTH, JOINT_NEW
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.trials import joint_solution
from tiswarm.engine.trials.joint_solution import ACROSS, BOUND, FORCE, GIVE, ONE, OTHER, UP, WALL, U, V, X
from tiswarm.simd.lanes import anywhere, dot, row_of, safe
from tiswarm.simd.runtime import LANES, Func, Types
from tiswarm.space import box, box_lanes


def build(layout: ParameterTable, types: Types, rules: Barrier, allow: Func) -> Func:
    """Build `certify` (certificates.py)."""
    board_rows, rows, prey_rows = layout.board, layout.rows, layout.agent_rows["prey"]
    solution = joint_solution.build(types)
    meet = _meeting(layout, types, rules)

    @ti.func
    def certify(block: ti.template()):
        """Correct the commands of all prey."""
        b, count = block.b, block.counts[0]
        prey, numbers, board = ti.static(block.prey, block.numbers, block.board)
        base = b * (board_rows.fixed + board_rows.each * count) + layout.joint
        for i in range(count):
            a = row_of(b * count + i, prey_rows)
            point = rules.point_of(prey, a, numbers, b)
            for k in ti.static(range(2)):
                board[base + JOINT_AGENT * i + (X + k)] = point[k]
                board[base + JOINT_AGENT * i + (U + k)] = prey[a + rows.next_motion[k]]
        for row in ti.static((JOINT_AGENT * WALL + U, JOINT_AGENT * WALL + V, JOINT_LENGTH, JOINT_NEW)):
            board[base + row] = types.lanes(0.0)
        limits = rules.limits_of(numbers, b)
        while meet(block, base, limits) == 1:
            for lane in range(LANES):
                if board[base + JOINT_NEW][lane] > 0.5:
                    board[base + JOINT_NEW][lane] = 0.0
                    if solution.solve(board, base, lane) == 0:
                        solution.slacken(board, base, lane, count)
        for i in range(count):
            u = [1.0 * board[base + JOINT_AGENT * i + (U + k)] for k in ti.static(range(2))]
            allow(prey, numbers, b, count, i, u)

    return certify


def _meeting(layout: ParameterTable, types: Types, rules: Barrier) -> Func:
    """Build what looks at all pairs and walls."""
    at, rows, prey_rows, width = layout.at, layout.rows, layout.agent_rows["prey"], len(layout.paths)
    frame, slack = layout.structure.frame, tolerance(types)

    @ti.func
    def enlist(board: ti.template(), base, over, i, j, line: ti.template(), bound, weight: ti.template()):
        """Put a constraint at the end of the lists of those lanes where it is exceeded and not in yet; give 1 if it came in."""
        came = 0
        for lane in range(LANES):
            if ti.select(over > 0.0, 1.0, 0.0)[lane] > 0.5:
                length = ti.cast(board[base + JOINT_LENGTH][lane], ti.i32)
                one, other, known = ti.cast(i, types.real), ti.cast(j, types.real), 0
                for k in range(length):
                    e = base + JOINT_FIRST + JOINT_CONSTRAINT * k
                    same = board[e + ONE][lane] == one and board[e + OTHER][lane] == other
                    if same and board[e + ACROSS][lane] == line[0][lane] and board[e + UP][lane] == line[1][lane]:
                        known = 1
                if known == 0:
                    e = base + JOINT_FIRST + JOINT_CONSTRAINT * length
                    board[e + ONE][lane] = one
                    board[e + OTHER][lane] = other
                    board[e + ACROSS][lane] = line[0][lane]
                    board[e + UP][lane] = line[1][lane]
                    board[e + BOUND][lane] = bound[lane] - 2.0 * slack
                    board[e + GIVE][lane] = 1.0 / (weight * safe(dot(line, line))[lane])
                    board[e + FORCE][lane] = 0.0
                    board[base + JOINT_LENGTH][lane] = ti.cast(length + 1, types.real)
                    board[base + JOINT_NEW][lane] = 1.0
                    came = 1
        return came

    @ti.func
    def meet_walls(block: ti.template(), base, limits: ti.template(), i, here):
        came = 0
        board, numbers = ti.static(block.board, block.numbers)
        p = base + JOINT_AGENT * i
        for k, side in ti.static([(k, side) for k in range(2) for side in (-1.0, 1.0)]):
            place = board[p + (X + k)]
            off = numbers[block.b * width + at.size[k]] - place if ti.static(side > 0) else place
            bound = rules.wall_bound(off, limits)
            over = ti.select(here, side * board[p + (U + k)] - bound, -1.0)
            if anywhere(over > 0.0):
                line = [types.lanes(side if ti.static(k == axis) else 0.0) for axis in ti.static(range(2))]
                came = ti.max(came, enlist(board, base, over, i, WALL, line, bound, 1.0))
        return came

    @ti.func
    def meet(block: ti.template(), base, limits: ti.template()):
        """Enlist all that is exceeded; give 1 if anything came in."""
        b, count = block.b, block.counts[0]
        prey, numbers, board = ti.static(block.prey, block.numbers, block.board)
        came = 0
        for i in range(count):
            p = base + JOINT_AGENT * i
            here = prey[row_of(b * count + i, prey_rows) + rows.alive] > 0.5
            for j in range(i):
                q = base + JOINT_AGENT * j
                away = [board[p + (X + k)] - board[q + (X + k)] for k in ti.static(range(2))]
                if ti.static(box.wraps(frame.boundary)):
                    for k in ti.static(range(2)):
                        away[k] = box_lanes.displacement(away[k], numbers[b * width + at.size[k]])
                line = [-2.0 * away[k] for k in ti.static(range(2))]
                bound = rules.pair_bound(dot(away, away), limits)
                change = [board[p + (U + k)] - board[q + (U + k)] for k in ti.static(range(2))]
                both = here & (prey[row_of(b * count + j, prey_rows) + rows.alive] > 0.5)
                over = ti.select(both, dot(line, change) - bound, -1.0)
                if anywhere(over > 0.0):
                    came = ti.max(came, enlist(board, base, over, i, j, line, bound, 2.0))
            if ti.static(box.walled(frame.boundary)):
                came = ti.max(came, meet_walls(block, base, limits, i, here))
        return came

    return meet
