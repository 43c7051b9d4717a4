"""What must hold of the cleaning robots: the theorems of potential-field flocking, walls, wheels and coverage."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.trials.trial import Single

LOWEST = {4: 6.292365, 5: 11.104647, 6: 16.965213, 7: 24.331690}


def _none(dim=2):
    return np.zeros((0, dim))


def _start(place, velocity):
    none = _none(np.shape(place)[1])
    return tiswarm.Start(np.array(place, float), np.array(velocity, float), none, none, none, np.zeros(0))


def _potential(place):
    """Σ over pairs of 1/r² + ln r²."""
    away = place[..., :, None, :] - place[..., None, :, :]
    upper = np.triu_indices(place.shape[-2], 1)
    ratio = (away**2).sum(axis=-1)[..., upper[0], upper[1]]
    return (1 / ratio + np.log(ratio)).sum(axis=-1)


def _spread(count, dim=2, seed=0, apart=0.6):
    """Draw places and velocities at random, nobody too near another."""
    rng = np.random.default_rng(seed)
    while True:
        place = rng.uniform(0, 2.0, (count, dim))
        away = np.linalg.norm(place[:, None] - place[None], axis=2) + 9 * np.eye(count)
        if away.min() > apart:
            return place, rng.uniform(-0.3, 0.3, (count, dim))


def _single(count, law, dt, seed=0):
    """Start a long run under the Verlet scheme."""
    keys = {"prey.weights.law": law, "world.ticks": 100_000, "world.dt": dt, "measures.names": []}
    scenario = tiswarm.load("sanitation/potential", {**keys, "prey.max_speed": 1000.0, "world.scheme": "verlet"})
    return Single(scenario, 0, 0, _start(*_spread(count, seed=seed)))


def _energy(single):
    return 0.5 * (single.velocity("prey") ** 2).sum() + _potential(single.position("prey"))


def _settled(count, dim=2):
    """Give where robots are after 80 s of the theorem's law."""
    keys = {"prey.weights.law": "velocity", "world.ticks": 100_000, "measures.names": []}
    keys |= {"world.size": [8] * dim, "prey.spawn.region": [[2] * dim, [6] * dim], "prey.spawn.velocity": [[0] * dim] * 2}
    single = Single(tiswarm.load("sanitation/potential", keys), 0, 0, _start(*_spread(count, dim)))
    single.step(8000)
    return single.position("prey")


class TestVelocityLaw:
    def test_two_settle_at_distance_1_and_three_in_a_triangle(self, f64):
        for count in (2, 3):
            place = _settled(count)
            away = np.linalg.norm(place[:, None] - place[None], axis=2)[np.triu_indices(count, 1)]
            np.testing.assert_allclose(away, 1.0, atol=1e-4)

    def test_four_in_space_settle_in_a_tetrahedron_of_side_1(self, f64):
        place = _settled(4, dim=3)
        away = np.linalg.norm(place[:, None] - place[None], axis=2)[np.triu_indices(4, 1)]
        np.testing.assert_allclose(away, 1.0, atol=1e-4)

    @pytest.mark.parametrize("count", [4, 5, 6, 7])
    def test_at_an_equilibrium_the_mean_of_1_over_r2_is_1(self, count, f64):
        place = _settled(count)
        away = (place[:, None] - place[None])[np.triu_indices(count, 1)]
        assert (1 / (away**2).sum(axis=1)).mean() == pytest.approx(1.0, abs=1e-4)

    @pytest.mark.parametrize("count", [4, 5, 6, 7])
    def test_the_lowest_energy_over_many_starts_is_the_known_one(self, count, f64):
        keys = {"prey.weights.law": "velocity", "prey.count": count, "world.ticks": 4000, "measures.after": 4000}
        energies = tiswarm.simulate(tiswarm.load("sanitation/potential", keys), 200).measures["potential"]
        assert energies.min() == pytest.approx(LOWEST[count], abs=1e-5)

    def test_four_settle_in_a_square(self, f64):
        keys = {"prey.weights.law": "velocity", "prey.count": 4, "world.ticks": 4000, "measures.after": 4000}
        scenario = tiswarm.load("sanitation/potential", keys)
        best = int(np.argmin(tiswarm.simulate(scenario, 40).measures["potential"]))
        place = tiswarm.record(scenario, best).prey.position[-1]
        away = np.sort(np.linalg.norm(place[:, None] - place[None], axis=2)[np.triu_indices(4, 1)])
        np.testing.assert_allclose(away, [0.9129] * 4 + [1.2910] * 2, atol=1e-4)

    @pytest.mark.parametrize("seed", range(5))
    def test_energy_never_rises_momentum_stays_and_nobody_meets(self, seed, f64):
        keys = {"prey.weights.law": "velocity", "world.dt": 0.002, "measures.names": []}
        path = tiswarm.record(tiswarm.load("sanitation/potential", keys), start=_start(*_spread(6, seed=seed)))
        velocity, place = path.prey.velocity, path.prey.position
        # W = ½ Σ (V_i + |v_i|²), V_i the sum over the others, is the kinetic energy and each pair's potential once
        energy = 0.5 * (velocity**2).sum(axis=(1, 2)) + _potential(place)
        assert np.diff(energy).max() < 1e-12
        np.testing.assert_allclose(velocity.mean(axis=1), np.broadcast_to(velocity[0].mean(axis=0), (5001, 2)), atol=1e-12)
        away = np.linalg.norm(place[:, :, None] - place[:, None], axis=3) + 9 * np.eye(6)
        assert away.min() > 0.1

    def test_velocities_converge(self, f64):
        keys = {"prey.weights.law": "velocity", "world.ticks": 100_000, "measures.names": []}
        for seed in range(3):
            single = Single(tiswarm.load("sanitation/potential", keys), 0, 0, _start(*_spread(6, seed=seed)))
            single.step(20_000)
            velocity = single.velocity("prey")
            np.testing.assert_allclose(velocity, np.broadcast_to(velocity.mean(axis=0), (6, 2)), atol=1e-6)


