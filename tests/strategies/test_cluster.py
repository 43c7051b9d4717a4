"""Predators that cluster the prey and split up: whom each chases, and with whom it flocks."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.run import simulate_many
from tiswarm.engine.trials.kernel import OUTCOMES

KEPT = {"predators.weights.labels": "kept"}
STICKY = {**KEPT, "predators.weights.sticky": True}


@pytest.mark.anew
def test_threads_and_company_change_no_bit():
    scenarios = [
        tiswarm.load("delft/cluster-10"),
        tiswarm.load("delft/cluster-10", {"prey.count": 11, "predators.weights.restarts": 3}),
        tiswarm.load("delft/cluster-10", {"predators.strategy": "pronav"}),
        tiswarm.load("delft/cluster-0", KEPT),
        tiswarm.load("delft/cluster-0", {"predators.weights.max_clusters": 3, **STICKY}),
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


def test_with_one_cluster_they_steer_for_the_centre(f64):
    one = tiswarm.record(tiswarm.load("delft/cluster-10", {"predators.weights.max_clusters": 1}), 2)
    other = tiswarm.record(tiswarm.load("delft/cluster-10", {"predators.strategy": "centre"}), 2)
    np.testing.assert_array_equal(one.predators.position, other.predators.position)


def test_recordings_tell_who_chases_whom(f64):
    path = tiswarm.record(tiswarm.load("delft/cluster-10", KEPT), 1)
    assert (path.prey.group[0] == -1).all()
    assert (path.predators.group[0] == -1).all()
    counts = path.prey.group.max(axis=1) + 1
    assert set(counts[1:]) <= {1, 2, 3, 4, 5}
    for tick in range(1, path.ticks):
        np.testing.assert_array_equal(path.predators.group[tick], np.arange(1, 13) % counts[tick])


@pytest.mark.parametrize("labels", ["kept", "redrawn"])
def test_each_flies_for_its_centre_and_flocks_with_its_number(f64, labels):
    off = {f"predators.{name}": 0 for name in ("separation", "alignment")} | {"predators.weights.labels": labels}
    scenario = tiswarm.load("delft/cluster-0", {**off, "predators.cohesion": 0.01, "predators.max_speed": 100})
    path = tiswarm.record(scenario.replaced({"world.ticks": 1, "predators.perception": 1000}), 6)
    mine, number = path.predators.group[1], np.arange(1, 13) % (path.prey.group[1].max() + 1)
    assert mine.max() > 0
    assert (mine == number).all() == (labels == "kept")
    place, velocity = path.predators.position[0], path.predators.velocity[0]
    for j in range(12):
        mates = (number == number[j]) & (np.arange(12) != j)
        centre = path.prey.position[1][path.prey.group[1] == mine[j]].mean(axis=0)
        expected = velocity[j] + 0.1 * (centre - place[j]) + 0.01 * (place[mates].mean(axis=0) - place[j])
        np.testing.assert_allclose(path.predators.velocity[1][j], expected)


def test_sticky_ones_keep_their_sub_swarm_when_labels_are_renumbered(f64):
    renumbered = 0
    for trial in range(3):
        path = tiswarm.record(tiswarm.load("delft/cluster-10", STICKY), trial)
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


def test_scikit_learn_and_kneed_live_give_the_same_path(f64):
    scenario = tiswarm.load("delft/cluster-10", {"world.ticks": 6, **KEPT})
    path = tiswarm.record(scenario, 3)
    live = tiswarm.record(scenario.replaced({"predators.weights.reference": True}), 3)
    np.testing.assert_array_equal(live.prey.group, path.prey.group)
    np.testing.assert_array_equal(live.predators.group, path.predators.group)
    np.testing.assert_allclose(live.predators.position, path.predators.position, rtol=1e-12)


def test_centres_are_drawn_anew_each_tick_and_for_each_predator(f64):
    path = tiswarm.record(tiswarm.load("delft/cluster-10"), 1)
    steady = [t for t in range(2, path.ticks) if (path.prey.group[t] == path.prey.group[t - 1]).all()]
    now, before = path.predators.group[steady], path.predators.group[np.array(steady) - 1]
    assert 0.3 < (now != before).mean() < 0.7
    assert (now[:, 1::2] != now[:, 1:2]).any()  # of predators with numbers of one kind, too
    other = tiswarm.record(tiswarm.load("delft/cluster-10"), 1, seed=1)
    assert (other.predators.group[1] != path.predators.group[1]).any()


def test_drawn_centres_leave_all_other_luck_alone(f64):
    first = [tiswarm.record(tiswarm.load("delft/cluster-10", {**each, "world.ticks": 1}), 4) for each in ({}, KEPT)]
    np.testing.assert_array_equal(first[0].prey.position, first[1].prey.position)
    np.testing.assert_array_equal(first[0].obstacle_position, first[1].obstacle_position)
    np.testing.assert_array_equal(first[0].prey.group, first[1].prey.group)


def test_reference_fits_for_each_predator_and_tick(f64):
    scenario = tiswarm.load("delft/cluster-10", {"world.ticks": 4, "predators.weights.reference": True})
    path = tiswarm.record(scenario, 3)
    again = tiswarm.record(scenario, 3)
    np.testing.assert_array_equal(path.predators.position, again.predators.position)
    groups = path.predators.group[1:]
    assert (groups[0] != groups[1:]).any()
    assert ((groups >= 0) & (groups <= path.prey.group[1:].max())).all()


def test_a_deep_world(f64):
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


def test_many_trials_do_not_wait_for_scikit_learn():
    scenario = tiswarm.load("delft/cluster-10", {"predators.weights.reference": True})
    with pytest.raises(tiswarm.ScenarioError, match=r"predators.weights.reference: works in single trials"):
        tiswarm.simulate(scenario, 4)
    scenario = tiswarm.load("delft/cluster-10")
    with pytest.raises(tiswarm.ScenarioError, match="is the same for all trials of a batch"):
        tiswarm.simulate(scenario, 2, weights={"predators.weights.reference": np.array([0, 1])})


def test_sticky_ones_need_labels_that_are_kept():
    with pytest.raises(
        tiswarm.ScenarioError,
        match=r"predators.weights.sticky: needs predators.weights.labels = 'kept', not 'redrawn'; set it, or sticky to 0",
    ):
        tiswarm.load("delft/cluster-10", {"predators.weights.sticky": True})


@pytest.mark.parametrize(("key", "value"), [("max_clusters", 0), ("max_clusters", 9), ("max_clusters", 2.5), ("restarts", -1)])
def test_counts_that_cannot_be_are_refused(key, value):
    with pytest.raises(tiswarm.ScenarioError, match=rf"predators.weights.{key}: {value} is not allowed; use a whole number"):
        tiswarm.load("delft/cluster-10", {f"predators.weights.{key}": value})
