"""The overlay of links draws springs: those of near agents, or those kept, coloured by tension."""

import numpy as np
import pytest

import tiswarm
from render.raster.shapes import colour
from render.scene.springs import Springs, sprung
from render.scene.trajectories import Trajectories
from render.theme import DARK
from tiswarm.records.recording import Recording, Swarm

pytestmark = pytest.mark.quick


@pytest.fixture
def paths():
    """Three agents 8 m apart, of which two go far; all keep their links from tick 1 on, but for the last, from tick 3 on."""
    scenario = tiswarm.load("delft/damper", {"prey.count": 3, "obstacles.count": 0})
    place = np.zeros((5, 3, 2))
    place[:] = [[0, 0], [8, 0], [16, 0]]
    place[2:, 1] = [40, 0]
    state = np.full((5, 3), "calm", dtype="<U16")
    state[1:, :2] = "linked"
    state[3:, 2] = "linked"
    prey = Swarm(place, np.zeros_like(place), np.full(3, "alive"), state, np.full((5, 3), -1))
    none = np.zeros((5, 0, 2))
    hunters = Swarm(none, none, np.zeros(0, "<U8"), np.zeros((5, 0), "<U8"), np.zeros((5, 0), int))
    return Trajectories([Recording(scenario, 0, 0, prey, hunters, np.zeros((0, 2)), np.zeros(0))])


def test_links_are_of_the_near_until_an_agent_keeps_its_own(paths):
    springs, everybody = Springs(paths, 0, DARK), np.arange(3)
    pairs = {frozenset(pair) for pair in np.argwhere(springs.linked(everybody)).tolist()}
    assert pairs == {frozenset((0, 1)), frozenset((1, 2))}
    paths.reach(3)
    pairs = {frozenset(pair) for pair in np.argwhere(springs.linked(everybody)).tolist()}
    assert pairs == {frozenset((0, 1)), frozenset((1, 2))}  # kept by agent 2, who is far from both by now
    assert springs.linked(np.array([1, 2])).tolist() == [[False, True], [True, False]]


def test_colours_tell_tension(paths):
    hues = Springs(paths, 0, DARK).hues(np.array([4.0, 8.0, 12.0]))
    np.testing.assert_allclose(hues, [colour(DARK.prey[0]), colour(DARK.ink), colour(DARK.predator)])


def test_who_has_no_springs_is_linked_as_a_flock():
    assert not sprung(tiswarm.load("delft/avoidance-10"))
    assert sprung(tiswarm.load("delft/damper-leader"))
