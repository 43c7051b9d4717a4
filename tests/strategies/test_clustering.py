"""Clustering: K-means and knees in lanes against scikit-learn and kneed."""

import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import taichi as ti
from kneed import KneeLocator

import tiswarm
from tiswarm.simd import philox, runtime
from tiswarm.simd.runtime import LANES, TASK
from tiswarm.strategies.clustering import kmeans, reference

sys.path.insert(0, str(Path(__file__).parents[1] / "conformance"))
import clusters

_kernels = {}


def _kernel(dim):
    """Build a kernel that clusters the prey of a block, whose rows are their places and whether they are alive."""
    key = (runtime.generation(), dim)
    if key in _kernels:
        return _kernels[key]
    types = runtime.types()
    rows = SimpleNamespace(place=list(range(dim)), alive=dim)
    open_world = SimpleNamespace(frame=SimpleNamespace(wrap_sight=False))
    layout = SimpleNamespace(axes=range(dim), rows=rows, structure=open_world, agent_rows={"prey": dim + 1})
    cluster = kmeans.build(layout, types, philox.build(types).uniform).find
    flat, words = types.lane_array(1), ti.types.ndarray(dtype=types.integer_lanes, ndim=1)

    @ti.kernel
    def run(board: flat, prey: flat, weights: flat, trial: words, blocks: ti.i32, n: ti.i32, height: ti.i32):
        for index in range(blocks * TASK):
            if index % TASK == 0:
                b = index // TASK
                zero = trial[b] & ti.u32(0)
                a = b * n * (dim + 1)
                size = [types.lanes(0.0) for _ in ti.static(range(dim))]  # of a periodic world, which this is not
                most, restarts = weights[2 * b], weights[2 * b + 1]
                cluster(board, b * height, n, prey, a, size, most, restarts, trial[b], zero, ti.u32(5), ti.u32(0))

    _kernels[key] = run
    return run


