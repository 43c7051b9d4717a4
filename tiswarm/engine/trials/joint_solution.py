"""Joint solution: velocities under which the constraints of a lane's list hold, as near to the commands as can be.

Hildreth's method with over-relaxation on the forces (multipliers) of the constraints: each in turn takes the force at which it
just holds, until none changes. (To begin with the forces that solve a list as equations, which they mostly do, took as long.)
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.barrier import tolerance
from tiswarm.dynamics.rows import JOINT_AGENT, JOINT_CONSTRAINT, JOINT_FIRST, JOINT_LENGTH
from tiswarm.scenario.barrier import MOST_JOINT
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

    solve: Func  # change velocities until each constraint holds
    slacken: Func  # slow all prey down until every constraint holds


def build(types: Types) -> Solution:
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
            bound = board[e + BOUND][lane] + 2.0 * slack  # the one that must hold
            if bound >= 0.0 and along > bound:
                share = ti.min(share, bound / along)
        for i in range(count):
            for k in ti.static((U, V)):
                row = base + JOINT_AGENT * i + k
                board[row][lane] = share * board[row][lane]

    return Solution(solve=solve, slacken=slacken)
