"""Honesty: where the best numbers are known, a tuning finds them; where nothing is to be found, it says so."""

import pytest

import tiswarm

PAIR = {
    "prey.count": 2,
    "predators.count": 0,
    "obstacles.count": 0,
    "target.present": False,
    "world.size": [100, 100],
    "world.contact": "none",
    "prey.perception": 100.0,
    "prey.spacing": 100.0,
    "prey.spawn": {"region": [[45, 45], [55, 55]], "velocity": [[0, 0], [0, 0]]},
    "measures.names": ["nearest"],
}
BUDGET = {"budget": 8 * 4 * 40, "candidates": 8, "trials": 4, "checks": 20, "validation": 50}


def test_two_swallows_keep_the_distance_that_balances_cohesion_and_separation(f64):
    """At rest c1 = c3 / d: a distance of 4 m needs c3 = 4 c1."""
    chosen = {"prey.strategy": "swallow", "prey.weights.urgency": "power", "prey.cohesion": 0.25, "prey.alignment": 0.0}
    pair = tiswarm.load("delft/pronav-10", {**PAIR, **chosen, "world.ticks": 400, "world.dt": 0.5, "measures.after": 390})
    tuned = tiswarm.tune(pair, {"prey.separation": (0.1, 10.0, "log")}, objective="-|nearest - 4|", **BUDGET)
    assert tuned.scenario.prey.separation == pytest.approx(1.0, rel=0.01)
    assert tuned.validations[0].tuned.mean == pytest.approx(0.0, abs=0.04)


def test_potential_flocks_settle_at_their_spacing(f64):
    chosen = {"prey.strategy": "potential", "prey.weights.law": "velocity", "prey.max_speed": 10.0}
    pair = tiswarm.load("delft/pronav-10", {**PAIR, **chosen, "world.ticks": 3000, "world.dt": 0.05, "measures.after": 2900})
    tuned = tiswarm.tune(pair, {"prey.spacing": (1.0, 20.0, "log")}, objective="-|nearest - 5|", **BUDGET)
    assert tuned.scenario.prey.spacing == pytest.approx(5.0, rel=0.01)


def test_luck_is_not_sold_as_skill(f32):
    """A weight that nothing depends on: whatever is chosen, the validated difference is none."""
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive", "world.ticks": 100, "prey.weights.evade": 0.0})
    blind = scenario.replaced({"predators.count": 0})
    tuned = tiswarm.tune(blind, {"prey.weights.evade": (0.0, 0.5)}, **BUDGET)
    assert not tuned.improved
    assert tuned.validations[0].difference.mean == 0.0