class TestHeadingLaw:
    PATHS = 3

    @pytest.mark.parametrize("seed", range(PATHS))
    def test_energy_is_conserved_as_the_heading_term_does_no_work(self, seed, f64):
        """30 s at steps of 0.5 ms, with the Verlet scheme: drift below 1e-4."""
        single = _single(5, "heading", 5e-4, seed)
        energies = [_energy(single)]
        for _ in range(600):
            single.step(100)
            energies.append(_energy(single))
        assert np.abs(np.array(energies) - energies[0]).max() < 1e-4

    def test_gradient_alone_conserves_energy(self, f64):
        single = _single(5, "gradient", 5e-4)
        start = _energy(single)
        for _ in range(200):
            single.step(100)
            assert abs(_energy(single) - start) < 1e-4

    def test_headings_converge_and_the_common_speed_follows_from_the_energies(self, f64):
        single = _single(5, "heading", 5e-3)
        start = _energy(single)
        single.step(40_000)
        velocity = single.velocity("prey")
        ahead = velocity / np.linalg.norm(velocity, axis=1, keepdims=True)
        assert np.linalg.norm(ahead.mean(axis=0)) > 0.9999
        expected = np.sqrt(2 * (start - _potential(single.position("prey"))) / 5)
        np.testing.assert_allclose(np.sqrt((velocity**2).sum(axis=1).mean()), expected, rtol=1e-3)

    def test_a_robot_at_rest_keeps_its_heading(self, f64):
        scenario = tiswarm.load("sanitation/potential", {"measures.names": []})
        single = Single(scenario, 0, 0, _start([[4.0, 4.0]], [[0.0, 0.2]]))
        single.step()
        single.place("prey", np.array([[4.0, 4.0]]), np.zeros((1, 2)))
        single.step()
        assert single.memory("prey")["potential"]["theta"][0] == pytest.approx(np.pi / 2)


def test_beyond_the_radius_of_sight_there_is_no_force(f64):
    keys = {"prey.perception": 1.5, "measures.names": []}
    single = Single(tiswarm.load("sanitation/potential", keys), 0, 0, _start([[2.0, 2.0], [4.0, 2.0]], np.zeros((2, 2))))
    single.step()
    np.testing.assert_array_equal(single.velocity("prey"), np.zeros((2, 2)))


