"""Joint solution: velocities under which the constraints of a lane's list hold, as near to the commands as can be.

Hildreth's method with over-relaxation on the forces (multipliers) of the constraints: each in turn takes the force at which it
just holds, until none changes. Mostly all of a list hold as equations in the end: it begins with the forces that solve these
directly, where none of them pulls.
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.barrier import tolerance
from tiswarm.dynamics.rows import JOINT_AGENT, JOINT_CONSTRAINT, JOINT_FIRST, JOINT_LENGTH, JOINT_SIDE, JOINT_SQUARE
from tiswarm.dynamics.table import ParameterTable
from tiswarm.scenario.barrier import MOST_JOINT
from tiswarm.simd.lanes import row_of
from tiswarm.simd.runtime import Func, Types

# Rows of an agent: point and velocity. Rows of a constraint a·(u - u') <= bound: both agents (the second a wall, which stays
# where it is), a, its bound, the force that a unit of excess takes, and its force.
X, Y, U, V = range(JOINT_AGENT)
ONE, OTHER, ACROSS, UP, BOUND, GIVE, FORCE = range(JOINT_CONSTRAINT)

WALL = MOST_JOINT
SWEEPS = 4000
"""Most times that a list is gone through; twenty robots who press to one point need a hundred or two."""

RELAXATION, PLAIN = 1.5, 12
"""Over-relaxation, after so many sweeps: a heap of twenty then takes a third of the sweeps, and few or lone pairs need none."""


@dataclass(frozen=True)
class Solution:
    """Funcs that work on the list of one lane."""

    guess: Func  # solve the equations of a short list, and let its forces act
    solve: Func  # change velocities until each constraint holds
    slacken: Func  # slow all prey down until every constraint holds


def build(layout: ParameterTable, types: Types) -> Solution:
    """Build them."""
    solve, slacken = _solver(types)
    return Solution(guess=_guess(layout, types), solve=solve, slacken=slacken)


def _guess(layout: ParameterTable, types: Types) -> Func:
    """Build what gives a lane's list its first forces."""
    motion, prey_rows = layout.rows.next_motion, layout.agent_rows["prey"]
    least = 1e-3 if types.real == ti.f32 else 1e-6

    @ti.func
    def common(board: ti.template(), e, f, lane):
        """Give the scalar product of two constraints' rows in A."""
        one, other = board[e + ONE][lane], board[e + OTHER][lane]
        first, second = board[f + ONE][lane], board[f + OTHER][lane]
        shared = ti.select(one == first, 1.0, 0.0) - ti.select(one == second, 1.0, 0.0)
        shared += ti.select((other == second) & (other < WALL - 0.5), 1.0, 0.0) - ti.select(other == first, 1.0, 0.0)
        along = board[e + ACROSS][lane] * board[f + ACROSS][lane] + board[e + UP][lane] * board[f + UP][lane]
        return ti.cast(shared * along, types.real)

    @ti.func
    def decompose(board: ti.template(), base, lane, length):
        """Write A Aᵀ = L D Lᵀ into the square; give 1, or 0 where constraints depend on each other."""
        able = 1
        for k in range(length):
            own = base + JOINT_SQUARE + JOINT_SIDE * k
            for n in range(k + 1):
                e, f = base + JOINT_FIRST + JOINT_CONSTRAINT * k, base + JOINT_FIRST + JOINT_CONSTRAINT * n
                left = common(board, e, f, lane)
                whole = left
                row = base + JOINT_SQUARE + JOINT_SIDE * n
                for m in range(n):
                    left -= (
                        board[own + m][lane] * board[row + m][lane] * board[base + JOINT_SQUARE + (JOINT_SIDE + 1) * m][lane]
                    )
                if n < k:
                    left = left / board[row + n][lane]
                elif left <= least * whole:
                    able = 0
                    left = 1.0
                board[own + n][lane] = left
        return able

    @ti.func
    def reset(board: ti.template(), base, lane, length, prey: ti.template(), first):
        """Let all whom a list concerns have their commands again, and note how far each bound is exceeded."""
        for k in range(length):
            e = base + JOINT_FIRST + JOINT_CONSTRAINT * k
            excess = 0.0 - board[e + BOUND][lane]
            for end in ti.static((ONE, OTHER)):
                i = ti.cast(board[e + end][lane], ti.i32)
                if i != WALL:
                    for axis in ti.static(range(2)):
                        u = prey[row_of(first + i, prey_rows) + motion[axis]][lane]
                        board[base + JOINT_AGENT * i + (U + axis)][lane] = u
                        excess += (u if ti.static(end == ONE) else 0.0 - u) * board[e + (ACROSS + axis)][lane]
            board[e + FORCE][lane] = excess

    @ti.func
    def substitute(board: ti.template(), base, lane, length):
        """Turn what is exceeded into forces; give 1, or 0 where any of them pulls."""
        pushing = 1
        for k in range(length):
            e = base + JOINT_FIRST + JOINT_CONSTRAINT * k + FORCE
            left = board[e][lane]
            for m in range(k):
                force = board[base + JOINT_FIRST + JOINT_CONSTRAINT * m + FORCE][lane]
                left -= board[base + JOINT_SQUARE + JOINT_SIDE * k + m][lane] * force
            board[e][lane] = left
        for back in range(length):
            k = length - 1 - back
            e = base + JOINT_FIRST + JOINT_CONSTRAINT * k + FORCE
            left = board[e][lane] / board[base + JOINT_SQUARE + (JOINT_SIDE + 1) * k][lane]
            for m in range(k + 1, length):
                force = board[base + JOINT_FIRST + JOINT_CONSTRAINT * m + FORCE][lane]
                left -= board[base + JOINT_SQUARE + JOINT_SIDE * m + k][lane] * force
            board[e][lane] = left
            if left < 0.0:
                pushing = 0
        return pushing

    @ti.func
    def guess(board: ti.template(), base, lane, prey: ti.template(), first):
        """Solve the equations of a short list, and let its forces act; one that has no such solution begins without."""
        length = ti.cast(board[base + JOINT_LENGTH][lane], ti.i32)
        if length <= JOINT_SIDE:
            reset(board, base, lane, length, prey, first)
            solved = decompose(board, base, lane, length)
            if solved == 1:
                solved = substitute(board, base, lane, length)
            for k in range(length):
                e = base + JOINT_FIRST + JOINT_CONSTRAINT * k
                force = ti.cast(ti.select(solved == 1, board[e + FORCE][lane], 0.0), types.real)
                board[e + FORCE][lane] = force
                for axis in ti.static(range(2)):
                    push = force * board[e + (ACROSS + axis)][lane]
                    p = base + JOINT_AGENT * ti.cast(board[e + ONE][lane], ti.i32) + (U + axis)
                    board[p][lane] = board[p][lane] - push
                    j = ti.cast(board[e + OTHER][lane], ti.i32)
                    if j != WALL:
                        q = base + JOINT_AGENT * j + (U + axis)
                        board[q][lane] = board[q][lane] + push

    return guess


