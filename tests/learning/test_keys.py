"""Keys: ranges and choices as they are written, their scales, and what is refused in one line."""

import numpy as np
import pytest

import tiswarm
from tiswarm.learning.keys import Range, arms, read, split

pytestmark = pytest.mark.quick


def test_keys_are_read_as_ranges_and_choices():
    assert read("prey.goal=0.1:2") == ("prey.goal", (0.1, 2.0))
    assert read("prey.goal = 0.1:2:log") == ("prey.goal", (0.1, 2.0, "log"))
    assert read("prey.strategy=evasive,split") == ("prey.strategy", ["evasive", "split"])
    assert read("world.wrap_sight=true,false") == ("world.wrap_sight", [True, False])


def test_scales_map_the_unit_line_onto_the_range_and_back():
    unit = np.linspace(0, 1, 11)
    for each in (Range("a", -2, 6), Range("a", 1e-3, 10, "log"), Range("a", 2, 12, "whole")):
        values = each.value(unit)
        assert (values[0], values[-1]) == (each.low, each.high)
        np.testing.assert_allclose([each.unit(value) for value in values], unit, atol=1e-12)
    assert Range("a", 1e-3, 10, "log").value(np.array([0.25]))[0] == pytest.approx(1e-2)
    assert Range("a", 2, 12, "whole").value(np.array([0.31]))[0] == 5
    assert Range("a", 2, 12, "whole").step == 0.1
    assert Range("a", 0, 1).unit(7.0) == 1.0  # a start outside begins at the nearer end


def test_paths_of_whole_numbers_are_whole_without_being_asked():
    ranges, choices = split({"prey.count": (2, 9), "prey.goal": (0, 1), "prey.strategy": ["split", "evasive"]})
    assert [each.scale for each in ranges] == ["whole", "linear"]
    assert choices[0].options == ("split", "evasive")


def test_a_range_belongs_to_the_arms_that_have_its_key():
    scenario = tiswarm.load("delft/pronav-10")
    found = arms([scenario], {"prey.strategy": ["evasive", "baseline"], "prey.weights.evade": (0, 1), "prey.goal": (0, 1)})
    assert [each.name for each in found] == ["strategy evasive", "strategy baseline"]
    assert [[r.path for r in each.ranges] for each in found] == [["prey.weights.evade", "prey.goal"], ["prey.goal"]]
    assert found[0].tuned([0.5, 0.25])[0].prey.weights["evade"] == 0.5


@pytest.mark.parametrize(
    ("over", "told"),
    [
        ({"prey.gaol": (0, 1)}, "did you mean 'prey.goal'"),
        ({"prey.strategy": (0, 1)}, "prey.strategy: is no number but 'baseline'"),
        ({"prey.goal": (1, 0)}, "prey.goal=1:0: the range must run from a lower to a higher number"),
        ({"prey.goal": (0, 1, "log")}, "a log scale needs ends above 0"),
        ({"prey.goal": (0, 1, "logg")}, "did you mean 'log'"),
        ({"prey.goal": (0, float("nan"))}, "not finite"),
        ({"prey.count": (1.5, 3)}, "whole numbers need whole ends"),
        ({"prey.count": (1, 3, "log")}, "holds whole numbers"),
        ({"prey.strategy": ["evasive"]}, "is no choice"),
        ({"prey.goal": "0:1"}, "is no range"),
        ({}, "nothing to change"),
    ],
)
def test_what_cannot_be_changed_is_refused_in_one_line(over, told):
    with pytest.raises(tiswarm.ScenarioError) as error:
        arms([tiswarm.load("delft/pronav-10")], over)
    assert told in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("text", ["prey.goal", "=1:2", "prey.goal=", "prey.goal=a:b"])
def test_what_is_no_range_says_how_to_write_one(text):
    with pytest.raises(tiswarm.ScenarioError, match="KEY=LOW:HIGH"):
        read(text)
