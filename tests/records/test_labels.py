"""Labels: who is alarmed among crowds, of whom only as many are looked at as it takes."""

import numpy as np
import pytest

import tiswarm
from tiswarm.records import labels
from tiswarm.space import box
from tiswarm.space.sight import in_view

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("boundary", ["open", "periodic"])
@pytest.mark.parametrize("view", [360.0, 100.0])
@pytest.mark.parametrize(("own", "others"), [(5, 3000), (3000, 5), (40, 0), (700, 900)])
def test_alarmed_is_whoever_has_any_opponent_in_view(boundary, view, own, others):
    changes = {"world.boundary": boundary, "predators.field_of_view": view, "predators.perception": 1.5}
    scenario = tiswarm.load("delft/centre-0", {"predators.spawn.region": [[0, 0], [9, 9]], **changes})
    rng = np.random.default_rng(own)
    here, there, velocity = rng.uniform(0, 100, (own, 2)), rng.uniform(0, 100, (others, 2)), rng.normal(size=(own, 2))
    here[::7], there[1::5] = np.nan, np.nan
    named = labels.named(scenario, "predators", here, velocity, there, {})
    period = box.period(scenario.world.size, boundary) * scenario.world.wrap_sight
    way = box.displacement(there[None] - here[:, None], period)
    expected = ((np.linalg.norm(way, axis=2) <= 1.5) & in_view(way, velocity, view)).any(axis=1)
    if own < others:
        assert 0 < expected.sum() < own
    assert (named == np.where(expected, "alarmed", "calm")).all()
