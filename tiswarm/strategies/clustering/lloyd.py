"""Lloyd: K-means as scikit-learn fits it, in lanes: greedy k-means++ starts, the best of ten, centres in the order drawn."""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.simd import philox
from tiswarm.simd.lanes import anywhere, dot, larger, smaller
from tiswarm.simd.runtime import Func, Types

STARTS = 10
"""Starts of a fit, scikit-learn's default."""

TRIES = 4
"""Room for the places that greedy k-means++ tries for one centre: 2 + ⌊ln k⌋, up to k = 8."""

ROUNDS = 64
"""Most rounds of assigning and averaging; most starts settle in three."""

SAME = 1.0 + 1e-4
"""An inertia this near to the least one is that of the best partition: no further start can better it."""

BEYOND = 1e30
"""More than any squared distance within the world's limits [m²]."""


@dataclass(frozen=True)
class Draw:
    """The fit of one predator."""

    draw: Func


def _away_from(dim: int, at: Any) -> Func:
    @ti.func
    def away_from(board: ti.template(), r, n, i, centre):
        """Give the way from a place to a prey."""
        return [board[r + at.points + (at.place + k) * n + i] - centre[k] for k in ti.static(range(dim))]

    return away_from


def _scatter(types: Types, dim: int, most: int, at: Any, uniform: Func) -> Func:
    """Build the start of a fit."""
    lanes, real = types.lanes, types.real
    away_from = _away_from(dim, at)

    @ti.func
    def prey_at(board: ti.template(), r, n, share):
        """Give the place of the prey at a share of the way along the sum of all weights."""
        weight = r + at.points + at.weight * n
        total = lanes(0.0)
        for i in range(n):
            total += board[weight + i]
        passed = lanes(0.0)
        there = [lanes(0.0) for _ in ti.static(range(dim))]
        for i in range(n):
            before = passed
            passed += board[weight + i]
            here = (before <= share * total) & (passed > share * total)
            for k in ti.static(range(dim)):
                there[k] = ti.select(here, board[r + at.points + (at.place + k) * n + i], there[k])
        return there

    @ti.func
    def left_by(board: ti.template(), r, n, there):
        """Give what is left of the squared distances to the nearest centre when one more is put there."""
        left = lanes(0.0)
        for i in range(n):
            away = away_from(board, r, n, i, there)
            reached = smaller(dot(away, away), board[r + at.points + at.weight * n + i])
            left += board[r + at.points + at.alive * n + i] * reached
        return left

    @ti.func
    def scatter(board: ti.template(), r, n, clusters, count, start, trial, tick, key_low, key_high):
        """Put centres on prey: the first on any, each further one on the best of a few drawn by their squared distance.

        Greedy k-means++ (Arthur, Vassilvitskii 2007, section 5, as scikit-learn has it). start: its number in the stream.
        """
        weight = r + at.points + at.weight * n
        for i in range(n):
            board[weight + i] = board[r + at.points + at.alive * n + i]
        tries = ti.select(clusters > 2.5, ti.select(clusters > 7.5, 4.0, 3.0), 2.0)
        most_tries = ti.cast(tries.max() + 0.5, ti.i32)
        for c in range(count):
            chosen = [lanes(0.0) for _ in ti.static(range(dim))]
            least = lanes(BEYOND)
            attempts = 1
            if c > 0:
                attempts = most_tries
            for attempt in range(attempts):
                index = types.integer_lanes(ti.cast((start * most + c) * TRIES + attempt, ti.u32))
                share, _, _, _ = uniform(key_low, key_high, trial, philox.CENTRES, index, tick)
                there = prey_at(board, r, n, share)
                left = lanes(0.0)
                if c > 0:
                    left = left_by(board, r, n, there)
                better = (left < least) & (ti.cast(attempt, real) < tries)
                least = ti.select(better, left, least)
                for k in ti.static(range(dim)):
                    chosen[k] = ti.select(better, there[k], chosen[k])
            for k in ti.static(range(dim)):
                board[r + at.middle + c * dim + k] = chosen[k]
            if c < count - 1:
                for i in range(n):
                    away = away_from(board, r, n, i, chosen)
                    nearest = ti.select(lanes(0.0) + ti.cast(c, real) < 0.5, BEYOND, board[weight + i])
                    board[weight + i] = board[r + at.points + at.alive * n + i] * smaller(dot(away, away), nearest)

    return scatter


