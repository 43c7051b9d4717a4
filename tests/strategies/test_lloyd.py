"""Lloyd: K-means fitted anew in lanes, against the law by which scikit-learn's fits order their centres."""

from collections import Counter
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
import taichi as ti
from scipy import stats
from sklearn.cluster import KMeans
from threadpoolctl import threadpool_limits

import tiswarm
from tiswarm.simd import philox, runtime
from tiswarm.simd.runtime import LANES, TASK
from tiswarm.strategies.clustering import kmeans, lloyd

DRAWS = 20_000
FITS = 300
# What prey look like that flee (apart, a tail, one lost), and two plainer sets: places, and the clusters that their knee gives.
SETS = {
    "a pair and a single one": ([[0, 0], [1, 0], [9, 2]], 2),
    "five and a single one": ([[0, 0], [1, 1], [2, 0], [1, -1], [0.5, 2], [12, 3]], 2),
    "four and two, near": ([[0, 0], [3, 1], [2, 4], [5, 3], [9, 6], [12, 5]], 2),
    "three and three": ([[0, 0], [2, 1], [1, 3], [8, 8], [10, 9], [9, 12]], 2),
    "one, two and three": ([[0, 0], [14, 1], [15, 3], [3, 16], [5, 15], [4, 18]], 3),
    "two, one and one": ([[0, 0], [2, 0], [20, 1], [5, 17]], 3),
    "three heaps": ([[0, 0], [1, 0], [10, 0], [11, 1], [5, 10], [6, 12], [5, 12]], 3),
    "ten, more than all partitions are compared of": (
        [[0, 0], [1, 2], [2, 1], [3, 3], [1, 1], [15, 2], [16, 3], [17, 2], [6, 20], [7, 22]],
        3,
    ),
}


@cache
def _kernel(generation, draws):
    types = runtime.types()
    lanes = types.lanes
    dim, n = 2, max(len(points) for points, _ in SETS.values())
    rows = SimpleNamespace(place=[0, 1], alive=2)
    open_world = SimpleNamespace(frame=SimpleNamespace(wrap_sight=False))
    layout = SimpleNamespace(axes=range(dim), rows=rows, structure=open_world, agent_rows={"prey": 3})
    at = kmeans.board_rows(dim)
    uniform = philox.build(types).uniform
    cluster = kmeans.build(layout, types, uniform).find
    fit = lloyd.build(types, dim, kmeans.MOST, at, uniform)
    flat, words = types.lane_array(1), ti.types.ndarray(dtype=types.integer_lanes, ndim=1)

    @ti.kernel
    def run(board: flat, prey: flat, words: words, drawn: flat, wanted: ti.i32):
        for index in range(TASK):
            if index % TASK == 0:
                size = [lanes(0.0) for _ in ti.static(range(dim))]  # of a periodic world, which this is not
                cluster(board, 0, n, prey, 0, size, lanes(5.0), lanes(64.0), words[0], words[1], ti.u32(5), ti.u32(0))
                for number in range(draws):
                    place = lanes(ti.cast(wanted, types.real))
                    clusters = board[at.count]
                    fit.draw(board, 0, n, clusters, place, lanes(1.0), number, words[0], words[1], ti.u32(5), ti.u32(0))
                    members = lanes(0.0)
                    for i in range(n):
                        members = 2.0 * members + board[at.points + at.drawn * n + n - 1 - i]
                    drawn[number] = members

    return run, n, at


def draw(draws=DRAWS, order=None):
    """Draw fits of all sets, one a lane: [draw, place, set], the prey of the centre at each place as the bits of a number.

    There are at least as many lanes as sets.
    """
    order = list(order or range(len(SETS)))
    run, n, at = _kernel(runtime.generation(), draws)
    dtype = runtime.types().dtype
    board = runtime.aligned((at.fixed + at.each * n, LANES), dtype)
    prey = runtime.aligned((n * 3, LANES), dtype)
    words = runtime.aligned((2, LANES), np.uint32)
    drawn = runtime.aligned((draws, LANES), dtype)
    sets = list(SETS.values())
    for lane, number in enumerate(order):
        words[0, lane] = number
        points = sets[number][0]
        for i, point in enumerate(points):
            prey[3 * i : 3 * i + 3, lane] = *point, 1.0
    found = []
    for wanted in range(3):
        run(board, prey, words, drawn, wanted)
        found.append(drawn.copy())
    assert board[at.count, : len(order)].tolist() == [sets[number][1] for number in order]
    return np.stack(found, axis=1)[:, :, np.argsort(order)].astype(int)


@cache
def fitted():
    """Let scikit-learn fit the sets as often: set -> [fit, place], the same numbers of bits."""
    found = {}
    with threadpool_limits(1):
        for name, (points, clusters) in SETS.items():
            random = np.random.RandomState(len(found))
            bits = 1 << np.arange(len(points))
            fits = [KMeans(clusters, n_init=10, random_state=random).fit(points).labels_ for _ in range(FITS)]
            found[name] = np.array([[bits[labels == c].sum() for c in range(clusters)] for labels in fits])
    return found


@pytest.fixture(scope="module")
def drawn():
    tiswarm.init("f64")
    return draw()


@pytest.mark.parametrize("name", SETS)
def test_the_order_of_centres_follows_scikit_learns_law(drawn, name, f64):
    clusters = SETS[name][1]
    ours = Counter(map(tuple, drawn[:, :clusters, list(SETS).index(name)].tolist()))
    theirs = Counter(map(tuple, fitted()[name].tolist()))
    assert sum(theirs[order] for order in ours) > 0.998 * FITS  # but for some minimum that is rare in both
    orders = sorted(ours, key=lambda order: ours[order])
    table = np.array([[counts[order] for order in orders] for counts in (ours, theirs)])
    common = table[:, table.sum(axis=0) > 60]
    assert stats.chi2_contingency(common, correction=False).pvalue > 0.01


def test_the_law_is_not_that_of_random_labels():
    """A single prey far from five others is the first centre in one fit of six or little more, else the second."""
    drawn = draw(2000)[:, :, list(SETS).index("five and a single one")]
    assert 0.14 < (drawn[:, 0] == 0b100000).mean() < 0.21
    np.testing.assert_array_equal(drawn[:, 0] + drawn[:, 1], 0b111111)
