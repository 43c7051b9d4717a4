"""K-means: K-means of the prey and the knee of its inertia, inside kernels; scikit-learn and kneed as the yardstick."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import taichi as ti

from tiswarm.simd.lanes import anywhere, larger, smaller
from tiswarm.simd.runtime import LANES, Func, Types
from tiswarm.space.box_lanes import displacement
from tiswarm.strategies.clustering import exact, search
from tiswarm.strategies.clustering import knee as knees
from tiswarm.strategies.clustering.exact import FEW, SUBSETS

MOST = 8
"""Clusters that there may be."""


def board_rows(dim: int) -> SimpleNamespace:
    """Lay out a block's board: first what a survey tells, then what it works on, then rows with one place a prey.

    count: of clusters; centres: cluster * dim; inertia: k - 1; points: where the rows of prey begin, in which `label` is the
    first and row * prey_count + prey the place; fixed: rows that any number of prey has; each: rows per prey.
    """
    sizes = {
        "count": 1,
        "centres": MOST * dim,
        "inertia": MOST,
        "slots": FEW * dim,
        "slot_label": FEW,
        "reach": SUBSETS // 2,
        "best": MOST * SUBSETS,
        "middle": MOST * dim,
        "best_middle": MOST * dim,
        "base": MOST * dim,
        "size": MOST,
        "leave": MOST,
        "join": MOST,
        "origin": dim,
    }
    begins = np.cumsum([0, *sizes.values()]).tolist()
    at = SimpleNamespace(**dict(zip([*sizes, "points"], begins, strict=True)), fixed=begins[-1])
    at.label, at.alive, at.draft, at.weight, at.drawn, at.place, at.kept = 0, 1, 2, 3, 4, 5, 5 + dim
    at.each = at.kept + MOST
    return at


@dataclass(frozen=True)
class _Labels:
    """What writes each prey's cluster."""

    hand_out: Func  # the slots' labels, where prey are few
    take_best: Func  # the best partition's, where they are many
    renumber: Func


def _labels(types: Types, at: Any) -> _Labels:
    lanes, real = types.lanes, types.real

    @ti.func
    def hand_out(board: ti.template(), r, n, is_few):
        """Hand the slots' labels to their prey."""
        alive_count = lanes(0.0)
        for i in range(n):
            alive = board[r + at.points + at.alive * n + i]
            own = lanes(0.0)
            for slot in range(FEW):
                own = ti.select(alive_count == ti.cast(slot, real), board[r + at.slot_label + slot], own)
            row = r + at.points + at.label * n + i
            board[row] = ti.select(is_few, own, board[row])
            alive_count += alive

    @ti.func
    def take_best(board: ti.template(), r, n, count):
        """Take the best partition into as many clusters as the knee says."""
        for i in range(n):
            own = lanes(0.0)
            for k in range(MOST):
                chosen = count == ti.cast(k + 1, real)
                own = ti.select(chosen, board[r + at.points + (at.kept + k) * n + i], own)
            board[r + at.points + at.label * n + i] = own

    @ti.func
    def renumber(board: ti.template(), r, n):
        """Give clusters numbers by their first alive prey, whatever found them, -1 to those who are gone; works on `size`."""
        for c in range(MOST):
            board[r + at.size + c] = lanes(-1.0)
        known = lanes(0.0)
        for i in range(n):
            row = r + at.points + at.label * n + i
            alive = board[r + at.points + at.alive * n + i] > 0.5
            own = lanes(-1.0)
            for c in range(MOST):
                mine = alive & (board[row] == ti.cast(c, real))
                new = mine & (board[r + at.size + c] < -0.5)
                number = ti.select(new, known, board[r + at.size + c])
                board[r + at.size + c] = number
                known += ti.select(new, 1.0, 0.0)
                own = ti.select(mine, number, own)
            board[row] = own

    return _Labels(hand_out=hand_out, take_best=take_best, renumber=renumber)


