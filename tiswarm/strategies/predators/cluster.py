"""Cluster: split up, each part of the swarm after another sub-swarm of the prey."""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np
import taichi as ti

from tiswarm.simd.lanes import anywhere, dot, larger, minus, place, vector
from tiswarm.space.box_lanes import displacement, shortest
from tiswarm.strategies.clustering import kmeans, lloyd, reference
from tiswarm.strategies.clustering.kmeans import MOST, board_rows, clusters_of
from tiswarm.strategies.predators import Predator


class Strategy(Predator):
    """Lupau 2022, section 6.3, clustering: predator j chases the centre of sub-swarm j mod k, c - p.

    Sub-swarms are found once a tick, by K-means for k = 1 to max_clusters and the knee of its inertia (`kmeans.py`). In the
    author's simulator each predator fits K-means for itself, and the order of a fit's centres is random: it chases a centre
    drawn anew every tick (`labels = "redrawn"`). With "kept" sub-swarms have the numbers of their first prey for all.
    """

    chases = "group"
    dimensions = (2, 3)
    # The sub-swarm it chases and the predators it flocks with, counted from 1, 0 before the first tick; the centre it chases.
    memory = ("group", "squad", "chased*")
    shown = memory
    whole = MappingProxyType({"max_clusters": (1, MOST), "restarts": (0, 1000)})
    needed = MappingProxyType({"sticky": ("labels", "kept")})
    live = "reference"

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        max_clusters: float = 5.0  # most sub-swarms that are looked for
        labels: Literal["redrawn", "kept"] = "redrawn"  # whether centre j mod k is drawn each tick, or stays while its prey do
        restarts: float = 64.0  # starts drawn for each number of clusters, for more prey than the best partition is found of
        sticky: float = 0.0  # 1: after its first tick a predator takes the centre nearest to its last one; with kept labels
        reference: float = 0.0  # 1: ask scikit-learn and kneed between ticks, in single trials only

    @staticmethod
    def groups(memory):
        return memory["group"].astype(int) - 1

    @staticmethod
    def prey_groups(board, prey_count, dim):
        at = board_rows(dim)
        first = at.points + at.label * prey_count
        return board[first : first + prey_count].astype(int)

    @staticmethod
    def board_rows(dim):
        at = board_rows(dim)
        return at.fixed, at.each

    @staticmethod
    def consult(board, memory, position, weights, key):
        most = int(weights["max_clusters"])
        count, label, centres = reference.sub_swarms(position, most)
        prey_count, dim = position.shape
        at = board_rows(dim)
        board[at.count] = count
        board[at.centres : at.centres + centres.size] = centres.ravel()
        board[at.points + at.label * prey_count :][:prey_count] = label
        if weights["labels"] == "kept":
            return
        predators = len(memory["group"])
        found, mine, centre = reference.chased(position, most, predators, key)
        memory["group"][:] = np.where(mine.any(axis=1), label[mine.argmax(axis=1)], 0) + 1
        memory["squad"][:] = np.arange(1, predators + 1) % found + 1
        for k in range(dim):
            memory[f"chased_{'xyz'[k]}"][:] = centre[:, k]

    @staticmethod
    def survey(layout, types, see, uniform, part):
        dim = len(layout.axes)
        at, lanes, width = board_rows(dim), types.lanes, len(layout.paths)
        sub_swarms = kmeans.build(layout, types, uniform)
        fit = lloyd.build(types, dim, MOST, at, uniform)
        prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
        group_row, squad_row, *chased_rows = part.memory_rows

        @ti.func
        def place_in_order(j, clusters):
            """Give j mod k for predator j, counted from 1 as in the thesis."""
            number = lanes(ti.cast(j + 1, types.real))
            return number - clusters * ti.floor(number / clusters)

        @ti.func
        def assign(predators: ti.template(), board: ti.template(), numbers: ti.template(), r, b, count, weights):
            """Give each predator the sub-swarm that it chases in this tick."""
            clusters = larger(board[r + at.count], 1.0)
            for j in range(count):
                q = (b * count + j) * predator_rows
                chosen = place_in_order(j, clusters)
                nearest = lanes(0.0)
                least = lanes(0.0)
                for c in range(MOST):
                    way = [board[r + at.centres + c * dim + k] - predators[q + chased_rows[k]] for k in ti.static(range(dim))]
                    if ti.static(layout.structure.frame.wrap_sight):
                        for k in ti.static(range(dim)):
                            way[k] = displacement(way[k], numbers[b * width + layout.at.size[k]])
                    distance2 = dot(way, way)
                    closer = (c == 0) | (distance2 < least)
                    closer = closer & (clusters > ti.cast(c, types.real) + 0.5)
                    nearest = ti.select(closer, ti.cast(c, types.real), nearest)
                    least = ti.select(closer, distance2, least)
                keeps = (weights.sticky > 0.5) & (predators[q + group_row] > 0.5)
                chosen = ti.select(keeps, nearest, chosen)
                predators[q + group_row] = chosen + 1.0
                predators[q + squad_row] = chosen + 1.0
                for c in range(MOST):
                    for k in ti.static(range(dim)):
                        row = q + chased_rows[k]
                        centre = board[r + at.centres + c * dim + k]
                        predators[row] = ti.select(chosen == ti.cast(c, types.real), centre, predators[row])

        @ti.func
        def chase(prey: ti.template(), predators: ti.template(), board: ti.template(), r, n, a, q, drawn):
            """Let a predator chase the mean of the prey that were drawn for it, in the lanes of a mask."""
            size, group = lanes(0.0), lanes(0.0)
            total = [lanes(0.0) for _ in ti.static(range(dim))]
            for i in range(n):
                own = board[r + at.points + at.drawn * n + i]
                group = ti.select((own > 0.5) & (size < 0.5), board[r + at.points + at.label * n + i] + 1.0, group)
                size += own
                for k in ti.static(range(dim)):
                    total[k] += own * sub_swarms.place_of(board, r, n, prey, a, i, k)
            share = 1.0 / larger(size, 1.0)
            predators[q + group_row] = ti.select(drawn, group, predators[q + group_row])
            for k in ti.static(range(dim)):
                predators[q + chased_rows[k]] = ti.select(drawn, share * total[k], predators[q + chased_rows[k]])

        @ti.func
        def survey(
            prey: ti.template(),
            predators: ti.template(),
            board: ti.template(),
            numbers: ti.template(),
            trial,
            tick,
            b,
            counts,
            key_low,
            key_high,
        ):
            weights = see.weights_of(part, numbers, b)
            n = counts[0]
            r = b * (layout.board.fixed + layout.board.each * n) + part.board.fixed + part.board.each * n
            chosen = weights.on > 0.5
            ours = chosen & (weights.reference < 0.5)
            if anywhere(ours):
                most = ti.select(chosen, clusters_of(weights.max_clusters), 1.0)
                restarts = ti.select(chosen, weights.restarts, 0.0)
                size = [numbers[b * width + column] for column in ti.static(layout.at.size)]
                sub_swarms.find(
                    board, r, n, prey, b * n * prey_rows, size, most, restarts, trial, tick, key_low, key_high
                )  # fmt: skip
            if anywhere(chosen & ((weights.reference < 0.5) | (weights.labels > 0.5))):
                assign(predators, board, numbers, r, b, counts[1], weights)
            drawn = ours & (weights.labels < 0.5) & (board[r + at.count] > 1.5)
            if anywhere(drawn):
                clusters = larger(board[r + at.count], 1.0)
                asked = ti.select(drawn, 1.0, 0.0)
                for j in range(counts[1]):
                    wanted = place_in_order(j, clusters)
                    fit.draw(board, r, n, clusters, wanted, asked, j, trial, tick, key_low, key_high)
                    q = (b * counts[1] + j) * predator_rows
                    chase(prey, predators, board, r, n, b * n * prey_rows, q, drawn)

        return survey

    @staticmethod
    @ti.func
    def mates(me, mate, weights):
        apart = me.squad - mate.squad
        return ti.select(apart * apart < 0.25, 1.0, 0.0)

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, notes, weights):
        return shortest(me, minus(vector(me, "chased"), place(me)))
