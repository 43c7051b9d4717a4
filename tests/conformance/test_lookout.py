"""What must hold of 3-D flocking with distance perception: turns, random sides, clear flight, distances, rotation."""

import numpy as np
import pytest
from scipy import stats

import tiswarm
from tiswarm.engine.trials.trial import Single

ONE = {"prey.separation": 0, "prey.cohesion": 0, "prey.alignment": 0, "prey.goal": 0}


def _ahead(velocity, centre, trial=0, **overrides):
    """Let one boid at the origin of its path fly towards one sphere for a tick; give its velocity before and behind."""
    keys = {f"prey.weights.{key}": value for key, value in overrides.items()}
    scenario = tiswarm.load("lookout/aquarium", {**ONE, **keys})
    place = np.full((1, 3), 50.0)
    none = np.zeros((0, 3))
    start = tiswarm.Start(place, np.array([velocity], float), none, none, place + np.array([centre], float), np.array([5.0]))
    single = Single(scenario, 0, trial, start)
    single.step()
    return np.array(velocity, float), single.velocity("prey")[0]


def _angle(a, b):
    return np.degrees(np.arccos(np.clip(np.dot(a, b) / np.linalg.norm(a) / np.linalg.norm(b), -1, 1)))


@pytest.mark.parametrize(("alpha", "beta"), [(1.0, 1.0), (1.0, 0.5), (0.5, 1.0), (0.0, 1.0)])
def test_the_rule_keeps_the_speed_and_turns_by_180_degrees_less_atan_beta_over_alpha(alpha, beta, f64):
    for trial in range(20):
        old, new = _ahead([0.3, 0.5, -0.4], [3.0, 5.2, -4.1], trial, deflection="paper", alpha=alpha, beta=beta)
        assert np.linalg.norm(new) == pytest.approx(np.linalg.norm(old), abs=1e-12)
        assert _angle(old, new) == pytest.approx(180 - np.degrees(np.arctan2(beta, alpha)), abs=1e-6)


def test_the_side_is_perpendicular_to_the_course(f64):
    for trial in range(50):
        old, new = _ahead([0.3, 0.5, -0.4], [3.0, 5.2, -4.1], trial, deflection="paper", alpha=0.0)
        assert abs(np.dot(old, new)) < 1e-6


def test_the_side_is_uniform_in_azimuth(f64):
    """Chi-square over 100 000 draws: 1000 boids that each have a sphere ahead, in 100 trials under one seed."""
    count, ahead = 1000, np.array([0.6, 0.48, 0.64])
    place = 100.0 * np.arange(count)[:, None] * np.array([1.0, 0.0, 0.0])
    none = np.zeros((0, 3))
    keys = {**ONE, "prey.weights.deflection": "paper", "prey.weights.alpha": 0.0, "prey.count": count, "world.ticks": 1}
    scenario = tiswarm.load("lookout/aquarium", keys)
    velocity = np.tile(ahead, (count, 1))
    start = tiswarm.Start(place, velocity, none, none, place[:1] * 0 + 5 * ahead, np.array([2e5]))
    one = np.cross(ahead, [0.0, 0.0, 1.0])
    one /= np.linalg.norm(one)
    other = np.cross(ahead, one)
    angles = []
    for trial in range(100):
        single = Single(scenario, 0, trial, start)
        single.step()
        sides = single.velocity("prey")
        angles.append(np.arctan2(sides @ other, sides @ one))
    counts, _ = np.histogram(np.concatenate(angles), bins=36, range=(-np.pi, np.pi))
    assert counts.sum() == 100_000
    assert stats.chisquare(counts).pvalue > 0.001


def test_graded_turns_harder_the_nearer_and_away_from_the_centre(f64):
    turns = []
    for distance in (20.0, 15.0, 10.0, 6.0):
        old, new = _ahead([1.0, 0.0, 0.0], [distance, 0.5, 0.0], deflection="graded")
        turns.append(_angle(old, new))
        assert new[1] < 0
        assert new[2] == pytest.approx(0, abs=1e-12)
    assert (np.diff(turns) > 0).all()
    assert turns[-1] < 90


