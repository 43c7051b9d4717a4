"""Lines of pursuit lead to whom predators chase."""

import dataclasses

import numpy as np
import pytest

import tiswarm
from render.scene.pursuit import chased, quarries
from render.scene.trajectories import Trajectories

pytestmark = pytest.mark.quick


def aims(recording, kind, time=0.0):
    paths = Trajectories([recording])
    spots = paths.spots(time)
    agents, ways = quarries(paths, 0, kind, time, spots)
    return spots, agents, spots[agents] + ways


def test_each_strategy_says_whom_it_chases():
    kinds = {
        name: chased(tiswarm.load(name)) for name in ("delft/centre-10", "delft/pronav-10", "delft/cluster-10", "demo/hawk")
    }
    assert list(kinds.values()) == ["swarm", "swarm", "group", "nearest"]
    assert chased(tiswarm.load("m20/hawk")) == "cycle"
    with pytest.raises(ValueError, match="of strategy 'neural' chase is not known"):
        chased(tiswarm.load("delft/neural", {"predators.strategy": "neural"}))


def test_lines_lead_to_the_middle_of_those_that_are_left(make):
    recording = make(prey=6, predators=2, prey_ends={0: (3, "captured")})
    for time, left in ((0.0, range(6)), (5.0, range(1, 6))):
        spots, agents, ends = aims(recording, "swarm", time)
        assert list(agents) == [6, 7]
        assert ends == pytest.approx(np.tile(spots[list(left)].mean(axis=0), (2, 1)))


def test_lines_lead_to_the_nearest_or_to_the_next_one(make):
    recording = make(prey=4, predators=2)
    spots, agents, ends = aims(recording, "nearest")
    apart = np.linalg.norm(spots[:4][None] - spots[agents][:, None], axis=2)
    assert ends == pytest.approx(spots[apart.argmin(axis=1)])
    for tick in range(6):
        spots, _, ends = aims(recording, "cycle", float(tick))
        assert ends == pytest.approx(np.tile(spots[tick % 4], (2, 1)))


def test_lines_lead_to_a_predators_own_part_of_the_swarm(make):
    """Prey are of groups 0, 1, 0, 1, ..., as are predators."""
    recording = make(prey=6, predators=2, chased=2)
    spots, agents, ends = aims(recording, "group")
    assert list(agents) == [6, 7]
    assert ends == pytest.approx(np.array([spots[0:6:2].mean(axis=0), spots[1:6:2].mean(axis=0)]))
    nobody = dataclasses.replace(recording, predators=make(prey=6, predators=2).predators)
    assert len(aims(nobody, "group")[1]) == 0
