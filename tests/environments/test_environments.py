"""Environments: the bits of trials, what agents are shown and paid, ends and new beginnings, and what is refused."""

import numpy as np
import pytest

import tiswarm
from tiswarm.environments.shown import DEFAULT, Shown

PRESET = "delft/pronav-10"
PREY, HUNTERS = 6, 15


@pytest.fixture(scope="module")
def both():
    """One environment, one kernel, for all tests that only need agents to obey."""
    return tiswarm.env(PRESET, 11, control="both")


@pytest.fixture(scope="module")
def gains():
    return tiswarm.env(PRESET, 11, actions="gains")


def _actions(seed, ticks, environment):
    shape = (ticks, environment.trials, len(environment.agents), environment.action_size)
    return np.random.default_rng(seed).uniform(-1, 1, shape)


def test_gains_of_one_give_the_trial_that_the_scenario_runs_by_itself(gains):
    gains.reset(seed=3)
    alone = tiswarm.Simulation(gains.scenario, seed=3, trial=7)
    for _ in range(40):
        gains.step(np.ones((11, PREY, 5)))
        alone.step()
    for kind, moment in zip(("prey", "predators"), gains.moments(7), strict=True):
        np.testing.assert_allclose(moment.position, alone.position(kind), atol=1e-4)  # mates are summed in another order
        np.testing.assert_array_equal(moment.fate, alone.fate(kind))


def test_gains_act(gains):
    gains.reset(seed=3)
    for _ in range(20):
        gains.step(np.full((11, PREY, 5), 0.0))  # prey of no gain go on as they began
    now = gains.moments(4)[0].velocity
    gains.reset(seed=3)
    before = gains.moments(4)[0].velocity
    still = np.isfinite(now) & (np.linalg.norm(before, axis=1) < 1.0)[:, None]  # and nobody is too fast at first
    assert still.any()
    np.testing.assert_array_equal(now[still], before[still])


def test_agents_obey_up_to_their_greatest_speed(both):
    both.reset(seed=0)
    before = both.moments(2)
    told = np.zeros((11, PREY + HUNTERS, 2))
    told[:, :, 0], told[:, PREY:, 1] = 0.5, 3.0
    both.step(told)
    for was, now, kind in zip(before, both.moments(2), ("prey", "predators"), strict=True):
        agents = getattr(both.scenario, kind)
        way = np.array([0.5, 3.0 if kind == "predators" else 0.0])
        wanted = agents.max_speed * way / max(np.linalg.norm(way), 1.0)
        there = np.isfinite(now.position[:, 0])
        assert there.any()
        np.testing.assert_allclose(now.velocity[there], np.tile(wanted, (there.sum(), 1)), rtol=1e-6)
        moved = (now.position - was.position)[there]
        np.testing.assert_allclose(moved, np.tile(wanted * both.scenario.world.dt, (there.sum(), 1)), atol=1e-5)


def test_acceleration_adds_to_the_velocity():
    environment = tiswarm.env(PRESET, 2, actions="acceleration")
    environment.reset(seed=0)
    before = environment.moments(1)[0].velocity
    environment.step(np.full((2, PREY, 2), -0.05))
    wanted = before - 0.05 * environment.scenario.prey.max_speed * environment.scenario.world.dt
    fast = np.linalg.norm(wanted, axis=1) > environment.scenario.prey.max_speed
    np.testing.assert_allclose(environment.moments(1)[0].velocity[~fast], wanted[~fast], atol=1e-6)
    assert not fast.all()


