"""Planning: ways to the target around obstacles, on a grid of square cells, found once a trial.

A cell is blocked where its centre is within an obstacle's radius and a clearance of the obstacle's centre. A step leads to one
of eight neighbours, along a side or a diagonal, past blocked corners, too (Lupau 2022, the planned boids of its program). Each
cell knows the next one of its shortest way: the descent of a field of lengths, which all agents of a trial share.
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import anywhere, dot, larger, place, smaller, unit
from tiswarm.simd.runtime import LANES, Func, Types

DIAGONAL = 1.4142135623730951
NEVER = 1e30
"""The length of no way [cells]."""

STAY = 4
"""What a cell tells that has no next one: the target's, and those from which no way leads there."""

STEPS = tuple((across, up, 3 * (across + 1) + up + 1) for across in (-1, 0, 1) for up in (-1, 0, 1) if across or up)
"""The eight steps and their codes. Of ways of one length that with the first of these steps is taken."""


@dataclass(frozen=True)
class Planning:
    """Ways to the target."""

    plan: Func  # find the next cell of every cell, in lanes that are fresh
    way: Func  # give the way that a prey wants to go


@dataclass(frozen=True)
class _Grid:
    """Where the cells of a block's grid are."""

    base_of: Func  # give the row of the board that a block's grid begins at
    cell_of: Func
    centre_of: Func


def build(layout: ParameterTable, types: Types, see: Views) -> Planning:
    """Build `plan` and `way` for a structure; without plans, `way` is the straight line to the target.

    here: the senses' namespace, with the board, on whose rows (layout.plan) a block keeps cells, column by column with a rim.
    """

    @ti.func
    def straight(
        _here: ti.template(), _prey: ti.template(), _a, me: ti.template(), target: ti.template(), numbers: ti.template(), b
    ):
        """Give the whole way to the target."""
        return see.sight(target, me, numbers, b)

    if not layout.structure.frame.plan:
        return Planning(plan=straight, way=straight)
    grid = _grid(layout)
    return Planning(plan=_search(layout, types, grid), way=_follow(layout, types, grid))


def _grid(layout: ParameterTable) -> _Grid:
    at, width = layout.at, len(layout.paths)
    across, up, tall = layout.plan.across, layout.plan.up, layout.plan.up + 2

    @ti.func
    def base_of(b, counts):
        return b * (layout.board.fixed + layout.board.each * counts[0])

    @ti.func
    def cell_of(spot: ti.template(), numbers: ti.template(), b):
        """Give the cell of a place, or the nearest one to a place off the map, as a number from 0."""
        side = numbers[b * width + at.planning.cell]
        x = ti.floor(smaller(larger(spot[0] / side, 0.0), across - 0.5))  # what is no number becomes 0
        y = ti.floor(smaller(larger(spot[1] / side, 0.0), up - 0.5))
        return (x + 1.0) * tall + y + 1.0

    @ti.func
    def centre_of(cell, numbers: ti.template(), b):
        side = numbers[b * width + at.planning.cell]
        x = ti.floor((cell + 0.5) / tall)
        return [side * (x - 0.5), side * (cell - tall * x - 0.5)]

    return _Grid(base_of=base_of, cell_of=cell_of, centre_of=centre_of)