def build(layout, types: Types, uniform):
    """Build `find` and `place_of`, which work on rows of a board that begin at row r, for the n prey that begin at row a.

    layout: the rows of prey and of a block's whole numbers (`dynamics.table.ParameterTable`).
    """
    lanes, real = types.lanes, types.real
    dim, own_rows, rows = len(layout.axes), layout.agent_rows["prey"], layout.rows
    at = board_rows(dim)
    few = exact.build(types, dim, at)
    many = search.build(types, dim, MOST, at, uniform)
    knee = knees.build(at)
    labels = _labels(types, at)
    wrapping = layout.structure.frame.wrap_sight

    @ti.func
    def fill_slots(board: ti.template(), r, n, prey: ti.template(), a, size: ti.template()):
        """Put each lane's first alive prey side by side, at their way from the first one; give how many are alive.

        Prey that coincide are then at exactly zero, wherever in the world they are.
        """
        for each in range(FEW * dim):
            board[r + at.slots + each] = lanes(0.0)
        alive_count = lanes(0.0)
        origin = [lanes(0.0) for _ in ti.static(range(dim))]
        for i in range(n):
            alive = prey[a + i * own_rows + rows.alive]
            first = (alive > 0.5) & (alive_count < 0.5)
            board[r + at.points + at.alive * n + i] = alive
            for k in ti.static(range(dim)):
                there = prey[a + i * own_rows + rows.place[k]]
                origin[k] = ti.select(first, there, origin[k])
                way = there - origin[k]
                if ti.static(wrapping):
                    way = displacement(way, size[k])
                board[r + at.points + (at.place + k) * n + i] = way
                for slot in range(ti.min(i + 1, FEW)):
                    taken = (alive > 0.5) & (alive_count == ti.cast(slot, real))
                    row = r + at.slots + slot * dim + k
                    board[row] = ti.select(taken, way, board[row])
            alive_count += alive
        for k in ti.static(range(dim)):
            board[r + at.origin + k] = origin[k]
        return alive_count

    @ti.func
    def place_of(board: ti.template(), r, n, prey: ti.template(), a, i, k: ti.template()):
        """Give a coordinate of a prey: where it is, or its image that is nearest to the first one."""
        x = prey[a + i * own_rows + rows.place[k]]
        if ti.static(wrapping):
            x = board[r + at.origin + k] + board[r + at.points + (at.place + k) * n + i]
        return x

    @ti.func
    def put_centres(board: ti.template(), r, n, prey: ti.template(), a):
        """Write each cluster's mean position down: the origin for clusters that are not there, as means of nobody are."""
        for c in range(MOST):
            size = lanes(0.0)
            total = [lanes(0.0) for _ in ti.static(range(dim))]
            for i in range(n):
                own = ti.select(board[r + at.points + at.label * n + i] == ti.cast(c, real), 1.0, 0.0)
                size += own
                for k in ti.static(range(dim)):
                    total[k] += own * place_of(board, r, n, prey, a, i, k)
            share = 1.0 / larger(size, 1.0)
            for k in ti.static(range(dim)):
                board[r + at.centres + c * dim + k] = share * total[k]

    @ti.func
    def cluster(
        board: ti.template(), r, n, prey: ti.template(), a, size: ti.template(), most, restarts, trial, tick, key_low, key_high,
    ):  # fmt: skip
        """Find count, centres and labels of the clusters of each lane's alive prey. most, restarts, trial, tick: [lane].

        size: of the world, a list. Where sight wraps, places are those nearest to the first prey that is alive.
        """
        alive_count = fill_slots(board, r, n, prey, a, size)
        most_clusters = ti.cast(most.max() + 0.5, ti.i32)
        points = ti.min(ti.cast(alive_count.max() + 0.5, ti.i32), FEW)
        is_few = alive_count < FEW + 0.5
        crowded = not anywhere(is_few)
        if anywhere(alive_count > FEW + 0.5):
            many.search(board, r, n, most_clusters, restarts, trial, tick, key_low, key_high)
        if not crowded:
            few.compare(board, r, points, most_clusters)
            for k in range(most_clusters):
                least = lanes(0.0)
                for q in range(k + 2, points + 1):
                    reached = alive_count == ti.cast(q, real)
                    least = ti.select(reached, board[r + at.best + k * SUBSETS + (1 << q) - 1], least)
                board[r + at.inertia + k] = ti.select(is_few, least, board[r + at.inertia + k])
        for lane in range(LANES):
            clusters = knee(board, r, lane, ti.cast(most[lane] + 0.5, ti.i32))
            board[r + at.count][lane] = ti.cast(clusters, real)
            alive = ti.cast(alive_count[lane] + 0.5, ti.i32)
            if alive <= FEW:
                few.trace(board, r, lane, ti.max(alive, 1), ti.min(clusters, ti.max(alive, 1)))
        if anywhere(alive_count > FEW + 0.5):
            labels.take_best(board, r, n, board[r + at.count])
        labels.hand_out(board, r, n, is_few)
        labels.renumber(board, r, n)
        put_centres(board, r, n, prey, a)

    return SimpleNamespace(find=cluster, place_of=place_of)


@ti.func
def clusters_of(number):
    """Bring a weight that counts clusters into the range that a board has room for, [lane]."""
    return smaller(larger(number, 1.0), float(MOST))
