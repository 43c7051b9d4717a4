"""Deadlocks: who is trapped and who is not, by hand; the kernel against recordings; and that nobody pays who does not ask."""

from dataclasses import replace

import numpy as np
import pytest

import tiswarm
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.dynamics.table import ParameterTable
from tiswarm.measures import recorded
from tiswarm.measures.deadlocks import deadlocks
from tiswarm.records.recording import Recording, Swarm
from tiswarm.scenario.model import Scenario, ScenarioError
from tiswarm.simd import runtime
from tiswarm.studies.run import run_study

MEASURES = ("trapped", "trapped-time", "trapped-milling")
WINDOW, WITHIN, PATH = 40, 4.0, 20.0  # the defaults
TICKS = np.arange(121)


def _recording(position, **overrides) -> Recording:
    """Record prey on given paths; position: [tick, agent, dim]."""
    position = np.asarray(position, np.float64)
    rows, count, _ = position.shape
    scenario = Scenario().replaced({"prey.count": count, "obstacles.count": 0, **overrides})
    velocity = np.where(np.isfinite(position), 0.0, np.nan)
    prey = Swarm(position, velocity, np.full(count, "alive"), np.full((rows, count), "calm"), np.full((rows, count), -1))
    nobody = Swarm(*np.zeros((2, rows, 0, 2)), np.zeros(0, str), np.zeros((rows, 0), str), np.zeros((rows, 0), int))
    return Recording(scenario, 0, 0, prey, nobody, np.zeros((0, 2)), np.zeros(0))


def _circle(radius, pace=1.0, ticks=TICKS):
    """Go around (50, 25) anticlockwise in steps of `pace` metres along the arc: [tick, 2]."""
    angle = ticks * pace / radius
    return np.stack([50 + radius * np.cos(angle), 25 + radius * np.sin(angle)], axis=1)


def _time(path, **overrides) -> np.ndarray:
    """Give for how many ticks one prey on a path [tick, 2] has been trapped: [tick]."""
    return deadlocks(_recording(np.asarray(path)[:, None], **overrides)).time[:, 0]


