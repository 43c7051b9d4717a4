"""Search: K-means of many points in lanes: several starts each, then single points change clusters while that helps."""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.simd import philox
from tiswarm.simd.lanes import anywhere, dot, larger
from tiswarm.simd.runtime import Func, Types

SWEEPS = 64
"""Most rounds over all points from one start; most settle in five."""

WORTH = 1.0 - 1e-6
"""A point moves when that costs less than this share of what its leaving saves: rounding never makes it go in circles."""

BEYOND = 1e30
"""More than any squared distance within the world's limits [m²]."""


@dataclass(frozen=True)
class Search:
    """The search for many points."""

    search: Func


@dataclass(frozen=True)
class _Starts:
    """Where middles begin."""

    grow: Func
    scatter: Func


def _away_from(dim: int, at: Any) -> Func:
    @ti.func
    def away_from(board: ti.template(), r, n, i, c):
        """Give the way from a cluster's middle to a point."""
        return [
            board[r + at.points + (at.place + k) * n + i] - board[r + at.middle + c * dim + k] for k in ti.static(range(dim))
        ]

    return away_from


def _settle(types: Types, dim: int, at: Any) -> Func:
    """Build the way from a start to a partition."""
    lanes, away_from = types.lanes, _away_from(dim, at)

    @ti.func
    def resize(board: ti.template(), r, c, size):
        """Set a cluster's size, and by what a squared distance counts when a point leaves or joins it (Hartigan 1975)."""
        board[r + at.size + c] = size
        board[r + at.leave + c] = ti.select(size > 1.5, size / larger(size - 1.0, 1.0), 0.0)
        board[r + at.join + c] = size / (size + 1.0)

    @ti.func
    def gather(board: ti.template(), r, n, c):
        """Put a cluster's middle at the mean of its points."""
        size = lanes(0.0)
        total = [lanes(0.0) for _ in ti.static(range(dim))]
        for i in range(n):
            own = board[r + at.points + at.draft * n + i] == ti.cast(c, types.real)
            share = ti.select(own, board[r + at.points + at.alive * n + i], 0.0)
            size += share
            for k in ti.static(range(dim)):
                total[k] += share * board[r + at.points + (at.place + k) * n + i]
        for k in ti.static(range(dim)):
            board[r + at.middle + c * dim + k] = total[k] / larger(size, 1.0)
        resize(board, r, c, size)

    @ti.func
    def choose_nearest(board: ti.template(), r, n, clusters):
        draft = r + at.points + at.draft * n
        for i in range(n):
            nearest, chosen = lanes(BEYOND), lanes(0.0)
            for c in range(clusters):
                away = away_from(board, r, n, i, c)
                distance2 = dot(away, away)
                chosen = ti.select(distance2 < nearest, ti.cast(c, types.real), chosen)
                nearest = ti.select(distance2 < nearest, distance2, nearest)
            board[draft + i] = chosen
        for c in range(clusters):
            gather(board, r, n, c)

    @ti.func
    def change(board: ti.template(), r, n, i, clusters, moves, own, to):
        """Let a point change clusters in the lanes of a mask."""
        for c in range(clusters):
            comes = ti.select(moves & (to == ti.cast(c, types.real)), 1.0, 0.0)
            net = comes - ti.select(moves & (own == ti.cast(c, types.real)), 1.0, 0.0)
            size = board[r + at.size + c] + net
            share = net / larger(size, 1.0)
            away = away_from(board, r, n, i, c)
            for k in ti.static(range(dim)):
                middle = r + at.middle + c * dim + k
                board[middle] = board[middle] + share * away[k]
            resize(board, r, c, size)

    @ti.func
    def settle(board: ti.template(), r, n, clusters):
        """Go from some middles to a partition that no change of one point betters; give its inertia."""
        choose_nearest(board, r, n, clusters)
        draft = r + at.points + at.draft * n
        sweeps = 0
        while sweeps < SWEEPS:
            sweeps += 1
            moved = lanes(0.0)
            for i in range(n):
                own = board[draft + i]
                saved, cost, to = lanes(0.0), lanes(BEYOND), own
                for c in range(clusters):
                    away = away_from(board, r, n, i, c)
                    distance2 = dot(away, away)
                    mine = own == ti.cast(c, types.real)
                    saved += ti.select(mine, distance2 * board[r + at.leave + c], 0.0)
                    joining = ti.select(mine, BEYOND, distance2 * board[r + at.join + c])
                    to = ti.select(joining < cost, ti.cast(c, types.real), to)
                    cost = ti.select(joining < cost, joining, cost)
                moves = (cost < WORTH * saved) & (board[r + at.points + at.alive * n + i] > 0.5)
                if anywhere(moves):
                    change(board, r, n, i, clusters, moves, own, to)
                    board[draft + i] = ti.select(moves, to, own)
                    moved += ti.select(moves, 1.0, 0.0)
            if not anywhere(moved > 0.5):
                sweeps = SWEEPS
        inertia = lanes(0.0)
        for c in range(clusters):
            for i in range(n):
                away = away_from(board, r, n, i, c)
                own = board[draft + i] == ti.cast(c, types.real)
                inertia += ti.select(own, board[r + at.points + at.alive * n + i] * dot(away, away), 0.0)
        return inertia

    return settle


