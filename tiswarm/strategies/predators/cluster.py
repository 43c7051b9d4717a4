"""Cluster: split up, each part of the swarm after another sub-swarm of the prey."""

from dataclasses import dataclass
from types import MappingProxyType

import taichi as ti

from tiswarm.simd.lanes import anywhere, dot, larger, minus, place, vector
from tiswarm.strategies.clustering import kmeans, reference
from tiswarm.strategies.clustering.kmeans import MOST, board_rows, clusters_of
from tiswarm.strategies.predators import Predator


class Strategy(Predator):
    """Lupau 2022, section 6.3, clustering: predator j chases the centre of sub-swarm j mod k, c - p.

    Sub-swarms are found once a tick, by K-means for k = 1 to max_clusters and the knee of its inertia (`kmeans.py`).
    """

    dimensions = (2, 3)
    memory = ("group", "chased*")  # its sub-swarm, counted from 1, 0 before the first tick; where that one's centre is
    shown = memory
    whole = MappingProxyType({"max_clusters": (1, MOST), "restarts": (0, 1000)})
    live = "reference"

    @dataclass(frozen=True)
    class Weights:
        """Numbers of the strategy."""

        max_clusters: float = 5.0  # most sub-swarms that are looked for
        restarts: float = 64.0  # starts drawn for each number of clusters, for more prey than the best partition is found of
        sticky: float = 0.0  # 1: after its first tick a predator chases the centre nearest to its last one; 0: j mod k
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
    def consult(board, position, weights):
        count, label, centres = reference.sub_swarms(position, int(weights["max_clusters"]))
        prey_count, dim = position.shape
        at = board_rows(dim)
        board[at.count] = count
        board[at.centres : at.centres + centres.size] = centres.ravel()
        board[at.points + at.label * prey_count :][:prey_count] = label

    @staticmethod
    def survey(layout, types, see, uniform, part):
        dim = len(layout.axes)
        at, lanes = board_rows(dim), types.lanes
        cluster = kmeans.build(layout, types, uniform)
        prey_rows, predator_rows = layout.agent_rows["prey"], layout.agent_rows["predators"]
        group_row, *chased_rows = part.memory_rows

        @ti.func
        def assign(predators: ti.template(), board: ti.template(), r, b, count, weights):
            """Give each predator the sub-swarm that it chases in this tick."""
            clusters = larger(board[r + at.count], 1.0)
            for j in range(count):
                q = (b * count + j) * predator_rows
                number = lanes(ti.cast(j + 1, types.real))
                chosen = number - clusters * ti.floor(number / clusters)
                nearest = lanes(0.0)
                least = lanes(0.0)
                for c in range(MOST):
                    way = [board[r + at.centres + c * dim + k] - predators[q + chased_rows[k]] for k in ti.static(range(dim))]
                    distance2 = dot(way, way)
                    closer = (c == 0) | (distance2 < least)
                    closer = closer & (clusters > ti.cast(c, types.real) + 0.5)
                    nearest = ti.select(closer, ti.cast(c, types.real), nearest)
                    least = ti.select(closer, distance2, least)
                keeps = (weights.sticky > 0.5) & (predators[q + group_row] > 0.5)
                chosen = ti.select(keeps, nearest, chosen)
                predators[q + group_row] = chosen + 1.0
                for c in range(MOST):
                    for k in ti.static(range(dim)):
                        row = q + chased_rows[k]
                        centre = board[r + at.centres + c * dim + k]
                        predators[row] = ti.select(chosen == ti.cast(c, types.real), centre, predators[row])

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
            if anywhere(chosen & (weights.reference < 0.5)):
                most = ti.select(chosen, clusters_of(weights.max_clusters), 1.0)
                restarts = ti.select(chosen, weights.restarts, 0.0)
                cluster(board, r, n, prey, b * n * prey_rows, most, restarts, trial, tick, key_low, key_high)
            if anywhere(chosen):
                assign(predators, board, r, b, counts[1], weights)

        return survey

    @staticmethod
    @ti.func
    def mates(me, mate, weights):
        apart = me.group - mate.group
        return ti.select(apart * apart < 0.25, 1.0, 0.0)

    @staticmethod
    @ti.func
    def pursue(me, quarry, target, notes, weights):
        return minus(vector(me, "chased"), place(me))