def cluster(sets, most=5, restarts=64, room=None, order=None):
    """Cluster prey sets, NaN for prey that are gone; room: prey that a kernel has room for; order: of the sets in lanes.

    Returns for each set its count, its inertia for each k, and its labels.
    """
    dim = sets[0].shape[1]
    room = room or max(map(len, sets))
    order = np.arange(len(sets)) if order is None else order
    blocks = -(-len(sets) // LANES)
    at = kmeans.board_rows(dim)
    dtype = runtime.types().dtype
    height = at.fixed + at.each * room
    board = runtime.aligned((blocks * height, LANES), dtype)
    prey = runtime.aligned((blocks * room * (dim + 1), LANES), dtype)
    weights = runtime.aligned((blocks * 2, LANES), dtype)
    trial = runtime.aligned((blocks, LANES), np.uint32)
    weights[0::2], weights[1::2] = most, restarts
    for place, number in enumerate(order):
        points = sets[number]
        mine = prey[:, place % LANES].reshape(blocks, room, dim + 1)[place // LANES, : len(points)]
        mine[:, :dim] = np.nan_to_num(points, nan=1e4)
        mine[:, dim] = np.isfinite(points[:, 0])
        trial[place // LANES, place % LANES] = number
    _kernel(dim)(board, prey, weights, trial, blocks, room, height)
    found = [None] * len(sets)
    for place, number in enumerate(order):
        mine = board.reshape(blocks, height, LANES)[place // LANES, :, place % LANES]
        labels = mine[at.points :][: len(sets[number])].astype(int)
        found[number] = SimpleNamespace(
            count=int(mine[at.count]),
            inertia=mine[at.inertia : at.inertia + most].astype(float),
            label=labels,
            centre=mine[at.centres :][: kmeans.MOST * dim].reshape(-1, dim),
        )
    return found


@pytest.fixture(scope="module")
def sets():
    return clusters.prey_sets()


@pytest.fixture(scope="module")
def measured():
    return np.load(clusters.FILE)["inertia"]


def _kneed(inertia):
    """Give kneed's number of clusters, 1 where it finds no knee."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        knee = KneeLocator(np.arange(1, len(inertia) + 1), inertia, curve="convex", direction="decreasing").knee
    return int(knee or 1)


def _equal(one, other):
    assert one.count == other.count
    for name in ("inertia", "label", "centre"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)


class TestAgainstTheYardstick:
    def test_inertia_is_never_worse_and_knees_agree(self, f64, sets, measured):
        assert len(sets) == len(measured) >= 5000
        agreeing = 0
        for found, inertia in zip(cluster(sets), measured, strict=True):
            floor = 1e-12 * inertia[0]
            assert (found.inertia <= inertia * (1 + 1e-5) + floor).all()
            if (found.inertia >= inertia * (1 - 1e-5) - floor).all():
                agreeing += 1
                assert found.count == _kneed(inertia)
        assert agreeing > 0.9 * len(sets)  # in most of the others scikit-learn stops early, or at a local minimum

    def test_the_file_of_the_yardstick_is_what_scikit_learn_says(self, sets, measured):
        for number in np.random.default_rng(0).choice(len(sets), 6, replace=False):
            np.testing.assert_allclose(clusters.inertias(sets[number]), measured[number], rtol=1e-6, atol=1e-9)

    @pytest.mark.parametrize("most", range(1, 9))
    def test_knees_are_kneeds_for_any_number_of_clusters(self, f64, sets, most):
        corners = np.array([[0, 0], [9, 0], [0, 9], [9, 9], [50, 50], [51, 50]], float)
        random = np.random.default_rng(most)
        repeated = [corners[random.integers(6, size=random.integers(1, 9))] for _ in range(200)]  # zeros and ties
        for found in cluster([*repeated, *sets[:900:3]], most):
            assert found.count == _kneed(found.inertia)

    def test_labels_and_centres_are_those_of_the_inertia(self, f64, sets):
        chosen = sets[::7]
        for points, found in zip(chosen, cluster(chosen), strict=True):
            own = found.centre[found.label]
            np.testing.assert_allclose(((points - own) ** 2).sum(), found.inertia[found.count - 1], rtol=1e-9, atol=1e-9)
            assert list(dict.fromkeys(found.label)) == list(range(found.count))  # numbered by their first prey
            for c in range(found.count):
                np.testing.assert_allclose(found.centre[c], points[found.label == c].mean(axis=0))

    def test_single_precision_finds_the_same_clusters(self, f64, sets):
        chosen = sets[::5]
        double = [found.count for found in cluster(chosen)]
        tiswarm.init("f32")
        single = [found.count for found in cluster(chosen)]
        assert np.mean(np.array(double) == single) > 0.995

    def test_up_to_eight_prey_all_partitions_are_compared(self, f64, sets):
        for points in [each for each in sets if len(each) == 6][:20]:
            best = np.full(5, np.inf)
            for labels in np.ndindex(*(5,) * 5):
                label = np.array([0, *labels])
                k = len(set(labels) | {0})
                if set(range(k)) == set(label):
                    within = sum(
                        ((own := points[label == c]) - own.mean(axis=0)).var(axis=0).sum() * len(own) for c in range(k)
                    )
                    best[k - 1] = min(best[k - 1], within)
            np.testing.assert_allclose(cluster([points])[0].inertia, best, rtol=1e-9)


class TestEdges:
    @pytest.mark.parametrize("count", [1, 2, 5, 8, 9, 20])
    def test_prey_that_coincide_are_one_sub_swarm(self, precision, count):
        found = cluster([np.full((count, 2), [71.3, 22.7])])[0]
        assert found.count == 1
        assert (found.inertia == 0).all()
        assert (found.label == 0).all()
        np.testing.assert_allclose(found.centre[0], [71.3, 22.7], rtol=1e-6)

    @pytest.mark.parametrize("count", [4, 8, 9, 20])
    def test_two_heaps_are_two(self, precision, count):
        points = np.array([[71.3, 22.7], [13.1, 4.4]])[np.arange(count) % 2]
        found = cluster([points])[0]
        assert found.count == 2
        np.testing.assert_array_equal(found.label, np.arange(count) % 2)
        assert (found.inertia[1:] <= 1e-12 * found.inertia[0]).all()

    def test_all_gone_but_one(self, precision):
        points = np.full((6, 2), np.nan)
        points[4] = 30, 40
        found = cluster([points])[0]
        assert found.count == 1
        np.testing.assert_array_equal(found.label, [-1, -1, -1, -1, 0, -1])
        np.testing.assert_array_equal(found.centre[0], [30, 40])

    def test_all_gone(self, precision):
        found = cluster([np.full((6, 2), np.nan)])[0]
        assert found.count == 1
        assert (found.label == -1).all()
        assert (found.centre == 0).all()

    @pytest.mark.parametrize("count", [2, 3, 4])
    def test_fewer_prey_than_clusters(self, f64, sets, count):
        points = np.random.default_rng(count).uniform(0, 50, (count, 2))
        found = cluster([points])[0]
        assert (found.inertia[count - 1 :] == 0).all()
        assert found.count == _kneed(found.inertia) <= count

    def test_prey_that_are_gone_change_no_bit(self, precision, sets):
        random = np.random.default_rng(3)
        chosen = sets[::40]
        holed, places = [], []
        for points in chosen:
            places.append(np.sort(random.choice(len(points) + 4, len(points), replace=False)))
            holed.append(np.full((len(points) + 4, 2), np.nan))
            holed[-1][places[-1]] = points
        for found, other, place in zip(cluster(chosen), cluster(holed), places, strict=True):
            other.label = other.label[place]
            _equal(found, other)

    def test_company_and_room_change_no_bit(self, precision, sets):
        chosen = sets[::40]
        order = np.random.default_rng(1).permutation(len(chosen))
        for found, other in zip(cluster(chosen), cluster(chosen, room=40, order=order), strict=True):
            _equal(found, other)

    def test_three_dimensions(self, f64):
        points = np.random.default_rng(0).normal(size=(12, 3)) + 20 * np.eye(3)[np.arange(12) % 3]
        found = cluster([points])[0]
        np.testing.assert_array_equal(found.label, np.arange(12) % 3)


def test_the_yardstick_numbers_sub_swarms_by_their_first_prey():
    position = np.array([[90.0, 0], [0, 0], [np.nan, np.nan], [91, 0], [1, 0], [90, 1]])
    count, label, centres = reference.sub_swarms(position, 5)
    assert count == 2
    np.testing.assert_array_equal(label, [0, 1, -1, 0, 1, 0])
    np.testing.assert_allclose(centres, [[271 / 3, 1 / 3], [0.5, 0]])