def _settle(types: Types, dim: int, at: Any) -> Func:
    """Build the rounds of a fit."""
    lanes, real = types.lanes, types.real
    away_from = _away_from(dim, at)

    @ti.func
    def middle_of(board: ti.template(), r, c):
        return [board[r + at.middle + c * dim + k] for k in ti.static(range(dim))]

    @ti.func
    def assign(board: ti.template(), r, n, clusters, count):
        """Give each prey to its nearest centre; tell how many changed theirs, and the inertia, summed prey by prey.

        So partitions that differ in the order of their centres alone have one inertia, to the bit.
        """
        draft = r + at.points + at.draft * n
        changed, inertia = lanes(0.0), lanes(0.0)
        for i in range(n):
            nearest, own = lanes(BEYOND), lanes(0.0)
            for c in range(count):
                away = away_from(board, r, n, i, middle_of(board, r, c))
                distance2 = dot(away, away)
                closer = (distance2 < nearest) & (ti.cast(c, real) < clusters - 0.5)
                own = ti.select(closer, ti.cast(c, real), own)
                nearest = ti.select(closer, distance2, nearest)
            alive = board[r + at.points + at.alive * n + i]
            own = ti.select(alive > 0.5, own, -1.0)
            changed += ti.select(own == board[draft + i], 0.0, 1.0)
            inertia += alive * nearest
            board[draft + i] = own
        return changed, inertia

    @ti.func
    def average(board: ti.template(), r, n, count):
        """Put each centre at the mean of its prey; one that nobody is near stays."""
        for c in range(count):
            size = lanes(0.0)
            total = [lanes(0.0) for _ in ti.static(range(dim))]
            for i in range(n):
                own = ti.select(board[r + at.points + at.draft * n + i] == ti.cast(c, real), 1.0, 0.0)
                size += own
                for k in ti.static(range(dim)):
                    total[k] += own * board[r + at.points + (at.place + k) * n + i]
            for k in ti.static(range(dim)):
                row = r + at.middle + c * dim + k
                board[row] = ti.select(size > 0.5, total[k] / larger(size, 1.0), board[row])

    @ti.func
    def settle(board: ti.template(), r, n, clusters, count):
        """Assign and average in turns until no prey changes its cluster; give the inertia. Settled lanes stay as they are."""
        for i in range(n):
            board[r + at.points + at.draft * n + i] = lanes(-2.0)
        inertia = lanes(0.0)
        rounds = 0
        while rounds < ROUNDS:
            rounds += 1
            changed, inertia = assign(board, r, n, clusters, count)
            if anywhere(changed > 0.5):
                average(board, r, n, count)
            else:
                rounds = ROUNDS
        return inertia

    return settle


def build(types: Types, dim: int, most: int, at: Any, uniform) -> Draw:
    """Build `draw`, which works on rows of a board that begin at row r, once the prey's places are there.

    most: clusters that there may be. at: the first rows of middle (cluster * dim) and inertia (k - 1), and of the rows for each
    prey, of which there are n: alive, place (axis, prey), draft, weight and drawn.
    """
    lanes, real = types.lanes, types.real
    scatter, settle = _scatter(types, dim, most, at, uniform), _settle(types, dim, at)

    @ti.func
    def draw(board: ti.template(), r, n, clusters, wanted, asked, number, trial, tick, key_low, key_high):
        """Fit anew, and leave 1 in `drawn` for the prey of the centre at place `wanted`, 0 for all others.

        clusters, wanted, asked: [lane]; asked: 1 where a fit is wanted; number: of whom it is for. As in scikit-learn the
        first of equally good starts counts, so that centres have the order in which its k-means++ drew them.
        """
        count = ti.cast(ti.select(asked > 0.5, clusters, 1.0).max() + 0.5, ti.i32)  # the most of any lane
        unsettled = asked
        least = lanes(BEYOND)
        drawn = r + at.points + at.drawn * n
        target = lanes(0.0)
        for k in range(most):
            target = ti.select(clusters == ti.cast(k + 1, real), board[r + at.inertia + k], target)
        for start in range(STARTS):
            if anywhere(unsettled > 0.5):
                scatter(board, r, n, clusters, count, number * STARTS + start, trial, tick, key_low, key_high)
                found = settle(board, r, n, clusters, count)
                better = (unsettled > 0.5) & (found < least)
                least = ti.select(better, found, least)
                for i in range(n):
                    own = ti.select(board[r + at.points + at.draft * n + i] == wanted, 1.0, 0.0)
                    board[drawn + i] = ti.select(better, own, board[drawn + i])
                unsettled = ti.select(found <= SAME * target, 0.0, unsettled)

    return Draw(draw=draw)