def _expected(environment, trial, kind, k):
    """Say in NumPy what an agent is shown."""
    scenario, agents = environment.scenario, getattr(environment.scenario, kind)
    moments = dict(zip(("prey", "predators"), environment.moments(trial), strict=True))
    place, speed = moments[kind].position[k], moments[kind].velocity[k]
    if np.isnan(place[0]):
        return np.zeros(environment.observation_size)
    way = np.array(scenario.target.position) - place
    shown = [speed / agents.max_speed, 2 * place / np.array(scenario.world.size) - 1]
    shown.append(way / (np.linalg.norm(way) + agents.perception))
    means = []
    for other, moment in moments.items():
        ways = moment.position - place
        away = np.linalg.norm(ways, axis=1)
        away[k if other == kind else slice(0)] = np.nan
        near = np.array([j for j in np.argsort(away, kind="stable") if away[j] <= agents.perception], int)
        drift = (moment.velocity - speed) / agents.max_speed
        told = np.column_stack([ways[near] / agents.perception, drift[near], np.ones(len(near))])
        shown.append(np.vstack([told[:3], np.zeros((3, 5))])[:3].ravel())
        means += [told[:, :4].mean(axis=0) if len(near) else np.zeros(4), [len(near) / (len(near) + 5)]]
    recording = environment.recorded([environment.moments(trial)], trial)
    ways = recording.obstacle_position - place
    away = np.linalg.norm(ways, axis=1)
    edge = away - recording.obstacle_radius
    for j in np.argsort(edge, kind="stable")[:2]:
        seen = edge[j] <= agents.perception
        told = [*(ways[j] / away[j] * edge[j] / agents.perception), recording.obstacle_radius[j] / agents.perception, 1]
        shown.append(told if seen else np.zeros(4))
    return np.concatenate([*shown, *means])


def test_agents_are_shown_what_is_around_them(both):
    shown = both.reset(seed=5)
    for actions in _actions(0, 30, both):
        shown, *_ = both.step(actions)
    for trial in (0, 10):
        for agent in range(PREY + HUNTERS):
            kind, k = ("prey", agent) if agent < PREY else ("predators", agent - PREY)
            np.testing.assert_allclose(shown[trial, agent], _expected(both, trial, kind, k), atol=2e-5)


def test_a_seed_gives_the_same_at_any_number_of_trials(both):
    few = tiswarm.env(PRESET, 3, control="both")
    first, second = both.reset(seed=9)[:3].copy(), few.reset(seed=9)
    np.testing.assert_array_equal(first, second)
    for actions in _actions(1, 25, both):
        many, paid, *_ = both.step(actions)
        some, own, *_ = few.step(actions[:3])
        np.testing.assert_array_equal(many[:3], some)
        np.testing.assert_array_equal(paid[:3], own)


def test_another_trial_begins_where_one_has_ended():
    environment = tiswarm.env(tiswarm.load(PRESET, {"world.ticks": 7}), 5)
    environment.reset(seed=2)
    rest = np.zeros((5, PREY, 2))
    for _ in range(7):
        _, _, terminated, truncated = environment.step(rest)
    assert truncated.all()
    assert not terminated.any()
    assert environment.trial.tolist() == [5, 6, 7, 8, 9]
    assert environment.final.any()
    start = tiswarm.Simulation(environment.scenario, seed=2, trial=8).position("prey")
    np.testing.assert_array_equal(environment.moments(3)[0].position, start)
    again = environment.reset(where=np.arange(5) == 3)
    assert environment.trial.tolist() == [5, 6, 7, 13, 9]
    assert not np.array_equal(again[3], environment.final[3])
    assert not environment.step(rest)[3].any()


def test_prey_are_paid_for_coming_nearer_and_arriving_and_hunters_for_touching():
    rewards = {"rewards.prey.nearer": 0.1, "rewards.predators.captured": 0.5, "predators.perception": 200.0}
    environment = tiswarm.env(tiswarm.load("delft/pronav-0", rewards), 40, control="both", again=False)
    shown, over = environment.reset(seed=0), np.zeros(40, bool)
    total = np.zeros((40, len(environment.agents)))
    while not over.all():
        told = np.zeros((40, len(environment.agents), 2))
        told[:, :PREY] = 9 * shown[:, :PREY, 4:6]  # straight to the target
        told[:, PREY:] = 400 * shown[:, PREY:, 6:8]  # straight to the nearest prey
        shown, paid, terminated, truncated = environment.step(told)
        total += paid
        over = terminated | truncated
    ends = [environment.moments(trial) for trial in range(40)]
    fates = np.array([prey.fate for prey, _ in ends])
    np.testing.assert_array_equal(environment.fate(), fates)
    assert {"arrived", "captured"} <= set(fates.ravel())
    assert (total[:, :PREY][fates == "arrived"] > 1.0).all()
    assert (total[:, :PREY][fates == "captured"] < total[:, :PREY][fates == "arrived"].min()).all()
    touched = np.array([hunters.fate for _, hunters in ends]) == "captured"
    assert touched.any()
    assert (total[:, PREY:][touched] >= 1.5).all()
    assert not environment.step(np.zeros_like(told))[1].any()