class TestByHand:
    def test_who_circles_within_the_distance_is_trapped_from_the_first_full_window_on(self):
        time = _time(_circle(1.9))
        assert (time[:WINDOW] == 0).all()
        np.testing.assert_array_equal(time[WINDOW:], TICKS[WINDOW:])

    def test_who_circles_more_widely_is_not(self):
        assert _time(_circle(2.1))[-1] == 0
        assert _time(_circle(2.1), **{"measures.within": 4.3})[-1] == 120

    def test_who_flies_straight_on_is_not(self):
        assert _time(np.stack([TICKS * 0.6, TICKS * 0.8], axis=1))[-1] == 0

    def test_who_stands_still_or_creeps_is_not_however_long(self):
        assert _time(np.full((2001, 2), 5.0))[-1] == 0
        creeping = _circle(1.0, pace=0.45, ticks=np.arange(2001))  # 900 m in all, 18 m in a window
        assert _time(creeping)[-1] == 0
        assert _time(creeping, **{"measures.path": 17.0})[-1] == 2000

    def test_who_walks_along_a_wall_is_not(self):
        assert _time(np.stack([np.minimum(TICKS * 0.6, 99), np.full(121, 0.5)], axis=1))[-1] == 0

    def test_who_hops_to_and_fro_is_and_does_not_circle(self):
        swung = 0.01 * TICKS  # rad: each hop turns its course by a little less than half a circle, always to one side
        hop = np.stack([np.cos(swung), np.sin(swung)], axis=1) * (-1.0) ** TICKS[:, None]
        trial = _recording(hop[:, None])
        assert deadlocks(trial).time[-1, 0] == 120
        assert recorded.measured(trial, "trapped-milling") == pytest.approx(0, abs=0.02)

    @pytest.mark.parametrize("sense", [1, -1])
    def test_circling_has_its_sense(self, sense):
        ticks = np.arange(2000)
        smooth = _recording((_circle(1.9, 0.6, ticks) * [1, sense])[:, None])
        assert recorded.measured(smooth, "trapped-milling") == pytest.approx(sense * np.cos(0.6 / 1.9 / 2), abs=0.01)
        for corners, share in ((6, np.sqrt(0.75)), (4, np.sqrt(0.5)), (3, 0.5)):
            hops = _circle(1.0, 2 * np.pi / corners, ticks)
            trial = _recording((hops * [1, sense])[:, None])
            assert recorded.measured(trial, "trapped-milling") == pytest.approx(sense * share, abs=0.01)

    def test_who_comes_circles_and_goes_was_trapped_as_long_as_it_circled(self):
        come = np.stack([np.arange(-30, 0), np.zeros(30)], axis=1)
        turns = _circle(1.0, pace=1.0, ticks=np.arange(60)) - [51, 25]
        go = np.stack([np.arange(3, 40), np.zeros(37)], axis=1)
        time = _time(np.concatenate([come, turns, go]))
        assert 59 <= time[-1] <= 64  # and the few ticks in which it was as near before and after
        assert time[-1] == time[100]

    def test_too_short_a_stay_does_not_count_even_when_its_end_is_death(self):
        brief = _circle(1.0).copy()
        brief[WINDOW:] = np.nan
        assert _time(brief)[-1] == 0
        long = _circle(1.0).copy()
        long[WINDOW + 1 :] = np.nan
        np.testing.assert_array_equal(_time(long)[WINDOW:], WINDOW)

    def test_shares_and_times_are_of_all_prey_that_started(self):
        straight = np.stack([TICKS * 0.6, TICKS * 0.8], axis=1)
        trial = _recording(np.stack([_circle(1.0), straight, straight + 1, straight + 2], axis=1), **{"world.dt": 0.5})
        assert recorded.measured(trial, "trapped") == 0.25
        assert recorded.measured(trial, "trapped-time") == 0.25 * 120 * 0.5
        nobody = _recording(straight[:, None])
        assert np.isnan(recorded.measured(nobody, "trapped-milling"))

    def test_a_rotated_and_shifted_path_is_as_trapped(self):
        walk = np.random.default_rng(4).normal(size=(400, 3, 2)).cumsum(axis=0) * 0.4
        turn = np.array([[0.6, -0.8], [0.8, 0.6]])
        one, other = (deadlocks(_recording(path)) for path in (walk, walk @ turn.T + [30, -7]))
        assert (one.time[-1] > 0).any()
        np.testing.assert_array_equal(one.time, other.time)
        np.testing.assert_allclose(one.spin, other.spin, atol=1e-9)

    def test_a_circle_across_a_periodic_edge_is_one(self):
        path = (_circle(1.5) - [50, 0]) % [100, 50]
        edges = {"world.boundary": "periodic", "world.size": [100.0, 50.0]}
        assert np.ptp(path[:, 0]) > 90
        assert _time(path, **edges)[-1] == 120
        assert _time(path)[-1] == 0

    def test_a_deep_world_has_no_left_and_right(self):
        position = np.random.default_rng(1).normal(size=(50, 2, 3)).cumsum(axis=0) * 0.2 + 10
        own = {"world.size": [20, 20, 20], "prey.strategy": "lookout", "target.present": False}
        own |= {"prey.spawn": {"region": [[0, 0, 0], [1, 1, 1]], "velocity": [[0, 0, 0], [1, 1, 1]]}}
        deep = replace(_recording(position, **own))
        with pytest.raises(ValueError, match="flat world"):
            recorded.measured(deep, "trapped-milling")
        assert recorded.measured(deep, "trapped") >= 0
        with pytest.raises(ScenarioError, match="'trapped-milling' needs a flat world"):
            tiswarm.load("lookout/aquarium", {"measures.names": ["trapped-milling"]})


