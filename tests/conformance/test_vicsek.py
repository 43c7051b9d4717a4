"""What must hold of the particles of Vicsek et al. 1995: the rule of a tick, limits of noise, and order that noise undoes."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.swarms.simulation import Swarm
from tiswarm.engine.trials.trial import Single

SIDE = 10.0
FEW = {
    "prey.count": 400,
    "world.size": [SIDE, SIDE],
    "world.ticks": 400,
    "measures.after": 200,
    "prey.spawn.region": [[0, 0], [SIDE, SIDE]],
}


def _order(noise, trials=4, **changes):
    """Give the order parameter, a trial each, over the second half of the run."""
    keys = {key.replace("__", "."): value for key, value in changes.items()}
    scenario = tiswarm.load("vicsek/flock", FEW | {"prey.weights.noise": noise} | keys)
    return tiswarm.simulate(scenario, trials, seed=6).measures["polarisation"]


def _mean_direction(place, rate, reach=1.0):
    way = place[:, None] - place[None]
    way -= SIDE * np.round(way / SIDE)
    total = (np.linalg.norm(way, axis=2) <= reach) @ rate
    return np.arctan2(total[:, 1], total[:, 0])


@pytest.mark.parametrize("large", [False, True])
def test_a_tick_is_the_mean_direction_turned_by_a_uniform_angle(large, f64):
    noise = 2.0
    scenario = tiswarm.load("vicsek/flock", FEW | {"prey.weights.noise": noise, "measures.names": []})
    trial = Swarm(scenario, 3, 1) if large else Single(scenario, 3, 0)
    angles = []
    for _ in range(20):
        place, rate = (np.squeeze(each("prey")).reshape(-1, 2) for each in (trial.position, trial.velocity))
        trial.step()
        after = np.squeeze(trial.velocity("prey")).reshape(-1, 2)
        moved = np.squeeze(trial.position("prey")).reshape(-1, 2) - place
        np.testing.assert_allclose(moved - SIDE * np.round(moved / SIDE), after, atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(after, axis=1), 0.03, atol=1e-12)
        turned = np.arctan2(after[:, 1], after[:, 0]) - _mean_direction(place, rate)
        angles.append((turned + np.pi) % (2 * np.pi) - np.pi)
    angles = np.concatenate(angles)
    assert np.abs(angles).max() <= noise / 2 + 1e-9
    # Kolmogorov's test of a uniform distribution, at one in a thousand.
    rank = np.sort(angles / noise + 0.5)
    assert np.abs(rank - (np.arange(len(rank)) + 0.5) / len(rank)).max() < 1.95 / np.sqrt(len(rank))


def test_both_ways_of_finding_neighbours_draw_the_same_angles(f64):
    keys = FEW | {"measures.names": []}
    swarm, single = Swarm(tiswarm.load("vicsek/flock", keys), 3, 2), Single(tiswarm.load("vicsek/flock", keys), 3, 1)
    for _ in range(10):
        swarm.step()
        single.step()
    np.testing.assert_allclose(swarm.velocity()[1], single.velocity("prey"), atol=1e-9)


def test_without_noise_neighbours_align(f32):
    assert _order(0.0, prey__max_speed=0.3).min() > 0.99


def test_where_all_see_all_the_order_is_that_of_one_mean_and_uniform_angles(f32):
    for noise in (1.0, 3.0, 5.0):
        expected = np.sin(noise / 2) / (noise / 2)
        assert _order(noise, prey__perception=8.0).mean() == pytest.approx(expected, abs=0.01)


def test_angles_all_around_leave_the_order_of_random_directions(f32):
    assert _order(2 * np.pi, trials=16).mean() == pytest.approx(np.sqrt(np.pi / 400) / 2, rel=0.03)


def test_order_falls_with_noise_and_with_numbers_beyond_the_transition(f32):
    orders = [_order(noise).mean() for noise in (0.5, 2.0, 3.5, 5.0)]
    assert (np.diff(orders) < -0.05).all()
    few = {"prey__count": 40, "world__size": [10**0.5, 10**0.5], "prey__spawn__region": [[0, 0], [3.16, 3.16]]}
    assert _order(5.0, trials=16, **few).mean() > 1.5 * orders[-1]