def test_an_episode_is_recorded_and_replayed(both, tmp_path):
    recording = both.record(lambda shown: 5 * np.ascontiguousarray(shown[:, :, 4:6]), seed=1, trial=12)
    recording.check()
    assert recording.trial == 12
    start = tiswarm.Simulation(both.scenario, seed=1, trial=12)
    np.testing.assert_array_equal(recording.prey.position[0], start.position("prey"))
    np.testing.assert_array_equal(recording.obstacle_position, start.obstacle_position)
    assert recording.ticks > 5
    assert recording.notes == ("prey obeyed from outside: velocity", "predators obeyed from outside: velocity")
    assert tiswarm.Recording.load(recording.save(tmp_path / "path.npz")).notes == recording.notes


@pytest.mark.quick
def test_rewards_change_no_name_of_a_scenario():
    plain = tiswarm.load(PRESET)
    assert plain.replaced({"rewards.prey.arrived": 5.0}).hash() == plain.hash()
    assert tiswarm.Scenario.from_json(plain.to_json()) == plain


@pytest.mark.quick
@pytest.mark.parametrize(
    ("names", "told"),
    [
        (("own", "nearest-prey:9"), "1 to :8"),
        (("own", "own"), "twice"),
        (("own:2",), "use own"),
        (("near",), "unknown"),
        ((), "nothing is shown"),
    ],
)
def test_what_cannot_be_shown_is_refused(names, told):
    with pytest.raises(ValueError, match=told):
        Shown.of(names, 2)


@pytest.mark.quick
def test_shown_numbers_stand_where_they_are_said_to():
    shown = Shown.of(DEFAULT, 3)
    assert shown.place("target") == (6, 1)
    assert shown.place("nearest-prey") == (9, 3)
    assert shown.width == 6 + 3 + 21 + 21 + 10 + 14


@pytest.mark.parametrize(
    ("preset", "changes", "choices", "told"),
    [
        (PRESET, {"predators.count": 0}, {"control": "predators"}, "predators.count: nobody"),
        (PRESET, {"prey.field_of_view": 200.0}, {}, "field_of_view"),
        (PRESET, {"prey.goal_by": "path"}, {}, "no planned ways"),
        (PRESET, {"world.neighbours": "grid"}, {}, "all-pairs"),
        (PRESET, {}, {"trials": 0}, "1 to 1,000,000"),
        (PRESET, {}, {"control": "all"}, "use 'prey'"),
        (PRESET, {}, {"actions": "jump"}, "use 'velocity'"),
    ],
)
def test_what_cannot_be_stepped_is_refused(preset, changes, choices, told):
    with pytest.raises(ValueError, match=told):
        tiswarm.env(tiswarm.load(preset, changes), **choices)


def test_wrong_actions_are_refused(both):
    both.reset(seed=0)
    with pytest.raises(ValueError, match="does not fit"):
        both.step(np.zeros((11, 3, 2)))
    with pytest.raises(ValueError, match="finite"):
        both.step(np.full((11, PREY + HUNTERS, 2), np.nan))
    with pytest.raises(ValueError, match="all trials have one"):
        both.reset(seed=1, where=np.arange(11) < 2)
    with pytest.raises(ValueError, match="reset first"):
        tiswarm.env(PRESET, control="both").step(np.zeros((1, PREY + HUNTERS, 2)))
