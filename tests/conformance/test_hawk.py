"""What must hold of the swallows and the hawk of Rivera 2017: equilibria, caps, edges, and the claims of its section 1.4."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.trials.trial import Single

MAX_SPEED = 3.0
LENGTH = 15.0


def _two(apart, velocity=((0.5, 0.2), (0.3, 0.4)), **overrides):
    """Start two swallows at this distance in the sky of part a, and no hawk."""
    place = np.array([[3.0 - apart / 2, 3.0], [3.0 + apart / 2, 3.0]])
    keys = {key.replace("__", "."): value for key, value in overrides.items()}
    scenario = tiswarm.load("m20/two-swallows", keys)
    none = np.zeros((0, 2))
    return tiswarm.record(scenario, start=tiswarm.Start(place, np.array(velocity), none, none, none, np.zeros(0)))


def _distance(path):
    way = path.prey.position[:, 0] - path.prey.position[:, 1]
    way -= 6.0 * np.round(way / 6.0)
    return np.linalg.norm(way, axis=1)


POWER = {"prey__weights__urgency": "power", "prey__weights__max_acceleration": 10.0, "world__dt": 0.02, "world__ticks": 2000}


@pytest.mark.parametrize(("c1", "c3", "distance"), [(1.3, 1.3, 1.0), (1.3, 2.0, 1.5385), (0.9, 1.4, 1.5556)])
def test_under_power_two_swallows_settle_at_the_distance_c3_over_c1(c1, c3, distance, f64):
    path = _two(1.2, prey__cohesion=c1, prey__separation=c3, **POWER)
    assert _distance(path)[-1] == pytest.approx(distance, abs=1e-3)
    velocity = path.prey.velocity[-1]
    np.testing.assert_allclose(velocity[0], velocity[1], atol=1e-3)
    assert np.linalg.norm(velocity[0]) == pytest.approx(1.4 * MAX_SPEED / (c1 + 1.4), abs=1e-3)


def test_normalised_with_equal_gains_the_swallows_fly_alike_at_the_speed_of_all_three_rules(f64):
    path = _two(2.0)
    velocity = path.prey.velocity[-1]
    np.testing.assert_allclose(velocity[0], velocity[1], atol=1e-3)
    np.testing.assert_allclose(np.linalg.norm(velocity, axis=1), 1.05, atol=1e-3)


def test_normalised_with_strong_separation_the_distance_chatters_about_the_horizon(f64):
    path = _two(2.0, prey__separation=2.0, world__ticks=600)
    assert 2.45 <= _distance(path)[200:].mean() <= 2.55


def test_normalised_with_strong_cohesion_the_swallows_collapse(f64):
    path = _two(2.0, prey__cohesion=2.0, world__ticks=600)
    assert _distance(path)[-1] < 0.2


@pytest.mark.parametrize("urgency", ["normalised", "power"])
@pytest.mark.parametrize("pursuit", ["cycle", "nearest"])
def test_caps_hold_and_positions_stay_in_the_sky(urgency, pursuit, f64):
    keys = {"prey.weights.urgency": urgency, "predators.weights.pursuit": pursuit, "prey.weights.max_acceleration": 1.0}
    for trial in range(5):
        path = tiswarm.record(tiswarm.load("m20/hawk", keys), trial)
        for swarm in (path.prey, path.predators):
            assert np.linalg.norm(swarm.velocity, axis=2).max() <= MAX_SPEED * (1 + 1e-12)
            assert swarm.position.min() >= 0
            assert swarm.position.max() < LENGTH
        assert np.linalg.norm(np.diff(path.prey.velocity, axis=0), axis=2).max() <= 1.0 * 0.1 * (1 + 1e-9)


def test_coincident_birds_stay_finite(precision):
    place = np.full((4, 2), 7.5)
    start = tiswarm.Start(place, np.zeros((4, 2)), place[:1], np.zeros((1, 2)), np.zeros((0, 2)), np.zeros(0))
    path = tiswarm.record(tiswarm.load("m20/hawk"), start=start)
    assert np.isfinite(path.prey.position).all()
    assert np.isfinite(path.predators.velocity).all()


@pytest.mark.parametrize("urgency", ["normalised", "power"])
def test_a_swallow_at_rest_flees(urgency, f64):
    place, hawk = np.array([[9.0, 8.0]]), np.array([[7.5, 7.5]])
    start = tiswarm.Start(place, np.zeros((1, 2)), hawk, np.zeros((1, 2)), np.zeros((0, 2)), np.zeros(0))
    single = Single(tiswarm.load("m20/hawk", {"prey.weights.urgency": urgency}), 0, 0, start)
    single.step()
    assert np.dot(single.velocity("prey")[0], (place - hawk)[0]) > 0


@pytest.mark.parametrize("pursuit", ["cycle", "nearest"])
@pytest.mark.parametrize("wrap_sight", [True, False])
def test_the_same_sky_turned_by_a_right_angle_gives_the_same_flight_turned(pursuit, wrap_sight, f64):
    keys = {"predators.weights.pursuit": pursuit, "world.wrap_sight": wrap_sight, "world.ticks": 60}
    scenario = tiswarm.load("m20/hawk", keys)
    path = tiswarm.record(scenario, 1)

    def turned(position):
        return np.stack([LENGTH - position[..., 1], position[..., 0]], axis=-1) % LENGTH

    def turned_velocity(velocity):
        return np.stack([-velocity[..., 1], velocity[..., 0]], axis=-1)

    none = np.zeros((0, 2))
    kinds = (path.prey, path.predators)
    states = [f(a) for each in kinds for f, a in ((turned, each.position[0]), (turned_velocity, each.velocity[0]))]
    other = tiswarm.record(scenario, start=tiswarm.Start(*states, none, np.zeros(0)))
    off = (other.prey.position - turned(path.prey.position) + LENGTH / 2) % LENGTH - LENGTH / 2
    assert np.abs(off).max() < 1e-8


class TestClaimsOfSection14:
    """Means over 100 seeds and the second half of 400 ticks, of what section 1.4 says in words."""

    @staticmethod
    def _measured(hawk=False, **gains):
        keys = {f"prey.{key}": value for key, value in gains.items()}
        keys |= {"world.ticks": 400, "measures.after": 200, "predators.count": int(hawk)}
        keys["measures.names"] = ["polarisation", "speed", "nearest"]
        return {name: values.mean() for name, values in tiswarm.simulate(tiswarm.load("m20/hawk", keys), 100).measures.items()}

    def test_high_cohesion_with_low_alignment_gives_a_slow_clump(self):
        clump = self._measured(cohesion=2.0, alignment=0.2, separation=0.3)
        flock = self._measured(cohesion=2.0, alignment=1.8, separation=0.3)
        assert clump["speed"] < 0.5 * flock["speed"]
        assert clump["nearest"] < 0.5

    def test_alignment_near_cohesion_gives_a_tight_fast_flock(self):
        flock = self._measured(cohesion=2.0, alignment=1.8, separation=0.3)
        assert flock["polarisation"] > 0.9
        assert flock["speed"] > 1.0
        assert flock["nearest"] < 0.5

    def test_high_separation_gives_a_loose_cloud(self):
        cloud = self._measured(cohesion=0.5, alignment=0.5, separation=2.0)
        flock = self._measured(cohesion=2.0, alignment=1.8, separation=0.3)
        assert cloud["nearest"] > 3 * flock["nearest"]
        assert cloud["polarisation"] < flock["polarisation"]

    def test_strong_fear_disperses_and_drives_away_from_the_hawk(self):
        calm = self._measured(hawk=True, cohesion=1.3, **{"weights.fear": 0.0})
        afraid = self._measured(hawk=True, cohesion=1.3, **{"weights.fear": 8.0})
        assert afraid["nearest"] > calm["nearest"]
        away = []
        for seed in range(20):
            path = tiswarm.record(tiswarm.load("m20/hawk", {"prey.weights.fear": 8.0}), seed)
            way = path.prey.position[50:] - path.predators.position[50:]
            way -= LENGTH * np.round(way / LENGTH)
            away.append((way * path.prey.velocity[50:]).sum(axis=2).mean())
        assert np.mean(away) > 0


def test_with_wrapped_sight_distances_are_the_least_over_the_nine_images(f64):
    """Two swallows see each other exactly when that distance is within their horizon."""
    rng = np.random.default_rng(3)
    scenario = tiswarm.load("m20/two-swallows", {"measures.names": ["nearest"], "world.ticks": 1, "prey.separation": 0})
    shifts = 6.0 * np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1)])
    none = np.zeros((0, 2))
    for horizon in (1.0, 2.0, 2.9):
        for _ in range(10):
            place = rng.uniform(0, 6, (2, 2))
            least = np.linalg.norm(place[0] - place[1] + shifts, axis=1).min()
            start = tiswarm.Start(place, np.zeros((2, 2)), none, none, none, np.zeros(0))
            path = tiswarm.record(scenario.replaced({"prey.perception": horizon}), start=start)
            moved = np.linalg.norm(path.prey.velocity[1]) > 0
            assert moved == (least <= horizon)


def _pair(place, velocity, contact, hawk=(), radius=0.5):
    keys = {"world.contact": contact, "prey.radius": radius, "prey.cohesion": 0, "prey.alignment": 0, "prey.separation": 0}
    scenario = tiswarm.load("m20/hawk", {**keys, "prey.weights.fear": 0})
    hawk = np.array(hawk, float).reshape(-1, 2)
    start = tiswarm.Start(
        np.array(place, float), np.array(velocity, float), hawk, np.zeros_like(hawk), np.zeros((0, 2)), np.zeros(0)
    )
    return Single(scenario, 0, 0, start)


def test_a_bounce_exchanges_velocities_along_the_line_of_centres(f64):
    single = _pair([[7.0, 7.0], [8.1, 7.0]], [[1.0, 0.5], [-1.0, 0.5]], "bounce")
    single.step()
    np.testing.assert_allclose(single.velocity("prey"), [[-1.0, 0.5], [1.0, 0.5]], atol=1e-12)


def test_bounces_conserve_momentum_and_energy_across_the_edge_too(f64):
    rng = np.random.default_rng(5)
    place, velocity = rng.uniform(0, 4, (30, 2)) % LENGTH - 2, rng.normal(0, 1, (30, 2))
    single = _pair(place % LENGTH, velocity, "bounce")
    for _ in range(100):
        before = single.velocity("prey")
        single.step()
        after = single.velocity("prey")
        np.testing.assert_allclose(after.sum(axis=0), before.sum(axis=0), atol=1e-12)
        assert (after**2).sum() == pytest.approx((before**2).sum(), rel=1e-12)
    assert not np.allclose(single.velocity("prey"), velocity)


@pytest.mark.parametrize(("contact", "fates"), [("none", "alive"), ("bounce", "alive"), ("eaten", "captured")])
def test_what_a_touch_of_the_hawk_does(contact, fates, f64):
    single = _pair([[7.0, 7.0], [12.0, 12.0]], np.zeros((2, 2)), contact, hawk=[[7.2, 7.0]])
    single.step()
    assert list(single.fate("prey")) == [fates, "alive"]
    assert list(single.fate("predators")) == ["alive"]


def test_cycle_takes_another_swallow_each_tick_and_nearest_the_nearest(f64):
    place = [[2.0, 7.5], [7.5, 12.0], [9.0, 7.5]]
    for pursuit, first, second in (("cycle", [-1, 0], [0, 1]), ("nearest", [1, 0], [1, 0])):
        single = _pair(place, np.zeros((3, 2)), "none", hawk=[[7.5, 7.5]])
        single = Single(
            single.scenario.replaced({"predators.weights.pursuit": pursuit, "predators.max_speed": 0.001}),
            0,
            0,
            tiswarm.Start(
                np.array(place), np.zeros((3, 2)), np.array([[7.5, 7.5]]), np.zeros((1, 2)), np.zeros((0, 2)), np.zeros(0)
            ),
        )
        for expected in (first, second):
            single.step()
            np.testing.assert_allclose(single.velocity("predators")[0], 0.001 * np.array(expected), atol=1e-6)
