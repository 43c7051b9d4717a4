"""The grid: whom agents meet is what comparing all pairs finds, each neighbour once, in an order that no thread decides."""

from types import SimpleNamespace

import numpy as np
import pytest
import taichi as ti
from all_pairs import REACH, check, met

import tiswarm
from tiswarm.simd import runtime
from tiswarm.simd.runtime import LANES
from tiswarm.space.cell_list import Grid
from tiswarm.space.cells import HEAD, SLOTS, TABLE, Space, plan

BOUNDARIES = ("open", "periodic", "walls", "disc")
SIZES = {2: (24.0, 17.0), 3: (9.0, 7.0, 8.0)}


def arrangements(dimensions, count, rng):
    size = np.array(SIZES[dimensions])
    yield "uniform", rng.random((count, dimensions)) * size
    yield "clumped", (rng.normal(0, 0.7, (count, dimensions)) + size * rng.integers(0, 3, (count, 1)) / 3) % size
    yield "one cell", rng.random((count, dimensions)) * 0.3 + 4.0
    yield "cell edges", np.floor(rng.random((count, dimensions)) * size * 2) / 2 % size
    yield "coincident", np.full((count, dimensions), 3.0)
    line = rng.random((count, dimensions)) * size
    line[:, 1:] = 2.0
    yield "a row", line
    yield "a column", np.roll(line, 1, axis=1) % size


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("dimensions", [2, 3])
def test_neighbours_are_those_of_all_pairs(dimensions, boundary, f32):
    rng = np.random.default_rng(1)
    for _, position in arrangements(dimensions, 700, rng):
        check(Space(SIZES[dimensions], boundary), np.stack([position, np.flip(position, axis=0)]))


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("size", [(0.7, 0.9), (2.3, 40.0), (40.0, 2.3), (1.0, 1.0, 30.0), (4.9, 2.9, 2.0), (3.05, 3.05)])
def test_worlds_narrower_than_the_reach(size, boundary, f32):
    rng = np.random.default_rng(2)
    check(Space(size, boundary), rng.random((2, 300, len(size))) * size)


@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_neighbours_in_double_precision(boundary, f64):
    rng = np.random.default_rng(12)
    for dimensions, size in SIZES.items():
        for _, position in arrangements(dimensions, 300, rng):
            check(Space(size, boundary), position[None])
    check(Space((2.3, 40.0), boundary), rng.random((2, 300, 2)) * (2.3, 40.0))
    gone = rng.random((2, 300)) < 0.4
    check(Space((10.0, 10.0), boundary), rng.random((2, 300, 2)) * 10, gone=gone)
    if boundary == "open":
        check(Space((10.0, 10.0), boundary), rng.random((1, 300, 2)) * 8 - 3e8)