def _agree(scenario: Scenario, trials: int) -> np.ndarray:
    """Hold the kernel's measures of some trials against their recordings; give the shares trapped: [trial]."""
    results = tiswarm.simulate(scenario, trials, seed=3)
    for trial in range(0, trials, 5):
        recording = tiswarm.record(scenario, trial, seed=3)
        for name in scenario.measures.names:
            expected = pytest.approx(results.measures[name][trial], rel=1e-9, abs=1e-9, nan_ok=True)
            assert recorded.measured(recording, name) == expected, f"{name} of trial {trial}"
    return results.measures["trapped"]


class TestKernelAgainstRecording:
    @pytest.mark.usefixtures("f64")
    @pytest.mark.parametrize("avoidance", ["outward", "kitchen-sink"])
    def test_delft_with_thirty_obstacles(self, avoidance):
        own = {"prey.avoidance": avoidance, "measures.names": list(MEASURES), "measures.window": 25, "measures.path": 12.5}
        shares = _agree(tiswarm.load("delft/avoidance-30", own), 61)
        assert 0.05 < shares.mean() < 0.7

    @pytest.mark.usefixtures("f64")
    def test_hunted_prey_over_a_periodic_sky(self):
        own = {"measures.names": list(MEASURES), "measures.window": 10, "measures.within": 6.0, "measures.path": 1.0}
        assert _agree(tiswarm.load("m20/hawk", {**own, "world.contact": "eaten"}), 11).any()

    @pytest.mark.anew
    def test_a_lane_forgets_the_trial_before_and_threads_change_no_bit(self):
        scenario = tiswarm.load("delft/avoidance-30", {"measures.names": list(MEASURES), "prey.avoidance": "spiral"})
        found = []
        for threads in (1, 2):
            tiswarm.init("f32", threads)
            found.append(tiswarm.simulate(scenario, 200, seed=1).measures)
        tiswarm.init("f32")
        alone = tiswarm.simulate(scenario, 3, seed=1).measures
        for name in MEASURES:
            np.testing.assert_array_equal(found[0][name], found[1][name], err_msg=name)
            np.testing.assert_array_equal(found[0][name][:3], alone[name], err_msg=name)

    def test_window_distance_and_path_may_differ_from_trial_to_trial(self, f32):
        scenario = tiswarm.load("delft/avoidance-30", {"measures.names": ["trapped"], "prey.avoidance": "spiral"})
        weights = {"measures.window": np.repeat([20, 60], 100), "measures.within": np.full(200, 3.0)}
        shares = tiswarm.simulate(scenario, 200, seed=1, weights=weights).measures["trapped"]
        own = scenario.replaced({"measures.window": 60, "measures.within": 3.0})
        np.testing.assert_array_equal(shares[100:], tiswarm.simulate(own, 200, seed=1).measures["trapped"][100:])


def test_only_who_asks_has_the_rows_and_the_numbers(f32):
    plain = tiswarm.load("delft/avoidance-30", {"measures.names": ["speed"]})
    asks = plain.replaced({"measures.names": ["speed", "trapped"]})
    without, having = (ParameterTable(Specialisation.of([each], 0), runtime.types().lanes) for each in (plain, asks))
    assert without.agent_rows["prey"] < having.agent_rows["prey"]
    assert set(having.paths) - set(without.paths) == {"measures.window", "measures.within", "measures.path"}
    one, other = (tiswarm.simulate(each, 50) for each in (plain, asks))
    np.testing.assert_array_equal(one.measures["speed"], other.measures["speed"])
    np.testing.assert_array_equal(one.ticks, other.ticks)


def test_the_study_asks_for_what_it_says(f32):
    report = run_study("delft-deadlocks", trials=40)
    by = {(row.cell.point["prey.avoidance"], row.cell.point["obstacles.count"]): row for row in report.rows}
    assert by["none", 30].estimate("trapped").mean == 0
    assert by["spiral", 40].estimate("trapped").mean > by["spiral", 10].estimate("trapped").mean
    assert by["spiral", 30].estimate("trapped").low > by["outward", 30].estimate("trapped").high
