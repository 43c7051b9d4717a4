"""A wide world that stands upright in a tall frame is turned whole: whatever has a place there goes along."""

from dataclasses import fields, replace

import numpy as np
import pytest

from render.scene.trajectories import Trajectories
from render.scene.turned import gains, turned

pytestmark = pytest.mark.quick


def _upright(places):
    return np.stack([places[..., 1], 100.0 - places[..., 0]], axis=-1)


@pytest.fixture
def judged(chase):
    def told(swarm):
        return replace(swarm, judged=np.nan_to_num(swarm.position[-1], nan=3.0) + 0.25)

    return replace(chase, prey=told(chase.prey), predators=told(chase.predators))


def test_every_array_of_places_and_ways_is_turned(judged):
    upright = turned(judged)
    assert gains((720, 1280), [judged])
    for kind in ("prey", "predators"):
        before, after = getattr(judged, kind), getattr(upright, kind)
        for field in fields(before):
            old, new = getattr(before, field.name), getattr(after, field.name)
            if field.name == "terms":  # what drove them is for plots, which turn nothing
                continue
            if old is not None and old.dtype.kind == "f":
                ways = field.name == "velocity"
                np.testing.assert_array_equal(new, _upright(old) - ([0.0, 100.0] if ways else 0.0), err_msg=field.name)
            elif old is not None:
                assert new is old, field.name
    np.testing.assert_array_equal(upright.obstacle_position, _upright(judged.obstacle_position))


def test_who_dies_goes_to_the_same_place_in_both(judged):
    """Found in a film: a capture was drawn where it would have been in the world that lies."""
    lying, standing = Trajectories([judged]), Trajectories([turned(judged)])
    for tick in range(judged.ticks + 1):
        np.testing.assert_allclose(standing.spots(tick + 0.5)[:, :2], _upright(lying.spots(tick + 0.5)[:, :2]), atol=1e-9)
