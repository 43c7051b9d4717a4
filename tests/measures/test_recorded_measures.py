"""Metrics: cases worked by hand, against scikit-learn and SciPy, and what the kernel measured of the same trials."""

import numpy as np
import pytest
from made import recorded_prey
from scipy.spatial.distance import pdist
from sklearn.cluster import DBSCAN
from sklearn.neighbors import NearestNeighbors

import tiswarm
from tiswarm.measures import ground, recorded
from tiswarm.records.recording import Recording
from tiswarm.scenario.measures import MEASURED

GROUND = ("coverage", "visit-variation", "time-to-50", "time-to-90", "time-to-95", "time-to-99")
ALL = MEASURED
BODIES = tuple(name for name in ALL if name not in GROUND)
DEEP = tuple(name for name in BODIES if name != "trapped-milling")
TRAPS = ("trapped", "trapped-time", "trapped-milling")


SQUARE = [[11, 11], [9, 11], [9, 9], [11, 9]]


class TestByHand:
    def test_four_on_a_square_that_turns_mill_and_have_no_direction(self):
        turning = recorded_prey(SQUARE, [[-3, 3], [-3, -3], [3, -3], [3, 3]])
        assert recorded.milling(turning) == pytest.approx([1])
        assert recorded.polarisation(turning) == pytest.approx([0], abs=1e-12)
        assert recorded.speed(turning) == pytest.approx([3 * np.sqrt(2)])
        assert recorded.kinetic(turning) == pytest.approx([4 * 9])
        assert recorded.nearest(turning) == pytest.approx([2])

    def test_parallel_flight_has_one_direction_and_does_not_mill(self):
        flight = recorded_prey(SQUARE, [[1, 2], [2, 4], [3, 6], [0.5, 1]])
        assert recorded.polarisation(flight) == pytest.approx([1])
        assert recorded.milling(flight) == pytest.approx([0], abs=1e-12)

    def test_deep_swarms_turn_about_any_axis(self):
        ring = np.array([[0, 1, 1], [0, -1, 1], [0, -1, -1], [0, 1, -1]])
        turning = recorded_prey(ring + 10, np.cross([1, 0, 0], ring))
        assert recorded.milling(turning) == pytest.approx([1])
        assert recorded.polarisation(turning) == pytest.approx([0], abs=1e-12)

    def test_standing_prey_have_neither_direction_nor_spin(self):
        still = recorded_prey(SQUARE)
        assert (recorded.polarisation(still), recorded.milling(still), recorded.speed(still)) == (0, 0, 0)

    def test_groups_are_joined_by_chains(self):
        swarm = recorded_prey([[0, 0], [0, 1], [0, 2], [5, 5], [5, 6]])
        assert recorded.groups(swarm, 1.0) == 2
        assert recorded.groups(swarm, 0.99) == 5
        assert recorded.groups(swarm, 6.0) == 1
        assert recorded.groups(swarm) == 2  # measures.distance is 1 m

    def test_a_pair_sees_itself_across_a_periodic_edge(self):
        place = [[0.5, 10], [99.5, 49.5]]
        edges = {"world.boundary": "periodic", "world.size": [100.0, 50.0]}
        assert recorded.nearest(recorded_prey(place, **edges)) == pytest.approx([np.hypot(1, 10.5)])
        assert recorded.nearest(recorded_prey(place)) == pytest.approx([np.hypot(99, 39.5)])
        assert recorded.groups(recorded_prey(place, **edges), 10.6) == 1
        assert recorded.groups(recorded_prey(place), 10.6) == 2
        assert recorded.nearest(recorded_prey([[-1e-18, 5], [100.0, 5]], **edges)) == pytest.approx([0], abs=1e-9)

    def test_a_pair_has_its_least_energy_at_distance_one(self):
        assert recorded.potential(recorded_prey([[1, 1], [2, 1]])) == pytest.approx([1])
        at = [recorded.potential(recorded_prey([[0, 0], [r, 0]]))[0] for r in (0.5, 0.9, 1.1, 2)]
        assert at == pytest.approx([1 / r**2 + np.log(r**2) for r in (0.5, 0.9, 1.1, 2)])
        assert min(at) > 1

    def test_energy_counts_lengths_in_spacings(self):
        pair = recorded_prey([[0, 0], [3, 0]], **{"prey.spacing": 3.0})
        assert recorded.potential(pair) == pytest.approx([9])

    def test_energy_is_constant_beyond_perception(self):
        far = [recorded.potential(recorded_prey([[0, 0], [r, 0]], **{"prey.perception": 2.0})) for r in (2, 3, 50)]
        assert far == pytest.approx([0.25 + np.log(4)] * 3)

    def test_a_triangle_has_three_pairs(self):
        corners = np.array([[0, 0], [1, 0], [0.5, np.sqrt(0.75)]])
        assert recorded.potential(recorded_prey(corners)) == pytest.approx([3])
        assert recorded.nearest(recorded_prey(corners)) == pytest.approx([1])

    def test_pairs_of_large_swarms_are_counted_once(self, monkeypatch):
        swarm = recorded_prey(np.random.default_rng(3).uniform(0, 30, (100, 2)), **{"prey.perception": 12.0})
        whole = recorded.potential(swarm)
        monkeypatch.setattr(recorded, "ROWS", 7)
        assert recorded.potential(swarm) == pytest.approx(whole, rel=1e-12)
        ratio = np.minimum(pdist(swarm.prey.position[0]), 12.0) ** 2
        assert whole == pytest.approx([(1 / ratio + np.log(ratio)).sum()], rel=1e-12)

    def test_what_nobody_or_a_single_one_cannot_have_is_no_number(self):
        nan = np.nan
        thinning = recorded_prey([[[1, 1], [2, 1]], [[1, 1], [nan, nan]], [[nan, nan], [nan, nan]]], [[1, 0], [1, 0]])
        for name in ("polarisation", "milling", "speed", "kinetic", "potential", "groups"):
            assert np.isnan(recorded.MEANS[name](thinning)).tolist() == [False, False, True], name
        assert np.isnan(recorded.nearest(thinning)).tolist() == [False, True, True]
        assert np.isnan(recorded.neighbour_distances(thinning)).tolist() == [[False, False], [True, True], [True, True]]
        assert recorded.potential(thinning)[:2] == pytest.approx([1, 0])
        assert recorded.groups(thinning)[:2].tolist() == [1, 1]
        assert recorded.measured(thinning, "nearest") == pytest.approx(1)

    def test_prey_inside_an_obstacle_are_counted_once_and_not_at_the_start(self):
        path = [[[5, 5], [1, 1]], [[1, 1], [5, 5]], [[1, 1], [5, 8]], [[5, 5], [5, 8]], [[5, 5], [5, 5]]]
        stones = {"obstacles": [(5, 5, 1.0)], "prey.radius": 0.5}
        assert recorded.hits(recorded_prey(path, **stones)).tolist() == [0, 1, 1, 2, 2]

    def test_means_are_over_the_states_from_after_on(self):
        speeds = np.array([1, 2, 6])[:, None, None] * [1, 0]
        trial = recorded_prey(np.ones((3, 1, 2)), speeds, **{"measures.after": 1})
        assert recorded.measured(trial, "speed") == 4
        late = recorded_prey(np.ones((3, 1, 2)), speeds, **{"measures.after": 3})
        assert np.isnan([recorded.measured(late, name) for name in BODIES if name not in TRAPS]).all()

    def test_what_cannot_be_measured_is_told_in_one_line(self):
        with pytest.raises(ValueError, match="unknown 'polarization'; did you mean 'polarisation'"):
            recorded.measured(recorded_prey(SQUARE), "polarization")
        with pytest.raises(ValueError, match=r"set coverage\.cell"):
            recorded.measured(recorded_prey(SQUARE), "coverage")