def _starts(types: Types, dim: int, most: int, at: Any, uniform: Func) -> _Starts:
    lanes, away_from = types.lanes, _away_from(dim, at)

    @ti.func
    def grow(board: ti.template(), r, n, clusters, i):
        """Start with one cluster less as it was best, and point i as a new one (Likas, Vlassis, Verbeek 2003)."""
        for each in range((clusters - 1) * dim):
            board[r + at.middle + each] = board[r + at.base + each]
        for k in ti.static(range(dim)):
            board[r + at.middle + (clusters - 1) * dim + k] = board[r + at.points + (at.place + k) * n + i]

    @ti.func
    def scatter(board: ti.template(), r, n, clusters, attempt, trial, tick, key_low, key_high):
        """Put middles on points drawn by their squared distance from those before (K-means++, Arthur, Vassilvitskii 2007)."""
        weight = r + at.points + at.weight * n
        for i in range(n):
            board[weight + i] = board[r + at.points + at.alive * n + i]
        for c in range(clusters):
            index = types.integer_lanes(ti.cast((attempt * most + clusters) * most + c, ti.u32))
            share, _, _, _ = uniform(key_low, key_high, trial, philox.CLUSTERS, index, tick)
            total = lanes(0.0)
            for i in range(n):
                total += board[weight + i]
            passed = lanes(0.0)
            place = [lanes(0.0) for _ in ti.static(range(dim))]
            for i in range(n):
                before = passed
                passed += board[weight + i]
                here = (before <= share * total) & (passed > share * total)
                for k in ti.static(range(dim)):
                    place[k] = ti.select(here, board[r + at.points + (at.place + k) * n + i], place[k])
            for k in ti.static(range(dim)):
                board[r + at.middle + c * dim + k] = place[k]
            for i in range(n):
                away = away_from(board, r, n, i, c)
                alive = board[r + at.points + at.alive * n + i]
                least = ti.select(lanes(0.0) + ti.cast(c, types.real) < 0.5, BEYOND, board[weight + i])
                distance2 = alive * dot(away, away)
                board[weight + i] = ti.select(distance2 < least, distance2, least)

    return _Starts(grow=grow, scatter=scatter)


def build(types: Types, dim: int, most: int, at: Any, uniform) -> Search:
    """Build `search`, which works on rows of a board that begin at row r.

    most: clusters that there may be. at: the first rows of middle, base and best_middle (cluster * dim), size, leave and join
    (cluster), inertia (k - 1), and of the rows for each point, of which there are n: label, alive, place (axis, point),
    draft, weight, and kept (k - 1, point).
    """
    lanes = types.lanes
    settle, starts = _settle(types, dim, at), _starts(types, dim, most, at, uniform)

    @ti.func
    def keep_better(board: ti.template(), r, n, clusters, allowed):
        """Settle from the middles as they are, and keep the partition in the lanes where it is the best so far."""
        found = settle(board, r, n, clusters)
        row = r + at.inertia + clusters - 1
        better = (found < board[row]) & (allowed > 0.5)
        board[row] = ti.select(better, found, board[row])
        kept = r + at.points + (at.kept + clusters - 1) * n
        for i in range(n):
            board[kept + i] = ti.select(better, board[r + at.points + at.draft * n + i], board[kept + i])
        for each in range(clusters * dim):
            board[r + at.best_middle + each] = ti.select(better, board[r + at.middle + each], board[r + at.best_middle + each])

    @ti.func
    def search(board: ti.template(), r, n, clusters, restarts, trial, tick, key_low, key_high):
        """Find partitions of small inertia into 1, 2, ..., `clusters` clusters; restarts: drawn starts for each, [lane]."""
        most_restarts = ti.cast(restarts.max() + 0.5, ti.i32)
        for each in range(dim):
            board[r + at.middle + each] = lanes(0.0)
        for k in range(1, clusters + 1):
            board[r + at.inertia + k - 1] = lanes(BEYOND)
            for each in range(most * dim):
                board[r + at.base + each] = board[r + at.best_middle + each]
            attempts = 1
            if k > 1:
                attempts = n + most_restarts
            for attempt in range(attempts):
                allowed = lanes(1.0)
                if k > 1 and attempt < n:
                    starts.grow(board, r, n, k, attempt)
                    allowed = board[r + at.points + at.alive * n + attempt]
                if attempt >= n:
                    starts.scatter(board, r, n, k, attempt - n, trial, tick, key_low, key_high)
                    allowed = ti.select(restarts > ti.cast(attempt - n, types.real) + 0.5, 1.0, 0.0)
                keep_better(board, r, n, k, allowed)

    return Search(search=search)
