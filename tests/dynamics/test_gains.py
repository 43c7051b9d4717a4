"""Gains act once a tick, whose length is then part of their meaning, or by the second, where halving a tick converges."""

import warnings

import numpy as np
import pytest

import tiswarm

LASTS = 8.0
"""How long the agents move [s]."""

CALM = {
    "predators.count": 2,
    "predators.strategy": "centre",
    "obstacles.count": 0,
    "world.contact": "none",
    "target.radius": 1e-6,
    **{f"{kind}.{key}": 1e3 for kind in ("prey", "predators") for key in ("max_speed", "perception", "spacing")},
    "prey.cohesion": 0.02,
    "prey.separation": 0.005,
    "prey.alignment": 0.1,
    "prey.goal": 0.05,
    "world.gains": "per-second",
}


def places(dt, neighbours, changes):
    """Give where everybody is in the end."""
    scenario = tiswarm.load("delft/centre-10", {**CALM, "world.neighbours": neighbours, "world.ticks": round(LASTS / dt)})
    moving = tiswarm.Simulation(scenario.replaced({"world.dt": dt, **changes}), seed=3)
    moving.step(round(LASTS / dt))
    assert moving.age == round(LASTS / dt)
    return np.concatenate([moving.position("prey"), moving.position("predators")])


CHANGES = {
    "flock": {},
    "verlet": {"world.scheme": "verlet"},
    "evasive": {"prey.strategy": "evasive", "prey.weights.evade": 0.02},
}


@pytest.mark.parametrize("neighbours", ["all-pairs", "grid"])
@pytest.mark.parametrize("case", CHANGES)
def test_the_error_halves_with_every_halving_of_a_tick(case, neighbours, f64):
    errors = []
    for dt in (0.25, 0.125, 0.0625):
        off = places(dt, neighbours, CHANGES[case]) - places(dt / 16, neighbours, CHANGES[case])
        errors.append(np.linalg.norm(off, axis=1).max())
    ratios = [errors[0] / errors[1], errors[1] / errors[2]]
    assert errors[0] > 1e-4
    assert ratios == pytest.approx([2, 2], rel=0.1), errors


def test_with_ticks_of_a_second_both_meanings_are_one(f64):
    one, other = (
        places(1.0, "all-pairs", {"world.gains": gains, "prey.max_speed": 1, "predators.max_speed": 1})
        for gains in ("per-tick", "per-second")
    )
    np.testing.assert_array_equal(one, other)


def test_gains_a_tick_do_not_converge_and_are_warned_of_in_one_line(f64):
    with pytest.warns(UserWarning, match=r"^world\.dt: 0\.1 s, and gains act once a tick, 10 times a second; set world\.gains"):
        tiswarm.load("delft/centre-10", {"world.dt": 0.1})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tiswarm.load("delft/centre-0", {"world.dt": 0.1, "world.gains": "per-second"})
        tiswarm.load("delft/centre-10")
        tiswarm.load("demo/murmuration")
    per_tick = {"world.gains": "per-tick"}
    assert np.abs(places(0.25, "all-pairs", per_tick) - places(0.125, "all-pairs", per_tick)).max() > 1


@pytest.mark.parametrize("changes", [{"prey.drive": "unicycle"}, {"prey.avoidance": "kitchen-sink"}])
def test_what_acts_once_a_tick_is_refused_by_the_second(changes):
    with pytest.raises(ValueError, match=r"once a tick, not by the second; use another"):
        tiswarm.load("delft/centre-10", {"world.gains": "per-second", **changes})
