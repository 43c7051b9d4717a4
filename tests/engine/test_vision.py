"""Whom agents see: nobody outside their field of view, and the nearest of their mates alone, in trials and in large swarms."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.swarms.simulation import Swarm
from tiswarm.engine.trials.trial import Single

COUNT = 40
PLAIN = {
    "world.size": [30.0, 20.0],
    "world.ticks": 3,
    "world.boundary": "periodic",
    "world.contact": "none",
    "target.present": False,
    "obstacles.count": 0,
    "predators.count": 0,
    "prey.count": COUNT,
    "prey.perception": 9.0,
    "prey.spacing": 4.0,
    "prey.max_speed": 100.0,
    "prey.cohesion": 0.3,
    "prey.separation": 0.1,
    "prey.alignment": 0.2,
    "prey.spawn.region": [[0, 0], [30, 20]],
    "prey.spawn.velocity": [[-1, -1], [1, 1]],
    "measures.names": [],
}
ENGINES = [Single, lambda scenario, seed, trial: _First(Swarm(scenario, seed, 1, trial))]


class _First:
    """The first trial of a large swarm, read like a single one."""

    def __init__(self, swarm):
        self._swarm = swarm
        self.step = swarm.step

    def position(self, kind):
        return self._swarm.position(kind)[0]

    def velocity(self, kind):
        return self._swarm.velocity(kind)[0]


def _flocked(place, rate, view=360.0, nearest=None, reach=9.0, spacing=4.0):
    """Give the velocities after a tick of flocking, worked out agent by agent."""
    size = np.array(PLAIN["world.size"])
    after = rate.copy()
    for i in range(len(place)):
        way = place - place[i]
        way -= size * np.round(way / size)
        far = np.linalg.norm(way, axis=1)
        angle = np.arccos(np.clip(way @ rate[i] / np.maximum(far * np.linalg.norm(rate[i]), 1e-300), -1, 1))
        seen = [j for j in np.argsort(far) if j != i and far[j] <= reach and np.degrees(angle[j]) <= view / 2][:nearest]
        if not seen:
            after[i] -= 0.2 * rate[i]
            continue
        close = [j for j in seen if far[j] <= spacing]
        after[i] += 0.3 * way[seen].mean(axis=0) - 0.1 * way[close].sum(axis=0) + 0.2 * (rate[seen].mean(axis=0) - rate[i])
    return after


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("view", "nearest"), [(360.0, 7), (270.0, None), (90.0, None), (200.0, 3), (360.0, 1)])
def test_an_agent_flocks_with_the_nearest_in_view_and_with_nobody_else(view, nearest, engine, f64):
    scenario = tiswarm.load("delft/pronav-0", PLAIN | {"prey.field_of_view": view, "prey.nearest": nearest or "all"})
    trial = engine(scenario, 3, 1)
    place, rate = trial.position("prey"), trial.velocity("prey")
    trial.step(1)
    np.testing.assert_allclose(trial.velocity("prey"), _flocked(place, rate, view, nearest), atol=1e-12)
    assert not np.allclose(trial.velocity("prey"), _flocked(place, rate)), "then the test saw nothing"


@pytest.mark.parametrize("engine", ENGINES)
def test_as_many_nearest_as_there_are_mates_change_no_bit(engine, f64):
    runs = []
    for nearest in ("all", 30):
        trial = engine(tiswarm.load("delft/pronav-0", PLAIN | {"prey.count": 31, "prey.nearest": nearest}), 3, 1)
        trial.step(3)
        runs.append(trial.velocity("prey"))
    np.testing.assert_array_equal(*runs)


@pytest.mark.parametrize(("key", "values"), [("prey.nearest", [2.0, 5.0, 9.0]), ("prey.field_of_view", [100.0, 250.0, 360.0])])
def test_trials_with_numbers_of_their_own_are_those_of_their_scenarios(key, values, f64):
    base = PLAIN | {"prey.nearest": 4, "prey.field_of_view": 200.0, "measures.names": ["speed"]}
    swept = tiswarm.simulate(tiswarm.load("delft/pronav-0", base), 3, seed=2, weights={key: np.array(values)})
    for trial, value in enumerate(values):
        own = base | {key: int(value) if key.endswith("nearest") else min(value, 359.999_999)}
        alone = tiswarm.simulate(tiswarm.load("delft/pronav-0", own), 3, seed=2)
        assert swept.measures["speed"][trial] == alone.measures["speed"][trial]


def _tick(preset, changes, prey, predators=((), ())):
    """Give both kinds' velocities after one tick from places and velocities."""
    start = tiswarm.Start(
        *(np.array(each, float).reshape(-1, 2) for each in (*prey, *predators)), np.zeros((0, 2)), np.zeros(0)
    )
    path = tiswarm.record(tiswarm.load(preset, {"world.ticks": 1} | changes), start=start)
    return path.prey.velocity[1], path.predators.velocity[1]


