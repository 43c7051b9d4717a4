"""Springs with dampers: the textbook's oscillator, momentum, the lattice, links that are kept, and the program's own form."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.trials.trial import Single

NONE = np.zeros((0, 2))
FREE = {  # nothing but springs, in steps that are short beside any period
    "world.dt": 0.01,
    "world.scheme": "verlet",
    "world.areas": [],
    "world.ticks": 1_000_000,
    "target.present": False,
    "obstacles.count": 0,
    "prey.avoidance": "none",
    "prey.max_speed": 1000,
    "prey.weights.freeze": 0,
}
K, M, L = 1.0, 10.0, 8.0  # the preset's numbers
ANGULAR = np.sqrt(2 * K / M)


def _springs(places, rates=None, **changes):
    """Begin a trial of springs. changes: weights."""
    places = np.asarray(places, float)
    rates = np.zeros_like(places) if rates is None else np.asarray(rates, float)
    weights = {f"prey.weights.{key}": value for key, value in changes.items()}
    scenario = tiswarm.load("delft/damper", FREE | {"prey.count": len(places)} | weights)
    return Single(scenario, 0, 0, tiswarm.Start(places, rates, NONE, NONE, NONE, np.zeros(0)))


def _lengths(single, ticks, every):
    """Give how long the link of two agents is: [time], the start first."""
    lengths = []
    for _ in range(0, ticks + 1, every):
        place = single.position("prey")
        lengths.append(np.linalg.norm(place[0] - place[1]))
        single.step(every)
    return np.array(lengths)


def test_two_masses_with_a_damper_oscillate_and_decay_as_the_textbook_says(f64):
    for damping in (0.2, 1.0, 2.0):
        time = 0.05 * np.arange(1201)
        found = _lengths(_springs([[0, 0], [L + 1, 0]], damping=damping), 6000, 5) - L
        ratio = damping / np.sqrt(2 * K * M)
        slower = ANGULAR * np.sqrt(1 - ratio**2)
        decay = np.exp(-ratio * ANGULAR * time)
        expected = decay * (np.cos(slower * time) + ratio * ANGULAR / slower * np.sin(slower * time))
        assert np.abs(found - expected).max() < 0.002
        crossings = time[1:][np.diff(np.sign(found)) != 0][:4]
        if damping < 1:
            assert np.diff(crossings).mean() == pytest.approx(np.pi / slower, rel=0.01)


def test_without_damping_energy_is_constant_as_well_as_the_scheme_can(f64):
    """Over 1000 s it does not drift; within a period it swings by (ω dt)²/4 of itself, 5e-6, which is Verlet's own."""
    single, energies = _springs([[0, 0], [L + 0.5, 0]], damping=0.0), []
    for _ in range(4000):
        single.step(25)
        place, rate = single.position("prey"), single.velocity("prey")
        length = np.linalg.norm(place[0] - place[1])
        energies.append(0.5 * K * (length - L) ** 2 + 0.5 * M * (rate**2).sum())
    energies, first = np.array(energies), 0.5 * K * 0.25
    assert np.abs(energies - first).max() < 1e-6  # J
    assert np.ptp(energies) / first == pytest.approx((ANGULAR * 0.01) ** 2 / 4, rel=0.1)
    assert energies[:2000].mean() == pytest.approx(energies[2000:].mean(), rel=1e-7)


@pytest.mark.parametrize("damping", [0.0, 2.0])
def test_springs_keep_the_momentum(f64, damping):
    random = np.random.default_rng(4)
    single = _springs(random.uniform(0, 25, (12, 2)), random.normal(0, 0.3, (12, 2)), damping=damping)
    before = single.velocity("prey").sum(axis=0)
    single.step(2000)
    np.testing.assert_allclose(single.velocity("prey").sum(axis=0), before, atol=1e-11)


def test_agents_in_the_plane_settle_to_a_lattice_of_the_length_at_rest(f64):
    random = np.random.default_rng(2)
    rows, columns = np.meshgrid(np.arange(4), np.arange(5), indexing="ij")
    lattice = L * np.stack([columns + 0.5 * (rows % 2), np.sqrt(0.75) * rows], axis=-1).reshape(-1, 2)
    single = _springs(lattice + random.uniform(-0.6, 0.6, lattice.shape), damping=2.0)
    single.step(40_000)
    place = single.position("prey")
    apart = np.linalg.norm(place[:, None] - place, axis=2)
    linked = apart[(apart > 0) & (apart < 1.2 * L)]
    assert len(linked) == 2 * (4 * 4 + 2 * (2 * 4 + 1) + 9)
    assert np.abs(linked / L - 1).max() < 0.02


