"""What may be turned while a scenario runs: ranges, units and words come from the declarations."""

from dataclasses import dataclass

import pytest

import tiswarm
from tiswarm.scenario.knobs import knobs
from tiswarm.strategies import registry
from tiswarm.strategies.declared import Declared, declared

pytestmark = pytest.mark.quick


def by_path(scenario, reference=None):
    return {each.path: each for each in knobs(scenario, reference or scenario)}


def test_a_comment_beside_a_number_is_its_words_and_its_unit():
    @dataclass
    class Weights:
        push: float = 1.0  # strength of the outward part [m²/s]
        flag: float = 0.0  # 1: all; 0: only itself
        span: float = 2.0  # m, how far it reaches
        bare: float = 2.0  # m/s
        none: float = 3.0

    assert declared(Weights) == {
        "push": Declared("strength of the outward part", "m²/s"),
        "flag": Declared("1: all; 0: only itself", ""),
        "span": Declared("how far it reaches", "m"),
        "bare": Declared("", "m/s"),
    }


@pytest.mark.parametrize("kind", registry.KINDS)
def test_every_weight_of_every_strategy_has_a_knob_with_its_value_in_range(kind):
    side = "predators" if kind == "predators" else "prey"
    role = "avoidance" if kind == "avoidance" else "strategy"
    for name in registry.names(kind):
        flat = 2 in registry.dimensions(kind, name)
        scenario = tiswarm.load("delft/pronav-10" if flat else "lookout/aquarium", {f"{side}.{role}": name})
        found = by_path(scenario)
        for weight, default in registry.defaults(kind, name).items():
            knob = found.get(f"{side}.weights.{weight}")
            if isinstance(default, str) and weight not in registry.choices(kind, name):
                assert knob is None  # a network's file
            elif knob.names is not None:
                assert knob.value in knob.names
            else:
                assert knob.low <= knob.value <= knob.high
                assert knob.low < knob.high
                assert 0 < knob.step <= (knob.high - knob.low) / 100


def test_a_range_comes_from_the_preset_and_holds_what_is_set_beyond_it():
    reference = tiswarm.load("delft/pronav-10")
    assert by_path(reference)["prey.goal"].high == pytest.approx(0.4)
    wide = by_path(reference.replaced({"prey.goal": 3.0}), reference)["prey.goal"]
    assert (wide.low, wide.high) == (0, 3.0)
    below = by_path(reference.replaced({"prey.goal": -1.0}), reference)["prey.goal"]
    assert below.low == -1.0
    assert by_path(reference)["prey.max_speed"].low > 0


def test_menus_offer_what_works_in_such_a_world():
    flat, deep = by_path(tiswarm.load("delft/pronav-10")), by_path(tiswarm.load("lookout/aquarium"))
    assert "explode" in flat["prey.strategy"].names
    assert "explode" not in deep["prey.strategy"].names
    assert flat["prey.strategy"].names["evasive"].startswith("Evasive")


def test_a_target_that_ways_are_planned_to_moves_with_a_new_trial():
    assert by_path(tiswarm.load("delft/planned-10"))["target.position.0"].anew
    assert not by_path(tiswarm.load("delft/avoidance-10"))["target.position.0"].anew


def test_whoever_is_not_there_has_no_knobs():
    found = by_path(tiswarm.load("delft/avoidance-10", {"predators.count": 0, "target.present": False}))
    assert "predators.count" in found
    assert not any(path.startswith(("predators.weights", "predators.goal", "target")) for path in found)


@pytest.mark.parametrize(
    ("path", "value"), [("prey.count", 2.5), ("prey.count", 0), ("prey.goal", float("nan")), ("prey.goal", True)]
)
def test_a_knob_refuses_what_cannot_be(path, value):
    with pytest.raises(ValueError, match=r"number|possible"):
        by_path(tiswarm.load("delft/pronav-10"))[path].checked(value)