def placed(space, position):
    """Let a kernel put agents whose new positions it has in lanes; give the grid."""
    count, dimensions = position.shape
    grid = Grid(space, REACH, count)
    grid.place(np.zeros((1, count, dimensions)), np.zeros((1, count, dimensions)))
    f, lanes = grid.funcs, runtime.types().lanes

    @ti.kernel
    def move(
        agents: f.agent_array,
        whole: f.whole_array,
        rows: f.row_array,
        reals: f.real_array,
        to: ti.types.ndarray(dtype=runtime.types().real, ndim=2),
        blocks: ti.i32,
    ):
        for block in range(blocks):
            told = [
                lanes([to[whole[HEAD + whole[SLOTS] + block * LANES + k], axis] for k in ti.static(range(LANES))])
                for axis in ti.static(range(dimensions))
            ]
            f.put(agents, whole, rows, reals, told, block, f.alive_end(whole, 0))

    to = np.zeros((grid.total, dimensions), runtime.types().dtype)
    to[:count] = position
    move(grid.agents, grid.whole, grid.rows, grid.reals, to, grid.total // LANES)
    grid.sort()
    return grid


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("dimensions", [2, 3])
def test_moved_agents_lie_where_placed_ones_do(dimensions, boundary, f32):
    rng = np.random.default_rng(13)
    position = rng.random((301, dimensions)) * SIZES[dimensions]
    if boundary != "periodic":
        position[::7] = rng.normal(0, 100, position[::7].shape)
        position[3], position[5] = 1e12, -1e12  # beyond the cells that whole numbers can name
    space = Space(SIZES[dimensions], boundary)
    put = placed(space, position)
    other = Grid(space, REACH, 301)
    other.place(position[None], position[None] * 0)
    table = slice(-int(put.whole[TABLE]), None)
    assert np.array_equal(put.whole[table], other.whole[table])
    assert np.array_equal(np.sort(put.numbers), np.sort(other.numbers))
    assert np.array_equal(put.gathered(slice(0, dimensions)), other.gathered(slice(0, dimensions)))


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("count", [0, 1, 2, 9, 10_000])
def test_numbers_of_agents(count, boundary, dimensions, f32):
    rng = np.random.default_rng(3)
    size = tuple(side * (4.0 if count > 1000 and dimensions == 2 else 2.0) for side in SIZES[dimensions])
    check(Space(size, boundary), rng.random((1, count, dimensions)) * size)


@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_sparse_worlds_have_few_cells(boundary, f32):
    rng = np.random.default_rng(4)
    position = np.concatenate([rng.random((1, 200, 2)) * 3 + 5e4, rng.random((1, 200, 2)) * 1e5], axis=1)
    grid = check(Space((1e5, 1e5), boundary), position)
    assert grid.plan.cells <= 4 * 400 + 65


@pytest.mark.parametrize("dimensions", [2, 3])
def test_far_outside_an_open_world(dimensions, f32):
    rng = np.random.default_rng(5)
    size = SIZES[dimensions]
    swarm = rng.random((1, 400, dimensions)) * 8
    for where in (1e6, -1e6, 3e8):
        check(Space(size, "open"), np.concatenate([swarm, swarm + where], axis=1))


def test_outside_the_walls(f32):
    rng = np.random.default_rng(6)
    check(Space((10.0, 10.0), "walls"), rng.normal(5, 8, (1, 500, 2)))


@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_those_who_are_gone_meet_nobody(boundary, f32):
    rng = np.random.default_rng(7)
    check(Space((10.0, 10.0), boundary), rng.random((3, 300, 2)) * 10, gone=rng.random((3, 300)) < 0.4)
    check(Space((10.0, 10.0), boundary), rng.random((1, 30, 2)) * 10, gone=np.ones((1, 30), bool))


def test_agents_lie_in_stable_order_within_a_cell(f32):
    grid = Grid(Space((10.0, 10.0), "periodic"), REACH, 500)
    position = np.random.default_rng(8).random((1, 500, 2)) * 10
    grid.place(position, position * 0)
    p = grid.agents[:500, :2]
    cells = np.floor(p[:, 0] * grid.plan.per_metre[0]) + 1000 * np.floor(p[:, 1] * grid.plan.per_metre[1])
    same = np.diff(cells) == 0
    assert same.any()
    assert (np.diff(grid.numbers[0, :500])[same] > 0).all()


@pytest.mark.anew
def test_threads_and_repetition_change_no_bit():
    rng = np.random.default_rng(9)
    position = rng.random((3, 15_000, 2)) * 60
    outcomes = []
    for threads in (1, 2, 2):
        tiswarm.init("f32", threads)
        grid = Grid(Space((60.0, 60.0), "periodic"), REACH, 15_000, 3)
        assert grid.chunks == threads
        grid.place(position, position * 0.01)
        outcomes.append((grid.agents[: grid.total].copy(), grid.numbers.copy(), met(grid)))
    for other in outcomes[1:]:
        for a, b in zip(outcomes[0], other, strict=True):
            assert np.array_equal(a, b)


def test_a_trial_among_others_lies_as_it_does_alone(f32):
    position = np.random.default_rng(10).random((5, 333, 3)) * SIZES[3]
    for boundary in BOUNDARIES:
        every = Grid(Space(SIZES[3], boundary), REACH, 333, 5)
        every.place(position, position)
        for trial in range(5):
            alone = Grid(Space(SIZES[3], boundary), REACH, 333)
            alone.place(position[trial : trial + 1], position[trial : trial + 1])
            assert np.array_equal(alone.numbers[0], every.numbers[trial])


def test_broken_states_are_refused(f32):
    grid = Grid(Space((10.0, 10.0), "open"), REACH, 3)
    good = np.zeros((1, 3, 2))
    for position, velocity in (([0, np.nan], [0, 0]), ([np.inf, 0], [0, 0]), ([0, 0], [np.nan, np.nan])):
        p, v = good.copy(), good.copy()
        p[0, 1], v[0, 1] = position, velocity
        with pytest.raises(ValueError, match="not finite"):
            grid.place(p, v)
    with pytest.raises(ValueError, match="shape"):
        grid.place(good[:, :2], good[:, :2])
    with pytest.raises(ValueError, match="reach"):
        Grid(Space((10.0, 10.0), "open"), 0.0, 3)
    with pytest.raises(ValueError, match="more than a grid can number"):
        SimpleNamespace(grid=Grid(Space((10.0, 10.0), "open"), REACH, 10**6, 10**4))


def test_memory_stays_small(f32):
    for size in ((500.0, 500.0), (69.0, 69.0, 69.0)):
        for boundary in BOUNDARIES:
            cut = plan(Space(size, boundary), REACH, 1_000_000, 1e-7)
            width = 4 if len(size) == 2 else 8
            assert 2 * 4 * width + 12 + 2 * 4 * cut.cells / 1e6 <= 120


@pytest.mark.anew
def test_prepared_launches_outlive_a_restart():
    position = np.random.default_rng(14).random((1, 300, 2)) * 10
    tiswarm.init("f32", 1)
    grid = Grid(Space((10.0, 10.0), "periodic"), REACH, 300)
    grid.place(position, position * 0)
    sorted_once = grid.agents[:300].copy()
    tiswarm.init("f32", 2)
    grid.sort()
    assert np.array_equal(grid.agents[:300], sorted_once)
