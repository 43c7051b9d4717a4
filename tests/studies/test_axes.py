"""Axes: the points that a study visits."""

import numpy as np
import pytest
from pydantic import ValidationError

from tiswarm import ScenarioError
from tiswarm.studies.axes import Axis, label, points
from tiswarm.studies.design import cells, load_study

pytestmark = pytest.mark.quick


def test_a_grid_visits_every_value_with_every_other_the_last_axis_fastest():
    axes = [Axis(key="a", values=(1, 2)), Axis(key="b", values=("x", "y", "z"))]
    found = [(point["a"], point["b"]) for point in points(axes, "grid", None)]
    assert found == [(1, "x"), (1, "y"), (1, "z"), (2, "x"), (2, "y"), (2, "z")]


def test_zip_goes_side_by_side():
    axes = [Axis(key="a", values=(1, 2)), Axis(key="b", low=0.0, high=1.0, steps=2)]
    assert points(axes, "zip", None) == [{"a": 1, "b": 0.0}, {"a": 2, "b": 1.0}]


def test_several_keys_of_one_axis_change_together():
    axis = Axis(key=("obstacles.count", "predators.count"), values=((0, 12), (10, 15)))
    assert points([axis], "grid", None)[1] == {"obstacles.count": 10, "predators.count": 15}


def test_a_name_stands_for_what_an_axis_sets_in_rows_and_on_the_terminal(tmp_path):
    text = (
        'title = "t"\nbase = "delft/pronav-10"\ntrials = 2\n[[axes]]\nkey = ["name", "prey.strategy", "prey.weights.evade"]\n'
    )
    text += 'values = [["by hand", "evasive"], { name = "found", "prey.strategy" = "evasive", "prey.weights.evade" = 0.004 }]\n'
    text += '[[axes]]\nkey = "base"\n'
    text += 'values = ["delft/pronav-10", "delft/centre-10"]\n'
    (tmp_path / "t.toml").write_text(text)
    study = load_study(str(tmp_path / "t.toml"))
    found = cells(str(tmp_path / "t.toml"), study, 0)
    assert [cell.row for cell in found[1:3]] == ["by hand/delft/centre-10", "found/delft/pronav-10"]
    assert found[3].scenario.numbers()["prey.weights.evade"] == 0.004
    assert found[0].table.shown == ("name", "base")
    (tmp_path / "t.toml").write_text(text.replace('"by hand"', '"found"'))
    with pytest.raises(ScenarioError, match="name of its own"):
        load_study(str(tmp_path / "t.toml"))


def test_ranges_step_evenly_geometrically_or_through_whole_numbers():
    assert [point["a"] for point in points([Axis(key="a", low=0.0, high=0.3, steps=4)], "grid", None)] == [0.0, 0.1, 0.2, 0.3]
    assert [p["a"] for p in points([Axis(key="a", low=1.0, high=100.0, steps=3, scale="log")], "grid", None)] == [
        1.0,
        10.0,
        100.0,
    ]
    whole = [point["a"] for point in points([Axis(key="a", low=2, high=10, steps=9, whole=True)], "grid", None)]
    assert whole == list(range(2, 11))
    assert all(isinstance(each, int) for each in whole)


def test_a_latin_hypercube_visits_each_share_of_each_axis_once_and_is_the_same_each_time():
    axes = [
        Axis(key="a", low=0.0, high=1.0),
        Axis(key="b", low=1.0, high=1000.0, scale="log"),
        Axis(key="c", values=("x", "y")),
    ]
    found = points(axes, "latin", 40)
    assert found == points(axes, "latin", 40)
    assert sorted(int(point["a"] * 40) for point in found) == list(range(40))
    assert sorted(int(np.log10(point["b"]) / 3 * 40) for point in found) == list(range(40))
    assert [point["c"] for point in found].count("x") == 20


@pytest.mark.parametrize(
    ("axes", "combine", "samples", "said"),
    [
        ([Axis(key="a", low=0.0, high=1.0)], "grid", None, "steps"),
        ([Axis(key="a", low=0.0, high=1.0)], "latin", None, "samples"),
        ([Axis(key="a", values=(1,))], "grid", 3, "latin"),
        ([Axis(key="a", values=(1,)), Axis(key="b", values=(1, 2))], "zip", None, "one length"),
        ([Axis(key="a", low=0, high=1, steps=5, whole=True)], "grid", None, "fewer steps"),
    ],
)
def test_axes_that_cannot_be_combined_are_refused(axes, combine, samples, said):
    with pytest.raises(ScenarioError, match=said):
        points(axes, combine, samples)


@pytest.mark.parametrize(
    "wrong",
    [
        {"key": "a"},
        {"key": "a", "values": ()},
        {"key": "a", "values": (1,), "low": 0.0},
        {"key": "a", "low": 2.0, "high": 1.0},
        {"key": "a", "low": 0.0, "high": 1.0, "scale": "log"},
        {"key": ("a", "b"), "values": (1, 2)},
        {"key": ("a", "b"), "values": ((),)},
        {"key": ("a", "b"), "values": ((1, 2, 3),)},
        {"key": ("a", "b"), "low": 0.0, "high": 1.0},
        {"key": ("a", "a"), "values": ((1, 2),)},
    ],
)
def test_axes_that_make_no_sense_are_refused(wrong):
    with pytest.raises(ValidationError):
        Axis(**wrong)


def test_a_value_that_ends_early_leaves_the_keys_behind_alone():
    axes = [Axis(key=("a", "b"), values=(("x", 1), ("y",))), Axis(key="c", values=(5, 6))]
    assert points(axes, "grid", None) == [
        {"a": "x", "b": 1, "c": 5},
        {"a": "x", "b": 1, "c": 6},
        {"a": "y", "c": 5},
        {"a": "y", "c": 6},
    ]


def test_labels_read_as_the_values_do():
    assert [label(value) for value in ("x", 3, 0.1, True, [[0, 1], [2, 3]])] == ["x", "3", "0.1", "true", "[[0, 1], [2, 3]]"]