FLOOR = {"world.size": [10.0, 6.0], "coverage.cell": 0.05, "coverage.tool": 0.7}


class TestGround:
    def test_a_straight_drive_sweeps_a_stadium(self):
        x = np.linspace(2, 8, 301)  # steps of 0.02 m
        drive = recorded_prey(np.stack([x, np.full(301, 3.01)], axis=1)[:, None], **FLOOR)
        share = recorded.coverage(drive)
        length, radius, area = x - x[0], 0.7, 60
        stadium = (2 * radius * length + np.pi * radius**2) / area
        edge = (2 * length + 2 * np.pi * radius) * 0.05 / area  # the outline's cells
        assert (np.abs(share - stadium) < edge).all()
        assert share[-1] == pytest.approx(stadium[-1], rel=0.01)
        assert (np.diff(share) >= 0).all()

    def test_standing_still_sweeps_a_disc_again_and_again(self):
        still = recorded_prey(np.full((5, 1, 2), 3.0), **FLOOR)
        found = ground.ground(still)
        assert found.share == pytest.approx([np.pi * 0.49 / 60] * 5, rel=0.01)
        assert set(np.unique(found.visits)) == {0, 5}
        assert found.variation == pytest.approx([np.sqrt(1 / found.share[0] - 1)] * 5)  # of a share p of ones: √(1/p - 1)

    def test_evenly_visited_ground_has_no_variation_and_unvisited_ground_none_at_all(self):
        tiny = {"world.size": [2.0, 2.0], "coverage.cell": 1.0, "coverage.tool": 0.6}
        rounds = [[[0.5, 0.5]], [[1.5, 0.5]], [[1.5, 1.5]], [[0.5, 1.5]]]
        assert ground.ground(recorded_prey(rounds, **tiny)).variation == pytest.approx([np.sqrt(3), 1, np.sqrt(1 / 3), 0])
        aside = ground.ground(recorded_prey([[[1.0, 1.0]]], **{**tiny, "coverage.tool": 0.1}))
        assert np.isnan(aside.variation).all()
        assert aside.share == 0

    def test_two_tools_on_one_cell_are_two_visits(self):
        tiny = {"world.size": [2.0, 1.0], "coverage.cell": 1.0, "coverage.tool": 0.4}
        assert ground.ground(recorded_prey([[0.5, 0.5], [0.6, 0.5]], **tiny)).visits.tolist() == [[2, 0]]

    def test_cells_under_obstacles_and_outside_the_world_do_not_count(self):
        odd = {"world.size": [2.4, 1.0], "coverage.cell": 1.0, "coverage.tool": 0.4}
        found = ground.ground(recorded_prey([[0.5, 0.5]], **odd, obstacles=[(1.5, 0.5, 0.2)]))
        assert found.visits.tolist() == [[1, -1, -1]]
        assert found.share == 1

    def test_times_are_when_a_share_was_passed(self):
        tiny = {"world.size": [4.0, 1.0], "coverage.cell": 1.0, "coverage.tool": 0.4, "world.dt": 0.5}
        trial = recorded_prey([[[0.5, 0.5]], [[1.5, 0.5]], [[2.5, 0.5]]], **tiny)
        assert recorded.time_to(trial, 0.5) == 0.5
        assert recorded.measured(trial, "time-to-50") == 0.5
        assert np.isnan(recorded.measured(trial, "time-to-90"))
        assert recorded.measured(trial, "coverage") == 0.75

    def test_tools_reach_over_walls_only_in_vain(self):
        corner = recorded_prey([[0.1, 0.1], [9.95, 5.9]], **{**FLOOR, "coverage.tool": 4.0})
        visits = ground.ground(corner).visits
        y, x = np.indices(visits.shape) * 0.05 + 0.025
        expected = sum(((x - cx) ** 2 + (y - cy) ** 2 <= 16).astype(int) for cx, cy in corner.prey.position[0])
        np.testing.assert_array_equal(visits, expected)