def _solver(types: Types) -> tuple[Func, Func]:
    """Build what goes through a lane's list, and what slows a lane down whose list has not come to rest."""
    slack = tolerance(types)

    @ti.func
    def solve(board: ti.template(), base, lane):
        """Change velocities until each constraint of a lane's list holds; give 1, or 0 where that takes too many sweeps."""
        length = ti.cast(board[base + JOINT_LENGTH][lane], ti.i32)
        left = SWEEPS
        while left > 0:
            rest = ti.cast(0.0, types.real)
            relaxed = ti.cast(ti.select(left > SWEEPS - PLAIN, 1.0, RELAXATION), types.real)
            for k in range(length):
                e = base + JOINT_FIRST + JOINT_CONSTRAINT * k
                p = base + JOINT_AGENT * ti.cast(board[e + ONE][lane], ti.i32)
                j = ti.cast(board[e + OTHER][lane], ti.i32)
                q = base + JOINT_AGENT * j
                across, up, give, force = (
                    board[e + ACROSS][lane],
                    board[e + UP][lane],
                    board[e + GIVE][lane],
                    board[e + FORCE][lane],
                )
                own = [board[p + (U + k)][lane] for k in ti.static(range(2))]
                their = [board[q + (U + k)][lane] for k in ti.static(range(2))]
                over = across * (own[0] - their[0]) + up * (own[1] - their[1]) - board[e + BOUND][lane]
                raised = ti.max(force + relaxed * give * over, 0.0)
                step = raised - force
                board[e + FORCE][lane] = raised
                board[p + U][lane] = own[0] - step * across
                board[p + V][lane] = own[1] - step * up
                if j != WALL:
                    board[q + U][lane] = their[0] + step * across
                    board[q + V][lane] = their[1] + step * up
                rest = ti.max(rest, ti.abs(step) * (across * across + up * up))
            left = ti.select(rest <= slack, -1, left - 1)
        return ti.select(left < 0, 1, 0)

    @ti.func
    def slacken(board: ti.template(), base, lane, count):
        """Slow all prey of a lane down until every constraint holds: with less of all velocities each does that lets rest."""
        share = ti.cast(1.0, types.real)
        for k in range(ti.cast(board[base + JOINT_LENGTH][lane], ti.i32)):
            e = base + JOINT_FIRST + JOINT_CONSTRAINT * k
            p = base + JOINT_AGENT * ti.cast(board[e + ONE][lane], ti.i32)
            q = base + JOINT_AGENT * ti.cast(board[e + OTHER][lane], ti.i32)
            along = board[e + ACROSS][lane] * (board[p + U][lane] - board[q + U][lane])
            along += board[e + UP][lane] * (board[p + V][lane] - board[q + V][lane])
            bound = board[e + BOUND][lane]
            if bound >= 0.0 and along > bound:
                share = ti.min(share, bound / along)
        for i in range(count):
            for k in ti.static((U, V)):
                row = base + JOINT_AGENT * i + k
                board[row][lane] = share * board[row][lane]

    return solve, slacken
