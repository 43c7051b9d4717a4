"""Means: over all prey of a swarm, and where each of them is: sums over fixed pieces of the slots, added up in their order."""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics.table import Layout
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import motion, place
from tiswarm.simd.runtime import LANES, TASK, Func, Types
from tiswarm.space.cells import SLOTS, TRIALS

PIECE = 128
"""Blocks whose sums are added up first: the order of summation does not depend on threads."""


@dataclass(frozen=True)
class MeanKernels:
    """Kernels over all prey of a swarm."""

    average: Func  # write number, mean position and mean velocity of each trial's prey
    rank: Func  # write which slot the agent of each number is in


def build(layout: Layout, types: Types, see: Views, near: Any, number_in: Any) -> MeanKernels:
    """Build the kernels `average` and `rank`. number_in: the func that gives the number of the prey in a slot."""
    lanes, real, dim = types.lanes, types.real, len(layout.axes)
    flat = types.lane_array(1)
    cold_array = ti.types.ndarray(dtype=real, ndim=1)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)

    @ti.kernel
    def average(agents: near.prey.agent_array, whole: whole_array, sums: flat, means: cold_array):
        """Write number, mean position and mean velocity of each trial's prey. sums: rows of lanes, some for each piece."""
        blocks = whole[SLOTS] // LANES
        pieces = (blocks + PIECE - 1) // PIECE
        for index in range(pieces * whole[TRIALS] * TASK):
            if index % TASK == 0:
                piece = index // TASK
                trial = piece // pieces
                end = near.prey.alive_end(whole, trial)
                own = see.Swarm(*[lanes(0.0) for _ in ti.static(range(2 * dim + 2))])
                first = trial * blocks + piece % pieces * PIECE
                for block in range(first, ti.min(first + PIECE, (trial + 1) * blocks)):
                    here = lanes(
                        [ti.select(block * LANES + lane < end, real(1.0), real(0.0)) for lane in ti.static(range(LANES))]
                    )
                    own.n += here
                    for k in ti.static(range(dim)):
                        place(own)[k] += here * lanes([agents[block * LANES + lane][k] for lane in ti.static(range(LANES))])
                        motion(own)[k] += here * lanes(
                            [agents[block * LANES + lane][dim + k] for lane in ti.static(range(LANES))]
                        )
                row = piece * (2 * dim + 1)
                sums[row] = own.n
                for k in ti.static(range(dim)):
                    sums[row + 1 + k] = place(own)[k]
                    sums[row + 1 + dim + k] = motion(own)[k]
        for trial in range(whole[TRIALS]):
            at = trial * (2 * dim + 2)
            for k in ti.static(range(2 * dim + 1)):
                total = lanes(0.0)
                for piece in range(trial * pieces, (trial + 1) * pieces):
                    total += sums[piece * (2 * dim + 1) + k]
                means[at + k] = total.sum()
            share = 1.0 / ti.max(means[at], 1.0)
            for k in ti.static(range(2 * dim)):
                means[at + 1 + k] = share * means[at + 1 + k]

    @ti.kernel
    def rank(whole: whole_array, order: whole_array, count: ti.i32):
        """Write which slot the agent of each number is in, -1 for those who are gone."""
        for at in range(whole[TRIALS] * count):
            order[at] = -1
        for slot in range(whole[SLOTS] * whole[TRIALS]):
            trial = slot // whole[SLOTS]
            if slot < near.prey.alive_end(whole, trial):
                order[trial * count + number_in(whole, slot)] = slot

    return MeanKernels(average=average, rank=rank)
