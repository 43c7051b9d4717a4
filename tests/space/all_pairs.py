"""Neighbours by comparing all pairs, and whom a grid lets meet."""

import numpy as np
import taichi as ti
from scipy.spatial import cKDTree

from tiswarm.simd import runtime
from tiswarm.simd.runtime import LANES
from tiswarm.space.cell_list import Grid
from tiswarm.space.cells import SLOTS

REACH = 1.0
_kernels: dict[object, object] = {}


def _meetings(grid):
    """Build the kernel that notes who meets whom within REACH, and a checksum of whom."""
    f, dimensions, types = grid.funcs, grid.space.dimensions, runtime.types()
    key = (runtime.generation(), id(f))
    if key in _kernels:
        return _kernels[key]
    sums_type = ti.types.struct(met=types.lanes, whom=types.lanes)

    @ti.func
    def meet(sums: ti.template(), p, agents: ti.template(), j, reals: ti.template()):
        distance2 = types.lanes(0.0)
        for axis in ti.static(range(dimensions)):
            d = f.across(agents[j][axis] - p[axis], axis, reals)
            distance2 += d * d
        sums.met += ti.select(distance2 <= REACH * REACH, 1.0, 0.0)
        sums.whom += ti.select(distance2 <= REACH * REACH, ti.cast(j % 1021, types.real), 0.0)

    walks = f.walks(meet)

    @ti.kernel
    def run(
        agents: f.agent_array,
        whole: f.whole_array,
        reals: f.real_array,
        out: ti.types.ndarray(dtype=types.real, ndim=2),
        blocks: ti.i32,
    ):
        for block in range(blocks):
            trial = block * LANES // whole[SLOTS]
            sums = sums_type(met=types.lanes(0.0), whom=types.lanes(0.0))
            p = [types.lanes([agents[block * LANES + k][axis] for k in ti.static(range(LANES))]) for axis in range(dimensions)]
            end = ti.min(block * LANES + LANES, f.alive_end(whole, trial))
            walks.around(sums, p, agents, whole, reals, trial, block, end)
            for k in ti.static(range(LANES)):
                out[block * LANES + k, 0] = sums.met[k]
                out[block * LANES + k, 1] = sums.whom[k]

    _kernels[key] = run
    return run


def met(grid):
    """Run the walk: (how many each slot meets, the sum of their slots modulo 1021), itself included: [trial, slot]."""
    out = np.zeros((grid.total, 2), runtime.types().dtype)
    _meetings(grid)(grid.agents, grid.whole, grid.reals, out, grid.total // LANES)
    return out.reshape(grid.trials, grid.slots, 2).astype(np.int64)


def compared(grid, trial):
    """Compare all pairs of a trial in double precision; leave out pairs that rounding may decide.

    Pairs that may be near come from a k-d tree of SciPy's, which scikit-learn stands on: 10 000 agents have 10⁸.
    """
    dimensions, first = grid.space.dimensions, trial * grid.slots
    alive = grid.alive()[trial]
    p = grid.agents[first : first + alive, :dimensions].astype(np.float64)
    if alive == 0:
        return np.zeros((0, 2), np.int64), np.zeros(0, bool)
    size = np.asarray(grid.space.size) if grid.space.boundary == "periodic" else None
    tree = cKDTree(p) if size is None else cKDTree(p % size, boxsize=size)
    one, other = tree.query_pairs(REACH + 0.01, output_type="ndarray").T
    away = p[one] - p[other]
    if size is not None:
        away -= size * np.round(away / size)
    distance2 = (away**2).sum(axis=-1)
    near, whom = distance2 <= REACH**2, (first + np.arange(alive)) % 1021
    counts = np.stack([np.ones(alive, np.int64), whom], axis=1)  # everybody meets itself
    unsure = (np.abs(distance2 - REACH**2) < 1e-4) & (distance2 != REACH**2)
    doubtful = np.zeros(alive, bool)
    for who, mate in ((one, other), (other, one)):
        np.add.at(counts, who[near], np.stack([np.ones(near.sum(), np.int64), whom[mate[near]]], axis=1))
        doubtful[who[unsure]] = True
    return counts, ~doubtful


def check(space, position, gone=None):
    trials, count, _ = position.shape
    grid = Grid(space, REACH, count, trials)
    position = position.astype(np.float64)
    velocity = np.zeros_like(position)
    if gone is not None:
        position[gone], velocity[gone] = np.nan, np.nan
    grid.place(position, velocity)
    found = met(grid)
    for trial in range(trials):
        counts, sure = compared(grid, trial)
        assert (found[trial, : len(counts)][sure] == counts[sure]).all()
        assert len(sure) == 0 or sure.mean() > 0.5
        here = grid.numbers[trial, : len(counts)]
        assert len(set(here)) == len(here)
        assert gone is None or not gone[trial][here].any()
    back = grid.gathered(slice(0, space.dimensions))
    kept = position.astype(runtime.types().dtype)
    assert np.allclose(back, kept, atol=1e-4, equal_nan=True) or space.boundary == "periodic"
    return grid
