"""Clustering: K-means and knees in lanes against scikit-learn and kneed; predators that split up."""

import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import taichi as ti
from kneed import KneeLocator

import tiswarm
from tiswarm.engine.trials.batch import simulate_many
from tiswarm.engine.trials.kernel import OUTCOMES
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
    layout = SimpleNamespace(axes=range(dim), rows=rows, agent_rows={"prey": dim + 1})
    cluster = kmeans.build(layout, types, philox.build(types).uniform)
    flat, words = types.lane_array(1), ti.types.ndarray(dtype=types.integer_lanes, ndim=1)

    @ti.kernel
    def run(board: flat, prey: flat, weights: flat, trial: words, blocks: ti.i32, n: ti.i32, height: ti.i32):
        for index in range(blocks * TASK):
            if index % TASK == 0:
                b = index // TASK
                zero = trial[b] & ti.u32(0)
                a = b * n * (dim + 1)
                cluster(board, b * height, n, prey, a, weights[2 * b], weights[2 * b + 1], trial[b], zero, ti.u32(5), ti.u32(0))

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


class TestPredators:
    def test_threads_and_company_change_no_bit(self):
        scenarios = [
            tiswarm.load("delft/cluster-10"),
            tiswarm.load("delft/cluster-10", {"prey.count": 11, "predators.weights.restarts": 3}),
            tiswarm.load("delft/cluster-10", {"predators.strategy": "pronav"}),
            tiswarm.load("delft/cluster-0", {"predators.weights.max_clusters": 3, "predators.weights.sticky": True}),
        ]
        tiswarm.init("f32", 1)
        together = simulate_many(scenarios, 24, seed=4)
        tiswarm.init("f32", 2)
        for one, scenario in zip(together, scenarios, strict=True):
            if scenario.predators.strategy == "cluster":
                alone = tiswarm.simulate(scenario, 24, seed=4)
                for name in OUTCOMES:
                    np.testing.assert_array_equal(getattr(one, name), getattr(alone, name))
        tiswarm.init("f32")

    def test_with_one_cluster_they_steer_for_the_centre(self, f64):
        one = tiswarm.record(tiswarm.load("delft/cluster-10", {"predators.weights.max_clusters": 1}), 2)
        other = tiswarm.record(tiswarm.load("delft/cluster-10", {"predators.strategy": "centre"}), 2)
        np.testing.assert_array_equal(one.predators.position, other.predators.position)

    def test_recordings_tell_who_chases_whom(self, f64):
        path = tiswarm.record(tiswarm.load("delft/cluster-10"), 1)
        assert (path.prey.group[0] == -1).all()
        assert (path.predators.group[0] == -1).all()
        counts = path.prey.group.max(axis=1) + 1
        assert set(counts[1:]) <= {1, 2, 3, 4, 5}
        for tick in range(1, path.ticks):
            np.testing.assert_array_equal(path.predators.group[tick], np.arange(1, 13) % counts[tick])

    def test_each_flies_for_its_centre_and_flocks_with_its_own(self, f64):
        off = {f"predators.{name}": 0 for name in ("separation", "alignment")}
        scenario = tiswarm.load("delft/cluster-0", {**off, "predators.cohesion": 0.01, "predators.max_speed": 100})
        path = tiswarm.record(scenario.replaced({"world.ticks": 1, "predators.perception": 1000}), 6)
        mine = path.predators.group[1]
        assert mine.max() > 0
        place, velocity = path.predators.position[0], path.predators.velocity[0]
        for j in range(12):
            mates = (mine == mine[j]) & (np.arange(12) != j)
            centre = path.prey.position[1][path.prey.group[1] == mine[j]].mean(axis=0)
            expected = velocity[j] + 0.1 * (centre - place[j]) + 0.01 * (place[mates].mean(axis=0) - place[j])
            np.testing.assert_allclose(path.predators.velocity[1][j], expected)

    def test_sticky_ones_keep_their_sub_swarm_when_labels_are_renumbered(self, f64):
        renumbered = 0
        for trial in range(3):
            path = tiswarm.record(tiswarm.load("delft/cluster-10", {"predators.weights.sticky": True}), trial)
            chased = None
            for tick in range(1, path.ticks):
                labels = path.prey.group[tick]
                if np.isnan(path.prey.position[tick][labels >= 0]).any():  # of a prey that died in this tick no place is kept
                    chased = None
                    continue
                centres = np.stack([path.prey.position[tick][labels == c].mean(axis=0) for c in range(labels.max() + 1)])
                mine = path.predators.group[tick]
                if chased is not None:
                    apart = np.linalg.norm(chased[:, None] - centres[None], axis=2)
                    np.testing.assert_array_equal(mine, apart.argmin(axis=1))
                    renumbered += (labels != path.prey.group[tick - 1]).any() and (mine != path.predators.group[tick - 1]).any()
                chased = centres[mine]
        assert renumbered > 0

    def test_scikit_learn_and_kneed_live_give_the_same_path(self, f64):
        scenario = tiswarm.load("delft/cluster-10", {"world.ticks": 6})
        path = tiswarm.record(scenario, 3)
        live = tiswarm.record(scenario.replaced({"predators.weights.reference": True}), 3)
        np.testing.assert_array_equal(live.prey.group, path.prey.group)
        np.testing.assert_array_equal(live.predators.group, path.predators.group)
        np.testing.assert_allclose(live.predators.position, path.predators.position, rtol=1e-12)

    def test_a_deep_world(self, f64):
        deep = {
            "world.size": [100, 50, 50],
            "target.position": [10, 25, 25],
            "prey.spawn": {"region": [[80, 30, 20], [88, 38, 30]], "velocity": [[0, 0, 0], [1, 1, 1]]},
            "predators.spawn": {"region": [[10, 0, 0], [18, 8, 8]], "velocity": [[0, 0, 0], [1, 1, 1]]},
            "prey.avoidance": "none",
        }
        path = tiswarm.record(tiswarm.load("delft/cluster-0", {**deep, "world.ticks": 20}))
        path.check()
        assert path.prey.group[1:].max() > 0

    def test_many_trials_do_not_wait_for_scikit_learn(self):
        scenario = tiswarm.load("delft/cluster-10", {"predators.weights.reference": True})
        with pytest.raises(tiswarm.ScenarioError, match=r"predators.weights.reference: works in single trials"):
            tiswarm.simulate(scenario, 4)
        scenario = tiswarm.load("delft/cluster-10")
        with pytest.raises(tiswarm.ScenarioError, match="is the same for all trials of a batch"):
            tiswarm.simulate(scenario, 2, weights={"predators.weights.reference": np.array([0, 1])})

    @pytest.mark.parametrize(
        ("key", "value"), [("max_clusters", 0), ("max_clusters", 9), ("max_clusters", 2.5), ("restarts", -1)]
    )
    def test_counts_that_cannot_be_are_refused(self, key, value):
        with pytest.raises(
            tiswarm.ScenarioError, match=rf"predators.weights.{key}: {value} is not allowed; use a whole number"
        ):
            tiswarm.load("delft/cluster-10", {f"predators.weights.{key}": value})


def test_the_yardstick_numbers_sub_swarms_by_their_first_prey():
    position = np.array([[90.0, 0], [0, 0], [np.nan, np.nan], [91, 0], [1, 0], [90, 1]])
    count, label, centres = reference.sub_swarms(position, 5)
    assert count == 2
    np.testing.assert_array_equal(label, [0, 1, -1, 0, 1, 0])
    np.testing.assert_allclose(centres, [[271 / 3, 1 / 3], [0.5, 0]])