class TestWallsAndWheels:
    def test_boids_stay_within_the_walls(self):
        path = tiswarm.record(tiswarm.load("sanitation/boids", {"world.ticks": 600, "measures.names": []}))
        assert path.prey.position.min() >= 2
        assert (path.prey.position <= np.array([640, 480]) - 2).all()
        speed = np.linalg.norm(path.prey.velocity[1:], axis=2)
        assert speed.max() <= 6 * (1 + 1e-6)

    def test_inside_the_margin_each_tick_turns_by_the_factor(self, f64):
        still = {f"prey.{name}": 0 for name in ("cohesion", "alignment", "separation", "min_speed")}
        scenario = tiswarm.load("sanitation/boids", {**still, "measures.names": []})
        single = Single(scenario, 0, 0, _start([[20.0, 240.0], [630.0, 470.0], [320.0, 240.0]], [[1.0, 0.0]] * 3))
        single.step()
        np.testing.assert_allclose(single.velocity("prey"), [[1.2, 0.0], [0.8, -0.2], [1.0, 0.0]], atol=1e-14)

    @pytest.mark.parametrize(("power", "push"), [(1, 0.05), (2, 0.05 / 4)])
    def test_separation_is_the_mean_of_directions_over_a_power_of_the_distance(self, power, push, f64):
        still = {"prey.cohesion": 0, "prey.alignment": 0, "prey.min_speed": 0, "prey.weights.separation_power": power}
        scenario = tiswarm.load("sanitation/boids", {**still, "measures.names": []})
        single = Single(scenario, 0, 0, _start([[320.0, 240.0], [324.0, 240.0]], np.zeros((2, 2))))
        single.step()
        np.testing.assert_allclose(single.velocity("prey"), [[-push, 0], [push, 0]], atol=1e-12)

    def test_a_unicycle_drives_by_the_point_ahead_of_its_axle(self, f64):
        """[speed, turn rate] = diag(1, 1/0.05) R(-θ) u, both capped; the turn takes effect on the next tick."""
        still = {f"prey.{name}": 0 for name in ("cohesion", "alignment", "separation", "min_speed")}
        scenario = tiswarm.load("sanitation/arena", {**still, "world.turn_factor": 0.1, "measures.names": []})
        single = Single(scenario, 0, 0, _start([[1.6, 0.1]], [[0.15, 0.0]]))
        single.step()  # the wall below asks for 0.1 m/s to the left of the heading, a turn of 2 rad/s
        np.testing.assert_allclose(single.velocity("prey"), [[0.15, 0.0]], atol=1e-12)
        single.step()
        angle = 0.033 * 0.1 / 0.05
        ahead = np.array([np.cos(angle), np.sin(angle)])
        speed = min(np.dot([0.15, 0.1], ahead), 0.2)
        np.testing.assert_allclose(single.velocity("prey"), [speed * ahead], atol=1e-12)

    def test_robots_keep_to_their_limits(self):
        path = tiswarm.record(tiswarm.load("sanitation/arena", {"world.ticks": 500, "measures.names": []}))
        speed = np.linalg.norm(path.prey.velocity[1:], axis=2)
        assert speed.max() <= 0.2 * (1 + 1e-6)
        place = path.prey.position[1:]
        free = ((place > 0.06) & (place < np.array([3.2, 2.0]) - 0.06)).all(axis=2) & (speed > 1e-6)  # a wall stops a robot
        ahead = path.prey.velocity[1:] / np.maximum(speed, 1e-6)[..., None]
        along = (ahead[1:] * ahead[:-1]).sum(axis=2)
        forward = (along > 0) & free[1:] & free[:-1]  # a robot that backs has its velocity against its heading
        assert np.arccos(np.clip(along[forward], -1, 1)).max() <= 3.636 * 0.033 * (1 + 1e-2)


def test_a_single_robot_on_a_straight_line_covers_its_stadium(f64):
    still = {f"prey.{name}": 0 for name in ("cohesion", "alignment", "separation", "min_speed")}
    keys = {**still, "world.turn_factor": 0, "prey.drive": "point", "prey.count": 1, "world.ticks": 200, "coverage.cell": 0.01}
    region = {"prey.spawn.region": [[1.0, 1.0], [1.0, 1.0]], "prey.spawn.velocity": [[0.15, 0.05], [0.15, 0.05]]}
    shares = []
    for ticks in range(20, 201, 20):
        scenario = tiswarm.load("sanitation/arena", {**keys, **region, "world.ticks": ticks, "measures.names": ["coverage"]})
        shares.append(tiswarm.simulate(scenario, 1).measures["coverage"][0])
        length = ticks * 0.033 * np.hypot(0.15, 0.05)
        area = np.pi * 0.08**2 + 2 * 0.08 * length
        assert shares[-1] == pytest.approx(area / (3.2 * 2.0), rel=0.02)
    assert (np.diff(shares) >= 0).all()