def test_graded_takes_a_random_side_only_when_it_heads_straight_for_the_centre(f64):
    straight = [_ahead([1.0, 0.0, 0.0], [10.0, 0.0, 0.0], trial)[1] for trial in range(2)]
    assert not np.allclose(straight[0], straight[1])
    aside = [_ahead([1.0, 0.0, 0.0], [10.0, 0.1, 0.0], trial)[1] for trial in range(2)]
    np.testing.assert_array_equal(aside[0], aside[1])


def test_over_200_trials_no_boid_is_ever_inside_a_sphere_and_99_percent_arrive():
    results = tiswarm.simulate(tiswarm.load("lookout/aquarium"), 200)
    assert results.measures["hits"].sum() == 0
    assert results.success.mean() >= 0.99


def test_spheres_keep_off_the_target_and_the_start():
    scenario = tiswarm.load("lookout/aquarium", {"world.ticks": 1, "measures.names": []})
    for trial in range(30):
        path = tiswarm.record(scenario, trial)
        from_target = np.linalg.norm(path.obstacle_position - scenario.target.position, axis=1)
        assert (from_target > path.obstacle_radius + scenario.target.radius).all()
        from_start = np.linalg.norm(path.obstacle_position[:, None] - path.prey.position[0], axis=2)
        assert (from_start > path.obstacle_radius[:, None]).all()
        assert np.linalg.norm(path.prey.position[0] - 20.0, axis=1).max() <= 15.0


@pytest.mark.parametrize("form", ["isotropic", "componentwise"])
@pytest.mark.parametrize("direction", [(1, 0, 0), (1, 1, 0), (1, 1, 1), (0.3, -0.5, 0.8)])
def test_a_pair_settles_at_the_distance_where_cohesion_and_separation_balance(form, direction, f64):
    """Isotropic: √(S/c) = 10 in any direction. By component: 10 on each axis on which they differ, 17.32 along a diagonal."""
    axis = np.array(direction, float)
    line = axis / np.linalg.norm(axis)
    place = np.stack([50 - 4 * line, 50 + 4 * line])
    none = np.zeros((0, 3))
    damped = {"prey.alignment": 0.5, "prey.goal": 0, "prey.cohesion": 0.01, "prey.separation": 1, "world.dt": 0.1}
    keys = {**damped, "prey.weights.separation_form": form, "prey.avoidance": "none", "world.ticks": 4000}
    start = tiswarm.Start(place, np.zeros((2, 3)), none, none, none, np.zeros(0))
    scenario = tiswarm.load("lookout/aquarium", {**keys, "target.present": False})
    path = tiswarm.record(scenario, start=start)
    way = path.prey.position[-1, 1] - path.prey.position[-1, 0]
    expected = 10.0 * line if form == "isotropic" else 10.0 * np.sign(axis)
    np.testing.assert_allclose(way, expected, atol=1e-3)


def test_turning_the_world_turns_the_result(f64):
    rng = np.random.default_rng(2)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    scenario = tiswarm.load("lookout/aquarium", {"prey.count": 20, "world.ticks": 60, "measures.names": []})
    path = tiswarm.record(scenario, 3)
    none = np.zeros((0, 3))
    start = tiswarm.Start(
        path.prey.position[0] @ turn,
        path.prey.velocity[0] @ turn,
        none,
        none,
        path.obstacle_position @ turn,
        path.obstacle_radius,
    )
    target = (np.array(scenario.target.position) @ turn).tolist()
    other = tiswarm.record(scenario.replaced({"target.position": target}), 3, start=start)
    np.testing.assert_allclose(other.prey.position, path.prey.position @ turn, atol=1e-7)


def test_after_a_deflection_a_boid_may_resume_speed_the_further_it_has_to_go(f64):
    old, new = _ahead([0.3, 0.0, 0.0], [10.0, 0.5, 0.0], resume_gain=0.005)
    to_go = np.linalg.norm(np.array([85.0, 85.0, 85.0]) - 50.0)
    assert np.linalg.norm(new) == pytest.approx(np.linalg.norm(old) + 0.005 * to_go)