def test_kept_links_survive_any_distance_and_end_with_an_agent(f64):
    far = np.array([[0.0, 0], [40, 0], [40, 30]])
    single = _springs([[0, 0], [L, 0], [L / 2, np.sqrt(0.75) * L]], freeze=0.001)
    single.step()
    assert (single.memory("prey")["damper"]["linked"] == 1).all()
    assert single.memory("prey")["damper"]["links_low"].tolist() == [6, 5, 3]
    single.place("prey", far, np.zeros((3, 2)))
    single.step()
    ways = far[1:] - far[0]
    lengths = np.linalg.norm(ways, axis=1, keepdims=True)
    pulls = K * (lengths - L) / lengths * ways
    np.testing.assert_allclose(single.velocity("prey")[0], 0.01 / M * pulls.sum(axis=0), rtol=1e-9)
    gone = far.copy()
    gone[2] = np.nan
    single.place("prey", gone, np.zeros((3, 2)))
    single.step()
    np.testing.assert_allclose(single.velocity("prey")[0], 0.01 / M * pulls[0], rtol=1e-9)
    other = _springs(far, freeze=0.0)
    other.step()
    np.testing.assert_array_equal(other.velocity("prey"), 0)  # nobody is near enough to be linked anew


def test_each_of_48_agents_keeps_the_links_that_it_has(f64):
    random = np.random.default_rng(6)
    place = random.uniform(0, 40, (48, 2))
    single = _springs(place, freeze=1000.0)
    single.step()
    memory = single.memory("prey")["damper"]
    words = np.stack([memory["links_low"], memory["links_high"]], axis=1).astype(np.int64)
    kept = np.concatenate([words[:, :1] >> np.arange(24) & 1, words[:, 1:] >> np.arange(24) & 1], axis=1)
    apart = np.linalg.norm(place[:, None] - place, axis=2)
    np.testing.assert_array_equal(kept, (apart < 1.2 * L) & ~np.eye(48, dtype=bool))


def test_the_program_sets_velocity_afresh_and_its_damper_pulls_by_the_size_of_the_change(f64):
    place, rate = np.array([[0.0, 0], [7, 3]]), np.array([[0.2, 0], [0.1, -0.3]])
    single = _springs(place, rate, form="program")
    single.step()
    middle = place + 0.005 * rate
    way = middle[1] - middle[0]
    length = np.linalg.norm(way)
    change = (rate[1] - rate[0]) @ way / length
    assert change < 0  # they close in, and the damper pulls all the same
    force = (K * (length - L) + 2.0 * abs(change)) * way / length
    np.testing.assert_allclose(single.velocity("prey"), [force / M, -force / M], rtol=1e-9)


def test_the_first_agent_alone_heeds_the_target_once_its_links_are_kept(f32):
    recording = tiswarm.record(tiswarm.load("delft/damper-leader"), terms=True)
    linked = recording.prey.state[:-1, 0] == "linked"
    goal = np.nan_to_num(recording.prey.terms["goal"])
    assert linked.any()
    assert not linked[0]
    assert (goal[:-1, 1:] == 0).all()
    assert (goal[:-1, 0][~linked] == 0).all()
    here = linked & np.isfinite(recording.prey.terms["goal"][:-1, 0, 0])
    np.testing.assert_allclose(np.linalg.norm(goal[:-1, 0][here], axis=1), recording.scenario.prey.goal, rtol=1e-5)


def test_a_leader_pulls_springs_to_the_target_and_without_one_they_stay(f32):
    led = tiswarm.simulate(tiswarm.load("delft/damper-leader"), 100)
    alone = tiswarm.simulate(tiswarm.load("delft/damper"), 100)
    assert led.arrived.sum() > 0
    assert (alone.alive == 5).all()
    again = tiswarm.simulate(tiswarm.load("delft/damper-leader"), 30)
    np.testing.assert_array_equal(again.ticks, led.ticks[:30])


@pytest.mark.quick
def test_more_agents_than_links_have_room_for_get_one_line():
    with pytest.raises(tiswarm.ScenarioError, match=r"prey.count: 'damper' works for 48 agents at most; lower it") as caught:
        tiswarm.load("delft/damper", {"prey.count": 49})
    assert "\n" not in str(caught.value)