def _search(layout: ParameterTable, types: Types, map_of: _Grid) -> Func:
    """Build `plan`."""
    lanes, real = types.lanes, types.real
    at, rows, width, grid = layout.at, layout.rows, len(layout.paths), layout.plan
    across, up, tall, cells = grid.across, grid.up, grid.up + 2, grid.cells
    agent_rows = layout.agent_rows["prey"]
    # What a step out of a blocked cell costs: more than any free way, so that those who got in there get out again.
    wall = 2.0 * cells

    @ti.func
    def block_disc(board: ti.template(), base, lane, x, y, reach):
        """Mark the cells whose centres lie in a disc, in one lane. x, y, reach: in sides of a cell."""
        first, last = ti.max(ti.ceil(x - reach), 1.0), ti.min(ti.floor(x + reach), ti.cast(across, real))
        low, high = ti.max(ti.ceil(y - reach), 1.0), ti.min(ti.floor(y + reach), ti.cast(up, real))
        for k in range(ti.cast(first, ti.i32), ti.cast(last, ti.i32) + 1):
            for i in range(ti.cast(low, ti.i32), ti.cast(high, ti.i32) + 1):
                off_x, off_y = ti.cast(k, real) - x, ti.cast(i, real) - y
                if off_x * off_x + off_y * off_y <= reach * reach:
                    board[base + grid.wall + k * tall + i][lane] = ti.cast(wall, real)

    @ti.func
    def block_cells(board: ti.template(), base, obstacles: ti.template(), numbers: ti.template(), b, count, fresh):
        """Clear the grid, and mark what obstacles block. Only lanes that are fresh have any: the others have their ways."""
        for c in range(cells):
            board[base + grid.length + c] = lanes(NEVER)
            board[base + grid.wall + c] = lanes(0.0)
        for lane in range(LANES):
            if ti.select(fresh, 1.0, 0.0)[lane] > 0.5:
                side = numbers[b * width + at.planning.cell][lane]
                for j in range(count):
                    o = (b * count + j) * layout.obstacle_rows
                    x, y = obstacles[o][lane] / side + 0.5, obstacles[o + 1][lane] / side + 0.5  # cell k's centre is at k
                    reach = (obstacles[o + 2][lane] + numbers[b * width + at.planning.clearance][lane]) / side
                    if x - reach < across + 1.0:  # obstacles that a trial does not have lie far away
                        block_disc(board, base, lane, x, y, reach)

    @ti.func
    def sweep(board: ti.template(), base, first, step):
        """Carry lengths on from column to column, and up and down within each."""
        for k in range(across):
            column = base + grid.length + (first + step * k) * tall
            walls = base + grid.wall + (first + step * k) * tall
            before = column - step * tall
            for y in range(1, up + 1):
                slant = smaller(board[before + y - 1], board[before + y + 1]) + DIAGONAL
                reached = smaller(board[before + y] + 1.0, slant)
                board[column + y] = smaller(board[column + y], reached + board[walls + y])
            rising, falling = lanes(NEVER), lanes(NEVER)  # side by side: each waits for its last sum
            for y in range(1, up + 1):
                rising = smaller(board[column + y], rising + 1.0 + board[walls + y])
                board[column + y] = rising
                down = up + 1 - y
                falling = smaller(board[column + down], falling + 1.0 + board[walls + down])
                board[column + down] = falling

    @ti.func
    def point(board: ti.template(), base, fresh):
        """Let each cell point to the next one. Give 1 in lanes where a shorter way is left to find."""
        left = lanes(0.0)
        for x in range(1, across + 1):
            for y in range(1, up + 1):
                c = base + x * tall + y
                least, code = lanes(NEVER), lanes(ti.cast(STAY, real))
                for k, j, step in ti.static(STEPS):
                    length = board[c + (grid.length + k * tall + j)] + (DIAGONAL if ti.static(k and j) else 1.0)
                    shorter = length < least
                    least = ti.select(shorter, length, least)
                    code = ti.select(shorter, ti.cast(step, real), code)
                own, barred = board[c + grid.length], board[c + grid.wall]
                left = ti.select(least + barred < own, 1.0, left)
                # The target has no next cell, nor has who would have to break through: the straight line is all that is left.
                leads = (own > 0.5) & ((own < wall) | (barred > 0.5))
                board[c] = ti.select(fresh, ti.select(leads, code, ti.cast(STAY, real)), board[c])
        return left

    @ti.func
    def plan(here: ti.template(), fresh):
        """Find the next cell of every cell, and the cell that each prey starts in, in lanes that are fresh (a mask).

        Only one set of lengths has length(c) = the least of a step and a neighbour's length, in whatever order they are found:
        what else is in the block, and so how often is swept, changes no bit.
        """
        b, counts = here.b, here.counts
        prey, obstacles, numbers, board = ti.static(here.prey, here.obstacles, here.numbers, here.board)
        base = map_of.base_of(b, counts)
        block_cells(board, base, obstacles, numbers, b, counts[2], fresh)
        goal = map_of.cell_of([numbers[b * width + at.target.place[0]], numbers[b * width + at.target.place[1]]], numbers, b)
        for lane in range(LANES):
            board[base + grid.length + ti.cast(goal[lane], ti.i32)][lane] = ti.cast(0.0, real)
        searching = 1
        while searching == 1:
            sweep(board, base, 1, 1)
            sweep(board, base, across, -1)
            searching = ti.select(anywhere(point(board, base, fresh) > 0.5), 1, 0)
        if ti.static(layout.structure.frame.plan == "list"):
            for i in range(counts[0]):
                a = (b * counts[0] + i) * agent_rows
                start = map_of.cell_of([prey[a + rows.place[0]], prey[a + rows.place[1]]], numbers, b)
                prey[a + rows.plan] = ti.select(fresh, start, prey[a + rows.plan])

    return plan