class TestAgainstLibraries:
    @pytest.mark.parametrize("dim", [2, 3])
    def test_nearest_neighbours(self, dim):
        swarm = recorded_prey(np.random.default_rng(dim).uniform(0, 20, (3, 60, dim)))
        for tick, places in enumerate(swarm.prey.position):
            expected = NearestNeighbors(n_neighbors=2, algorithm="brute").fit(places).kneighbors()[0][:, 0]
            np.testing.assert_allclose(recorded.neighbour_distances(swarm)[tick], expected, rtol=1e-6)
            assert recorded.nearest(swarm)[tick] == pytest.approx(expected.mean(), rel=1e-6)

    def test_nearest_neighbours_in_a_periodic_world(self):
        swarm = recorded_prey(np.random.default_rng(5).uniform(0, 20, (1, 40, 2)), **{"world.boundary": "periodic"} | PERIODIC)
        places = swarm.prey.position[0]
        images = np.concatenate([places + np.array([x, y]) for x in (-20, 0, 20) for y in (-20, 0, 20)])
        expected = NearestNeighbors(n_neighbors=2).fit(images).kneighbors(places)[0][:, 1]
        np.testing.assert_allclose(recorded.neighbour_distances(swarm)[0], expected, rtol=1e-9)

    @pytest.mark.parametrize("distance", [0.5, 1.5, 2.5, 4.0])
    def test_groups(self, distance):
        swarm = recorded_prey(np.random.default_rng(8).uniform(0, 20, (4, 50, 2)))
        expected = [len(set(DBSCAN(eps=distance, min_samples=1).fit(places).labels_)) for places in swarm.prey.position]
        assert recorded.groups(swarm, distance).tolist() == expected


PERIODIC = {"world.size": [20.0, 20.0], "prey.spawn.region": [[0, 0], [1, 1]]}


def _agree(preset: str, names: tuple[str, ...], trials: int = 9, **overrides) -> Recording:
    """Hold what the kernel measured of the first and the last trial of a batch against their recordings; give the last."""
    scenario = tiswarm.load(preset, {**overrides, "measures.names": list(names)})
    results = tiswarm.simulate(scenario, trials, seed=3)
    assert set(results.measures) == set(names)
    for trial in (0, trials - 1):
        recording = tiswarm.record(scenario, trial, seed=3)
        for name in names:
            expected = pytest.approx(results.measures[name][trial], rel=1e-9, abs=1e-9, nan_ok=True)
            assert recorded.measured(recording, name) == expected, f"{name} of trial {trial}"
    return recording


