"""Means: over all prey of a swarm, and where each of them is: sums over fixed pieces of the slots, added up in their order."""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.simd.runtime import EIGHT, TASK, Func, Types
from tiswarm.space import box_lanes
from tiswarm.space.cells import SLOTS, TRIALS

PIECE = 128
"""Rows of eight slots whose sums are added up first: the order of summation does not depend on threads or lanes."""

NOBODY = 1e15
"""What is larger than any agent's number."""


@dataclass(frozen=True)
class MeanKernels:
    """Kernels over all prey of a swarm."""

    average: Func  # write number, mean position and mean velocity of each trial's prey
    rank: Func  # write which slot the agent of each number is in


def build(layout: ParameterTable, types: Types, near: Any, number_in: Any) -> MeanKernels:
    """Build the kernels `average` and `rank`. number_in: the func that gives the number of the prey in a slot.

    Where sight wraps, places are those nearest to the first prey that is alive, as in `perception.swarm_of`.
    """
    eight, real = types.eight, types.real
    dim, size = len(layout.axes), layout.at.size
    wrapping = layout.structure.frame.wrap_sight
    rows, told = 2 * dim + 1, 2 * dim + 2
    cold_array = ti.types.ndarray(dtype=real, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)

    @ti.func
    def place_of(agents: ti.template(), means: ti.template(), numbers: ti.template(), slot, at, k: ti.template()):
        """Give a coordinate of an agent, or its way from the origin of its trial's means."""
        x = agents[slot][k]
        if ti.static(wrapping):
            x = box_lanes.displacement(x - means[at + 1 + k], numbers[size[k]][0])
        return x

    @ti.func
    def find_first(whole: ti.template(), sums: ti.template(), piece, first, end):
        """Write the least number of a piece's agents, and its slot, into the first two rows of its sums."""
        least = NOBODY
        found = real(0.0)
        for slot in range(first, end):
            number = ti.cast(number_in(whole, slot), real)
            if number < least:
                least = number
                found = ti.cast(slot, real)
        sums[piece * rows] = eight(least)
        sums[piece * rows + 1] = eight(found)

    @ti.func
    def put_origin(agents: ti.template(), sums: ti.template(), means: ti.template(), trial, pieces):
        """Write where the first prey of a trial that is alive is, in the place of its mean position."""
        least = NOBODY
        found = 0
        for piece in range(trial * pieces, (trial + 1) * pieces):
            if sums[piece * rows][0] < least:
                least = sums[piece * rows][0]
                found = ti.cast(sums[piece * rows + 1][0], ti.i32)
        for k in ti.static(range(dim)):
            means[trial * told + 1 + k] = 0.0
            if least < NOBODY:
                means[trial * told + 1 + k] = agents[found][k]

    @ti.func
    def sum_up(
        agents: ti.template(), sums: ti.template(), means: ti.template(), numbers: ti.template(), piece, at, first, past, end,
    ):  # fmt: skip
        """Write the sums over the rows `first` to `past` of a piece. at: where its trial's means begin."""
        own = [eight(0.0) for _ in ti.static(range(rows))]
        for row in range(first, past):
            s = row * EIGHT
            here = eight([ti.select(s + k < end, real(1.0), real(0.0)) for k in ti.static(range(EIGHT))])
            own[0] += here
            for axis in ti.static(range(dim)):
                x = eight([place_of(agents, means, numbers, s + k, at, axis) for k in ti.static(range(EIGHT))])
                own[1 + axis] += here * x
                own[1 + dim + axis] += here * eight([agents[s + k][dim + axis] for k in ti.static(range(EIGHT))])
        for k in ti.static(range(rows)):
            sums[piece * rows + k] = own[k]

    @ti.func
    def put_means(sums: ti.template(), means: ti.template(), trial, pieces):
        """Write a trial's means from the sums of its pieces."""
        at = trial * told
        count = eight(0.0)
        for piece in range(trial * pieces, (trial + 1) * pieces):
            count += sums[piece * rows]
        means[at] = count.sum()
        share = 1.0 / ti.max(means[at], 1.0)
        for k in ti.static(range(2 * dim)):
            total = eight(0.0)
            for piece in range(trial * pieces, (trial + 1) * pieces):
                total += sums[piece * rows + 1 + k]
            mean = share * total.sum()
            if ti.static(wrapping and k < dim):
                mean = means[at + 1 + k] + mean
            means[at + 1 + k] = mean

    @ti.kernel
    def average(
        agents: near.prey.agent_array, whole: whole_array, sums: types.eight_array, means: cold_array,
        numbers: types.lane_array(1),
    ):  # fmt: skip
        """Write the means of each trial. sums: rows of eight, some for each piece; means: [trial * row]."""
        height = whole[SLOTS] // EIGHT
        pieces = (height + PIECE - 1) // PIECE
        if ti.static(wrapping):
            for index in range(pieces * whole[TRIALS] * TASK):
                if index % TASK == 0:
                    piece = index // TASK
                    trial = piece // pieces
                    first = (trial * height + piece % pieces * PIECE) * EIGHT
                    find_first(whole, sums, piece, first, ti.min(first + PIECE * EIGHT, near.prey.alive_end(whole, trial)))
            for trial in range(whole[TRIALS]):
                put_origin(agents, sums, means, trial, pieces)
        for index in range(pieces * whole[TRIALS] * TASK):
            if index % TASK == 0:
                piece = index // TASK
                trial = piece // pieces
                first = trial * height + piece % pieces * PIECE
                past, end = ti.min(first + PIECE, (trial + 1) * height), near.prey.alive_end(whole, trial)
                sum_up(agents, sums, means, numbers, piece, trial * told, first, past, end)
        for trial in range(whole[TRIALS]):
            put_means(sums, means, trial, pieces)

    return MeanKernels(average=average, rank=_rank(near, number_in))


def _rank(near: Any, number_in: Func) -> Func:
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)

    @ti.kernel
    def rank(whole: whole_array, order: whole_array, count: ti.i32):
        """Write which slot the agent of each number is in, -1 for those who are gone."""
        for at in range(whole[TRIALS] * count):
            order[at] = -1
        for slot in range(whole[SLOTS] * whole[TRIALS]):
            trial = slot // whole[SLOTS]
            if slot < near.prey.alive_end(whole, trial):
                order[trial * count + number_in(whole, slot)] = slot

    return rank
