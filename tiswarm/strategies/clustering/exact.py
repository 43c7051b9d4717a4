"""Exact: the best of all ways to split up to eight points into k clusters, by dynamic programming over their subsets."""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.simd.lanes import dot, smaller
from tiswarm.simd.runtime import Func, Types

FEW = 8
"""Points for which all partitions are compared: 3⁷/2 pairs of subsets for each k."""

SUBSETS = 1 << FEW

IMPOSSIBLE = 1e30
"""Inertia of a set that has fewer points than clusters [m²]; beyond that of any swarm within the world's limits."""


@dataclass(frozen=True)
class ExactSearch:
    """Funcs of the search over subsets."""

    compare: Func  # find the least inertia of each subset that matters, in k = 1 to `most` clusters
    trace: Func


def build(types: Types, dim: int, at: Any) -> ExactSearch:
    """Build `compare` and `trace`, which work on rows of a board that begin at row r.

    at: the rows of slots (point * dim), slot_label (point), reach (subset) and best (k - 1, subset). A subset is a whole number
    with a bit for each of its points. Lanes with fewer points than others have theirs in the first slots: what is best for
    the first few does not depend on the others, so that a lane's bits do not depend on its company.
    """
    lanes, real = types.lanes, types.real

    @ti.func
    def weigh(board: ti.template(), r, points):
        """Give every subset's inertia as a single cluster: Σ |p - q|² over its pairs, divided by their number.

        Sums of distances, not of places: points that coincide have an inertia of exactly zero.
        """
        w = r + at.best
        board[w] = lanes(0.0)
        for t in range(points):
            board[r + at.reach] = lanes(0.0)
            for u in range(t):
                away = [board[r + at.slots + t * dim + k] - board[r + at.slots + u * dim + k] for k in ti.static(range(dim))]
                for q in range(1 << u):
                    board[r + at.reach + (1 << u) + q] = board[r + at.reach + q] + dot(away, away)
            for q in range(1 << t):
                board[w + (1 << t) + q] = board[w + q] + board[r + at.reach + q]
        for s in range(1, 1 << points):
            board[w + s] = board[w + s] / ti.cast(ti.math.popcnt(s), real)

    @ti.func
    def compare(board: ti.template(), r, points, most):
        """Find the least inertia of each subset that matters, in k = 1 to `most` clusters.

        The block of a subset's last point is tried in all forms; what it leaves is a smaller subset in k - 1 clusters. Those
        without the last of all points matter, and the first few points; of most clusters only the latter.
        """
        weigh(board, r, points)
        w = r + at.best
        for k in range(2, most + 1):
            below = w + (k - 2) * SUBSETS
            for t in range(points):
                first = 0
                if k == most or t == points - 1:
                    first = (1 << t) - 1
                for q in range(first, 1 << t):
                    s = (1 << t) + q
                    least = lanes(IMPOSSIBLE)
                    rest = q
                    while rest > 0:
                        least = smaller(least, board[w + (s ^ rest)] + board[below + rest])
                        rest = (rest - 1) & q
                    board[below + SUBSETS + s] = least

    @ti.func
    def label(board: ti.template(), r, lane, block, number):
        for i in range(FEW):
            if (block >> i) & 1 == 1:
                board[r + at.slot_label + i][lane] = ti.cast(number, real)

    @ti.func
    def trace(board: ti.template(), r, lane, points, clusters):
        """Label one lane's points by the clusters, 0 to clusters - 1, of the partition that `compare` found best."""
        w = r + at.best
        s = (1 << points) - 1
        k = clusters
        while k > 1:
            top = 1
            while 2 * top <= s:
                top = 2 * top
            below = w + (k - 2) * SUBSETS
            least = board[below + SUBSETS + s][lane]
            rest = s ^ top
            chosen = 0
            while rest > 0 and chosen == 0:
                if board[w + (s ^ rest)][lane] + board[below + rest][lane] == least:
                    chosen = rest
                rest = (rest - 1) & (s ^ top)
            label(board, r, lane, s ^ chosen, k - 1)
            s = chosen
            k -= 1
        label(board, r, lane, s, 0)

    return ExactSearch(compare=compare, trace=trace)