@pytest.mark.usefixtures("f64")
class TestKernelAgainstRecording:
    @pytest.mark.parametrize("contact", ["none", "bounce", "eaten", "deadly"])
    def test_the_hawk(self, contact):
        own = {"world.contact": contact, "measures.distance": 1.5, "measures.after": 20, "predators.radius": 2.0}
        recording = _agree("m20/hawk", BODIES, **own)
        assert (recording.prey.fate == "captured").any() == (contact in ("eaten", "deadly"))

    def test_boids_on_ground_with_obstacles(self):
        stones = {"obstacles.count": 5, "obstacles.region": [[100, 100], [500, 400]], "obstacles.radius": [10, 30]}
        own = {"world.ticks": 250, "measures.distance": 40.0, "coverage.cell": 9.0, **stones}
        recording = _agree("sanitation/boids", ALL, **own)
        assert recorded.coverage(recording)[-1] > 0.5
        assert (ground.ground(recording).visits < 0).sum() > 20

    def test_robots_on_two_wheels_whose_touches_are_counted(self):
        own = {"world.ticks": 600, "obstacles.count": 4, "obstacles.contact": "count", "measures.distance": 0.3}
        own |= {"obstacles.region": [[0.5, 0.5], [2.5, 1.5]], "obstacles.radius": [0.1, 0.2]}
        recording = _agree("sanitation/arena", ALL, **own)
        assert recorded.hits(recording)[-1] > 0

    def test_robots_in_a_potential(self):
        _agree("sanitation/potential", BODIES, **{"world.ticks": 500, "measures.after": 100, "prey.perception": 1.5})

    @pytest.mark.parametrize("avoidance", ["none", "distance-perception"])
    def test_boids_between_spheres(self, avoidance):
        own = {"world.ticks": 120, "prey.count": 20, "measures.distance": 5.0, "prey.avoidance": avoidance}
        recording = _agree("lookout/aquarium", DEEP, **own, **{"measures.after": 10})
        assert (recorded.hits(recording)[-1] > 0) == (avoidance == "none")

    def test_trials_that_end_early_have_what_they_lived_to_see(self):
        own = {"coverage.cell": 1.0, "coverage.tool": 2.0, "measures.distance": 2.0}
        _agree("delft/pronav-10", ALL, trials=20, **own)
        _agree("delft/pronav-10", ALL, trials=20, **own, **{"measures.after": 90})

    def test_a_trial_of_one_tick_has_two_states(self):
        _agree("sanitation/arena", ALL, **{"world.ticks": 1})


CASES = [("m20/hawk", BODIES, {"world.contact": "eaten"}), ("sanitation/arena", ALL, {"world.ticks": 150})]


@pytest.mark.parametrize(("preset", "names", "own"), CASES)
class TestBatches:
    @pytest.mark.anew
    def test_threads_change_no_bit(self, preset, names, own):
        scenario = tiswarm.load(preset, {**own, "measures.names": list(names)})
        results = []
        for threads in (1, 2):
            tiswarm.init("f32", threads)
            results.append(tiswarm.simulate(scenario, 30, seed=1).measures)
        tiswarm.init("f32")
        for name in names:
            np.testing.assert_array_equal(results[0][name], results[1][name], err_msg=name)

    def test_a_trial_alone_is_the_trial_in_the_batch(self, preset, names, own, f32):
        scenario = tiswarm.load(preset, {**own, "measures.names": list(names)})
        many, few = (tiswarm.simulate(scenario, count, seed=1).measures for count in (30, 1))
        for name in names:
            np.testing.assert_array_equal(many[name][:1], few[name], err_msg=name)
        recording = tiswarm.record(scenario, 17, seed=1)
        for name in names:
            expected = pytest.approx(many[name][17], rel=2e-4, abs=2e-4, nan_ok=True)  # f32 against f64 sums
            assert recorded.measured(recording, name) == expected, name


def test_settling_and_overshoot_of_a_swing_worked_by_hand():
    apart = np.array([2.0, 1.0, 2.6, 2.0, 1.9, 2.0])
    pace = np.array([0.0, 1.0, 0.5, 0.06, 0.04, 0.05])
    position = np.stack([np.stack([-apart / 2, 0 * apart], 1), np.stack([apart / 2, 0 * apart], 1)], axis=1) + 10.0
    velocity = np.stack([np.stack([pace, 0 * pace], 1)] * 2, axis=1)
    recording = recorded_prey(position, velocity, **{"world.dt": 0.5})
    assert recorded.settling_time(recording) == pytest.approx(3 * 0.5)  # 0.05 is no more than a twentieth of 1
    assert recorded.overshoot(recording) == pytest.approx(2.6 / 2.0 - 1)
    assert recorded.settling_time(recording, after=4) == pytest.approx(5 * 0.5)  # of 0.05, the greatest from there on
    still = recorded_prey(position, 0 * velocity)
    assert recorded.settling_time(still) == 0.0
