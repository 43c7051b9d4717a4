"""What must hold of the zones of Couzin et al. 2002: the rule of a tick, what is hidden and felt, and the four phases."""

import numpy as np
import pytest

import tiswarm

STEADY = {"world.ticks": 1, "prey.weights.error": 0.0, "measures.names": []}
TURN = 0.698 * 0.1  # what an agent may turn in a tick [rad]


def _after(places, velocities, **changes):
    """Give the directions after a tick from these places and velocities."""
    keys = {key.replace("__", "."): value for key, value in changes.items()}
    none = np.zeros((0, 3))
    start = tiswarm.Start(np.array(places, float), np.array(velocities, float), none, none, none, np.zeros(0))
    path = tiswarm.record(tiswarm.load("couzin/torus", STEADY | keys), start=start)
    velocity = path.prey.velocity[1]
    np.testing.assert_allclose(np.linalg.norm(velocity, axis=1), 3.0, atol=1e-12)
    np.testing.assert_allclose(path.prey.position[1], path.prey.position[0] + 0.1 * velocity, atol=1e-12)
    return velocity / 3.0


def _angle(one, other):
    return np.arccos(np.clip(np.dot(one, other) / np.linalg.norm(one) / np.linalg.norm(other), -1, 1))


X, Y = [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]


def test_a_turn_is_no_faster_than_the_rate_and_leads_towards_the_aim(f64):
    drawn = _after([[0, 0, 0], [0, 10, 0]], [X, Y])[0]  # attracted to the left
    assert _angle(drawn, X) == pytest.approx(TURN)
    assert _angle(drawn, Y) == pytest.approx(np.pi / 2 - TURN)
    free = _after([[0, 0, 0], [0, 10, 0]], [X, Y], prey__weights__turn_rate=100.0)[0]
    np.testing.assert_allclose(free, [0, 1, 0], atol=1e-12)


FREE = {"prey__weights__turn_rate": 100.0}


@pytest.mark.parametrize(
    ("distance", "expected"),
    [(0.9, [-1, 0, 0]), (2.0, [0, 1, 0]), (3.4, [0, 1, 0]), (3.6, [1, 0, 0]), (17.4, [1, 0, 0]), (17.6, [0, 0, 1])],
)
def test_each_zone_has_its_own_answer(distance, expected, f64):
    mine = _after([[0, 0, 0], [distance, 0, 0]], [[0, 0, 3], Y], **FREE)[0]
    np.testing.assert_allclose(mine, expected, atol=1e-12)


def test_repulsion_overrules_the_other_zones(f64):
    mine = _after([[0, 0, 0], [0.5, 0, 0], [0, 2, 0], [0, 10, 0]], [X, Y, Y, Y], **FREE)[0]
    np.testing.assert_allclose(mine, [-1, 0, 0], atol=1e-12)


def test_orientation_and_attraction_weigh_alike_by_mate(f64):
    mine = _after([[0, 0, 0], [2, 0, 0], [0, 0, 10]], [X, Y, Y], **FREE)[0]
    np.testing.assert_allclose(mine, [0, 0.5**0.5, 0.5**0.5], atol=1e-12)


def test_mates_behind_are_hidden_and_those_too_near_are_felt(f64):
    hidden = _after([[0, 0, 0], [-10, 1, 0]], [X, Y], **FREE)[0]
    np.testing.assert_allclose(hidden, [1, 0, 0], atol=1e-12)
    seen = _after([[0, 0, 0], [-10, 1, 0]], [X, Y], prey__field_of_view=360.0, **FREE)[0]
    assert seen[0] < -0.9
    felt = _after([[0, 0, 0], [0, -0.5, 0], [-0.5, 0, 0]], [X, Y, Y], **FREE)[0]
    np.testing.assert_allclose(felt, [0.5**0.5, 0.5**0.5, 0], atol=1e-12)


def test_the_error_is_a_gaussian_in_both_ways_across(f64):
    keys = {"prey.weights.error": 0.3, "prey.weights.turn_rate": 100.0, "prey.count": 2000, "prey.perception": 0.0}
    keys |= {"prey.spacing": 0.0, "prey.weights.orientation": 0.0, "world.neighbours": "grid"}
    path = tiswarm.record(tiswarm.load("couzin/torus", STEADY | keys), seed=3)
    before, after = (each / np.linalg.norm(each, axis=1)[:, None] for each in path.prey.velocity)
    angle = np.arccos(np.clip((before * after).sum(axis=1), -1, 1))
    # Sizes of such errors are Rayleigh's; Kolmogorov's test of them at one in a thousand.
    rank = np.sort(1 - np.exp(-0.5 * (angle / 0.3) ** 2))
    assert np.abs(rank - (np.arange(2000) + 0.5) / 2000).max() < 1.95 / np.sqrt(2000)
    assert np.abs((after - before * np.cos(angle)[:, None]).mean(axis=0)).max() < 0.03


LATE = {"world.ticks": 3000, "measures.after": 2000, "measures.names": ["polarisation", "milling", "nearest", "groups"]}


@pytest.fixture(scope="module")
def phases():
    tiswarm.init("f32")
    names = ("swarm", "torus", "dynamic", "parallel")
    return {name: tiswarm.simulate(tiswarm.load(f"couzin/{name}", LATE), 16, seed=2).measures for name in names}


def test_the_four_phases_are_told_apart_by_polarisation_and_milling(phases):
    order = {name: (each["polarisation"].mean(), each["milling"].mean()) for name, each in phases.items()}
    assert order["swarm"][0] < 0.3
    assert order["swarm"][1] < 0.35
    assert order["torus"][0] < 0.35
    assert order["torus"][1] > 0.65
    for name in ("dynamic", "parallel"):
        assert order[name][0] > 0.99
        assert order[name][1] < 0.15
    off = {name: 1 - phases[name]["polarisation"] for name in ("dynamic", "parallel")}
    assert off["dynamic"].min() > 1.2 * off["parallel"].max()


def test_a_dynamic_group_touches_its_zone_of_repulsion_and_a_highly_parallel_one_does_not(phases):
    assert phases["dynamic"]["nearest"].max() < 1.2
    assert phases["parallel"]["nearest"].min() > 1.4


def test_no_group_of_the_presets_falls_apart(phases):
    for each in phases.values():
        np.testing.assert_array_equal(each["groups"], 1)


def test_a_group_keeps_the_phase_that_it_comes_from(f32):
    """Collective memory: under the numbers of the torus, who starts in parallel stays so, and changes places."""
    scenario = tiswarm.load("couzin/torus", {"measures.names": [], "world.ticks": 3000})
    place = np.random.default_rng(4).uniform(25, 35, (100, 3))
    none = np.zeros((0, 3))
    start = tiswarm.Start(place, np.tile([3.0, 0.0, 0.0], (100, 1)), none, none, none, np.zeros(0))
    path = tiswarm.record(scenario, seed=4, start=start)
    order = np.linalg.norm(path.prey.velocity[2000:].mean(axis=1), axis=1) / 3
    assert 0.85 < order.mean() < 0.97
