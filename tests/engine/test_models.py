"""Worlds that are deep, periodic or walled: what every preset keeps to, every strategy in space, and what is refused."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.run import simulate_many
from tiswarm.engine.trials.kernel import OUTCOMES
from tiswarm.scenario import presets
from tiswarm.strategies import registry

FEW = {"world.ticks": 40, "prey.count": 12}
# Those of Delft are test_trials.py's.
SMALL = [name for name in presets.presets() if not name.startswith("delft/") and tiswarm.load(name).prey.count <= 200]


@pytest.mark.parametrize("name", SMALL)
def test_every_preset_is_deterministic_finite_and_loses_nobody(name, precision):
    scenario = tiswarm.load(name, FEW)
    results = tiswarm.simulate(scenario, 20, seed=4)
    np.testing.assert_array_equal(results.alive + results.captured + results.crashed + results.arrived, results.spawned)
    again = tiswarm.simulate(scenario, 9, seed=4)
    for outcome in OUTCOMES:
        np.testing.assert_array_equal(getattr(again, outcome), getattr(results, outcome)[:9])
    path = tiswarm.record(scenario, 7, seed=4)
    path.check()
    assert path.dim == scenario.world.dim
    assert path.ticks == results.ticks[7]
    assert (path.prey.fate == "captured").sum() == results.captured[7]
    if scenario.world.boundary != "open":
        assert np.nanmin(path.prey.position) >= 0
        assert (np.nanmax(path.prey.position, axis=(0, 1)) <= scenario.world.size).all()


@pytest.mark.parametrize("kind", registry.KINDS)
def test_every_strategy_that_works_in_space_runs_there(kind, f32):
    able = [name for name in registry.names(kind) if 3 in registry.dimensions(kind, name)]
    key = "prey.avoidance" if kind == "avoidance" else f"{kind}.strategy"
    hunt = {"predators.count": 3, "predators.avoidance": "none", "predators.strategy": "centre"}
    region = {"predators.spawn": {"region": [[60, 60, 60], [70, 70, 70]], "velocity": [[0, 0, 0], [1, 1, 1]]}}
    assert able
    scenarios = []
    for name in able:
        chosen = {**hunt, **region, **FEW, "obstacles.contact": "crash", "measures.names": ["speed"], key: name}
        if name == "potential":
            chosen["prey.weights.law"] = "velocity"
        scenarios.append(tiswarm.load("lookout/aquarium", chosen))
    for results in simulate_many(scenarios, 16):  # one kernel for all
        np.testing.assert_array_equal(results.alive + results.captured + results.crashed + results.arrived, 12)
        assert np.isfinite(results.measures["speed"]).all()


@pytest.mark.parametrize(
    ("preset", "overrides", "parts"),
    [
        ("lookout/aquarium", {"prey.strategy": "split"}, ("prey.strategy", "'split'", "2-D worlds only")),
        ("lookout/aquarium", {"prey.avoidance": "kitchen-sink"}, ("prey.avoidance", "'kitchen-sink'", "2-D")),
        ("lookout/aquarium", {"predators.count": 2}, ("predators.spawn.region", "2 numbers", "write 3")),
        ("lookout/aquarium", {"prey.drive": "unicycle"}, ("prey.drive", "flat world", "'point'")),
        ("lookout/aquarium", {"prey.strategy": "potential"}, ("prey.weights.law", "'heading'", "flat world")),
        ("lookout/aquarium", {"target.position": [1, 2]}, ("target.position", "2 numbers", "write 3")),
        ("lookout/aquarium", {"coverage.cell": 1}, ("coverage.cell", "flat world")),
        ("m20/hawk", {"world.margin": 1}, ("world", "walls")),
        ("m20/hawk", {"world.boundary": "periodic and walls"}, ("world.boundary", "'walls'")),
        ("m20/hawk", {"prey.spawn.region": [[0, 0], [16, 15]]}, ("prey.spawn.region", "edges", "world.size")),
        ("m20/hawk", {"prey.weights.urgency": "great"}, ("prey.weights.urgency", "'great'", "'normalised' or 'power'")),
        ("m20/hawk", {"prey.weights.fear": "great"}, ("prey.weights.fear", "'great'", "number")),
        ("m20/hawk", {"predators.weights.pursuit": 2}, ("predators.weights.pursuit", "2", "'cycle' or 'nearest'")),
        ("m20/hawk", {"world.contact": "kiss"}, ("world.contact", "'kiss'", "'bounce'")),
        ("m20/hawk", {"world.size": [15]}, ("world.size", "two numbers")),
        ("m20/hawk", {"measures.names": ["speeed"]}, ("measures.names", "'speeed'", "'speed'")),
        ("m20/hawk", {"measures.names": ["coverage"]}, ("measures.names", "'coverage'", "coverage.cell")),
        ("sanitation/boids", {"prey.weights.separation_power": 3}, ("separation_power", "3", "1 or 2")),
        ("sanitation/boids", {"prey.min_speed": 9}, ("prey.min_speed", "9", "max_speed")),
        ("sanitation/boids", {"coverage.cell": 0.01}, ("coverage.cell", "cells", "larger")),
    ],
)
def test_what_does_not_go_together_gets_one_line(preset, overrides, parts):
    with pytest.raises(tiswarm.ScenarioError) as caught:
        tiswarm.load(preset, overrides)
    message = str(caught.value)
    assert "\n" not in message
    for part in parts:
        assert part in message


def test_worlds_of_different_kinds_do_not_share_a_batch():
    with pytest.raises(tiswarm.ScenarioError, match="one after the other"):
        simulate_many([tiswarm.load("m20/hawk"), tiswarm.load("delft/pronav-10")], 2)


def test_numbers_that_select_the_kernel_do_not_differ_from_trial_to_trial():
    with pytest.raises(tiswarm.ScenarioError, match="same for all trials"):
        tiswarm.simulate(tiswarm.load("sanitation/boids"), 4, weights={"coverage.cell": np.full(4, 8.0)})


def test_a_start_must_have_the_dimensions_of_the_world():
    place, none = np.ones((2, 2)), np.zeros((0, 2))
    with pytest.raises(ValueError, match="use as many"):
        tiswarm.record(tiswarm.load("lookout/aquarium"), start=tiswarm.Start(place, place, none, none, none, np.zeros(0)))


def test_choices_are_words_in_presets_and_stay_so():
    scenario = tiswarm.load("m20/hawk", {"prey.weights.urgency": "power"})
    assert scenario.prey.weights["urgency"] == "power"
    assert scenario.numbers()["prey.weights.urgency"] == 1.0
    assert 'urgency = "power"' in scenario.to_toml()
    assert tiswarm.Scenario.from_json(scenario.to_json()) == scenario
