"""Who notices whom, for pictures and labels, follows the rules of the kernels."""

import numpy as np
import pytest

import tiswarm
from tiswarm.records.labels import named
from tiswarm.space.sight import in_view, nearest_of

pytestmark = pytest.mark.quick

WAYS = np.array([[[2.0, 0.1], [0.1, 2.0], [-2.0, 0.1], [0.0, 0.0]]])


@pytest.mark.parametrize(
    ("degrees", "seen"),
    [(360, [True] * 4), (359, [True] * 4), (300, [True, True, False, True]), (180, [True, True, False, True])],
)
def test_nobody_behind_is_in_view(degrees, seen):
    assert in_view(WAYS, np.array([[1.0, 0.0]]), degrees).tolist() == [seen]


def test_who_stands_sees_all_around():
    assert in_view(WAYS, np.zeros((1, 2)), 10).all()


def test_the_nearest_of_those_that_count_are_taken_with_whom_is_as_far():
    distance, counts = np.array([[1.0, 2.0, 2.0, 3.0, 0.5]]), np.array([[True, True, True, True, False]])
    assert nearest_of(distance, counts, 1).tolist() == [[True, False, False, False, False]]
    assert nearest_of(distance, counts, 2).tolist() == [[True, True, True, False, False]]
    assert nearest_of(distance, counts, "all").tolist() == nearest_of(distance, counts, 30).tolist() == counts.tolist()


def test_prey_are_alarmed_by_predators_in_view_alone():
    wide = tiswarm.load("delft/pronav-10", {"prey.perception": 5})
    narrow = wide.replaced({"prey.field_of_view": 200})
    place, velocity = np.array([[10.0, 10.0], [10.0, 20.0]]), np.array([[1.0, 0.0], [-1.0, 0.0]])
    hunters = np.array([[7.0, 10.0], [7.0, 20.0]])
    assert named(wide, "prey", place, velocity, hunters, {}).tolist() == ["alarmed", "alarmed"]
    assert named(narrow, "prey", place, velocity, hunters, {}).tolist() == ["calm", "alarmed"]
