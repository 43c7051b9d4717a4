"""Random scenarios: the loader never does worse than one line of complaint, the engine never loses an agent or a number."""

import math
from functools import cache
from itertools import product

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import tiswarm
from tiswarm.engine.run import simulate_many
from tiswarm.strategies import registry

KEYS = sorted(tiswarm.load("delft/pronav-10", {"prey.strategy": "explode-evasive"}).numbers())
TEXTS = ("title", "prey.strategy", "prey.avoidance", "predators.strategy", "predators.avoidance", "world.boundary")
MORE = (
    "prey",
    "prey.weights",
    "prey.spawn",
    "world",
    "obstacles.region",
    "prey.spawn.region.0",
    "base",
    "nonsense",
    "prey.nonsense",
    "..",
    "",
)
values = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(10**9), 10**9),
    st.floats(),
    st.text(max_size=8),
    st.sampled_from(registry.names("prey") + registry.names("avoidance")),
    st.lists(st.one_of(st.floats(), st.integers(-5, 5), st.lists(st.floats(), max_size=3)), max_size=3),
    st.dictionaries(st.text(max_size=4), st.integers(), max_size=2),
)


@settings(max_examples=2000, deadline=None)
@given(st.dictionaries(st.sampled_from([*KEYS, *TEXTS, *MORE]), values, max_size=4))
def test_a_random_scenario_loads_or_gets_one_line(overrides):
    complaint = None
    try:
        scenario = tiswarm.load("delft/pronav-10", overrides)
    except tiswarm.ScenarioError as error:
        complaint = str(error)
    if complaint is None:
        assert all(math.isfinite(number) for number in scenario.numbers().values())
    else:
        assert complaint.strip()
        assert "\n" not in complaint


def _number(low, high):
    return st.floats(low, high, allow_nan=False)


def _box(low, high):
    ends = st.tuples(_number(low, high), _number(low, high)).map(sorted)
    return st.tuples(ends, ends).map(lambda axes: [[axes[0][0], axes[1][0]], [axes[0][1], axes[1][1]]])


swarm = {
    "radius": _number(0, 5),
    "perception": _number(0, 200),
    "spacing": _number(0, 50),
    "max_speed": _number(0.001, 50),
    "cohesion": _number(-2, 2),
    "separation": _number(-2, 2),
    "alignment": _number(-2, 2),
    "goal": _number(-10, 10),
    "avoidance": st.sampled_from(registry.names("avoidance")),
    "spawn": st.fixed_dictionaries({"region": _box(-100, 100), "velocity": _box(-20, 20)}),
}
scenarios = st.fixed_dictionaries(
    {
        "prey": st.fixed_dictionaries(
            {"count": st.integers(1, 9), "strategy": st.sampled_from(registry.names("prey"))}, optional=swarm
        ),
        "predators": st.fixed_dictionaries(
            {"count": st.integers(0, 9), "strategy": st.sampled_from(registry.names("predators"))}, optional=swarm
        ),
        "obstacles": st.fixed_dictionaries({"count": st.integers(0, 6)}, optional={"region": _box(-50, 100)}),
        "target": st.fixed_dictionaries(
            {}, optional={"position": st.tuples(_number(-1e5, 1e5), _number(-1e5, 1e5)), "radius": _number(0.01, 80)}
        ),
        "world": st.fixed_dictionaries({"ticks": st.integers(1, 60)}, optional={"dt": _number(1e-3, 10)}),
    }
).map(tiswarm.Scenario.model_validate)


def _with(prey, predators, kind, avoidance):
    changes = {"prey.strategy": prey, "predators.strategy": predators, f"{kind}.avoidance": avoidance}
    return tiswarm.load("delft/pronav-10", {"world.ticks": 1, "world.contact_test": "swept", **changes})


@cache
def of_each():
    """Give scenarios that have each strategy once at least: with them in every batch, all batches share one kernel."""
    names = [registry.names(kind) for kind in ("prey", "predators", "avoidance")]
    rounds = [[each[k % len(each)] for each in names] for k in range(max(map(len, names)))]
    return [_with(prey, predators, kind, avoidance) for prey, predators, avoidance in rounds for kind in ("prey", "predators")]


def _check(results):
    np.testing.assert_array_equal(results.alive + results.arrived + results.captured + results.crashed, results.spawned)
    assert ((results.ticks >= 1) & (results.ticks <= results.scenario.world.ticks)).all()
    for estimate in results.summary().values():
        assert np.isfinite([estimate.mean, estimate.stderr]).all()


def test_counts_add_up_whatever_strategies_meet(f32):
    sides = [registry.names(kind) for kind in ("prey", "predators")]
    meetings = product(*sides, ("prey", "predators"), registry.names("avoidance"))
    for results in simulate_many([_with(*meeting) for meeting in meetings], 3):
        _check(results)


@settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(scenarios, min_size=25, max_size=25))
def test_counts_add_up_on_200_random_scenarios(f32, chosen):
    for results in simulate_many([*of_each(), *chosen], 3):
        _check(results)


@settings(max_examples=6, deadline=None, suppress_health_check=list(HealthCheck))
@given(scenarios, st.integers(0, 1000))
@pytest.mark.parametrize("strategy", ["explode-evasive"])
def test_paths_of_random_scenarios_are_finite(precision, strategy, scenario, trial):
    fixed = {"prey.strategy": strategy, "prey.weights": {}, "prey.avoidance": "kitchen-sink", "predators.strategy": "pronav"}
    path = tiswarm.record(scenario.replaced({**fixed, "predators.avoidance": "repel", "predators.weights": {}}), trial)
    path.check()
    assert np.isfinite(path.prey.velocity[path.prey.alive]).all()
    assert np.isfinite(path.predators.position[path.predators.alive]).all()