def _follow(layout: ParameterTable, types: Types, map_of: _Grid) -> Func:
    """Build `way` for prey that plan."""
    lanes = types.lanes
    rows, grid, tall = layout.rows, layout.plan, layout.plan.up + 2
    listed = layout.structure.frame.plan == "list"

    @ti.func
    def code_at(board: ti.template(), base, cell):
        return lanes([board[base + grid.next + ti.cast(cell[lane], ti.i32)][lane] for lane in ti.static(range(LANES))])

    @ti.func
    def after(cell, code):
        """Give the cell behind the step of a code."""
        column = ti.floor((code + 0.5) / 3.0)
        return cell + (column - 1.0) * tall + code - 3.0 * column - 1.0

    @ti.func
    def along_list(board: ti.template(), base, start, me: ti.template(), numbers: ti.template(), b):
        """Give the point behind the nearest one of the plan, the last excluded, that leads from a cell to the target."""
        cell = start + 0.0
        aim = map_of.centre_of(cell, numbers, b)
        nearest = lanes(NEVER)
        code = code_at(board, base, cell)
        while anywhere(code != float(STAY)):
            here, cell = map_of.centre_of(cell, numbers, b), after(cell, code)
            there = map_of.centre_of(cell, numbers, b)
            off = [here[k] - place(me)[k] for k in ti.static(range(2))]
            distance2 = dot(off, off)
            nearer = (code != float(STAY)) & (distance2 < nearest)
            nearest = ti.select(nearer, distance2, nearest)
            for k in ti.static(range(2)):
                aim[k] = ti.select(nearer, there[k], aim[k])
            code = code_at(board, base, cell)
        return aim + [nearest]  # noqa: RUF005 - Taichi knows no stars in lists

    @ti.func
    def planned_way(
        here: ti.template(), prey: ti.template(), a, me: ti.template(), target: ti.template(), numbers: ti.template(), b
    ):
        """Give the direction to the next point of the plan, one long; straight to the target where there is none."""
        base = map_of.base_of(b, here.counts)
        aim = [1.0 * each for each in ti.static(place(target))]
        if ti.static(listed):
            found = along_list(here.board, base, prey[a + rows.plan], me, numbers, b)
            for k in ti.static(range(2)):
                aim[k] = ti.select(found[2] < NEVER, found[k], aim[k])
        else:
            cell = map_of.cell_of(place(me), numbers, b)
            code = code_at(here.board, base, cell)
            spot = map_of.centre_of(after(cell, code), numbers, b)
            for k in ti.static(range(2)):
                aim[k] = ti.select(code != float(STAY), spot[k], aim[k])
        return unit([aim[k] - place(me)[k] for k in ti.static(range(2))])

    return planned_way
