"""Knee: how many clusters there are, told from where the inertia of K-means bends, one lane at a time."""

from typing import Any

import taichi as ti

from tiswarm.simd.runtime import Func


def build(at: Any) -> Func:
    """Build `knee`, which works on rows of a board that begin at row r. at.inertia: the first row of the inertia (k - 1)."""

    @ti.func
    def bend(board: ti.template(), r, lane, i, last, low, high):
        """Give Kneedle's difference curve at point i: the normalised drop so far, less the normalised way there."""
        drop = 1.0 - (ti.cast(board[r + at.inertia + i][lane], ti.f64) - low) / (high - low)
        return drop - ti.cast(i, ti.f64) / ti.cast(last, ti.f64)

    @ti.func
    def knee(board: ti.template(), r, lane, most):
        """Give one lane's number of clusters: where the inertia's curve over k = 1 to `most` bends, 1 if nowhere.

        Satopaa, Albrecht, Irwin, Raghavan, "Finding a Kneedle in a haystack", 2011, with a sensitivity of 1, for a convex
        falling curve. The first peak of the difference curve counts after which the curve falls by more than a mean step before
        it meets a valley or another peak. As in the package kneed, a flat stretch is peak and valley at once, and the ends
        count as peaks where they are no lower than their one neighbour. In double precision whatever the kernel's is: zeros
        of the inertia make ties that must not depend on it.
        """
        last = most - 1
        low = ti.cast(board[r + at.inertia][lane], ti.f64)
        high = low
        for i in range(1, most):
            each = ti.cast(board[r + at.inertia + i][lane], ti.f64)
            low = ti.min(low, each)
            high = ti.max(high, each)
        found = 1
        if high > low:
            step = ti.cast(0.0, ti.f64)
            for i in range(last):
                step += ti.cast(i + 1, ti.f64) / ti.cast(last, ti.f64) - ti.cast(i, ti.f64) / ti.cast(last, ti.f64)
            step /= ti.cast(last, ti.f64)
            threshold = ti.cast(0.0, ti.f64)
            peak, falling, searching = 0, 0, 1
            here = bend(board, r, lane, 0, last, low, high)
            before = here
            for i in range(last):
                after = bend(board, r, lane, i + 1, last, low, high)
                if here >= before and here >= after:
                    threshold = here - step
                    peak = i
                    falling = 1
                if here <= before and here <= after:
                    falling = 0
                if searching == 1 and falling == 1 and after < threshold:
                    found = peak + 1
                    searching = 0
                before = here
                here = after
        return found

    return knee