def test_a_hawk_hunts_what_is_ahead_and_not_the_nearer_prey_behind_it(f64):
    nearest = {"predators.weights.pursuit": "nearest"}
    prey, hawk = ([[4, 7], [11, 7]], [[0, 0], [0, 0]]), ([[6, 7]], [[1, 0]])
    assert _tick("m20/hawk", nearest, prey, hawk)[1][0, 0] == pytest.approx(-3)
    assert _tick("m20/hawk", nearest | {"predators.field_of_view": 180.0}, prey, hawk)[1][0, 0] == pytest.approx(3)


def test_a_hawk_that_stands_sees_all_around(f64):
    keys = {"predators.weights.pursuit": "nearest", "predators.field_of_view": 60.0}
    assert _tick("m20/hawk", keys, ([[4, 7]], [[0, 0]]), ([[6, 7]], [[0, 0]]))[1][0, 0] == pytest.approx(-3)


def test_prey_do_not_fear_the_predator_behind_them(f64):
    keys = {"prey.strategy": "evasive", "prey.weights.evade": 1.0, "target.present": False, "prey.field_of_view": 180.0}
    prey = ([[50, 20], [52, 20]], [[0.5, 0], [-0.5, 0]])
    behind_the_first = ([[48, 20]], [[0, 0]])
    blind, _ = _tick("delft/pronav-0", keys, prey, behind_the_first)
    nobody, _ = _tick("delft/pronav-0", keys, prey, ([[48, 900]], [[0, 0]]))
    np.testing.assert_array_equal(blind[0], nobody[0])
    assert not np.array_equal(blind[1], nobody[1])


@pytest.mark.quick
@pytest.mark.parametrize(
    ("changes", "parts"),
    [
        ({"prey.nearest": 0}, ("prey.nearest: 0", "1 to 30", "'all'")),
        ({"prey.nearest": 31}, ("prey.nearest: 31", "1 to 30")),
        ({"prey.nearest": 2.5}, ("prey.nearest: 2.5", "whole number")),
        ({"prey.nearest": "seven"}, ("prey.nearest: 'seven'", "'all'")),
        ({"prey.nearest": True}, ("prey.nearest: True", "whole number")),
        ({"predators.nearest": -1}, ("predators.nearest: -1", "1 to 30")),
        ({"prey.field_of_view": 0}, ("prey.field_of_view: 0", "use 1 or more")),
        ({"predators.field_of_view": 361}, ("predators.field_of_view: 361", "use 360 or less")),
        ({"prey.field_of_view": float("nan")}, ("prey.field_of_view", "finite")),
    ],
)
def test_sight_that_cannot_be_gets_one_line(changes, parts):
    with pytest.raises(tiswarm.ScenarioError) as caught:
        tiswarm.load("delft/pronav-10", changes)
    assert "\n" not in str(caught.value)
    for part in parts:
        assert part in str(caught.value)
