"""Where agents were when they were judged to be gone, which recordings tell."""

import dataclasses

import numpy as np
import pytest

import tiswarm
from render.scene.trajectories import Trajectories
from tiswarm.records.recording import Recording, Swarm

CLOSE = {
    "prey.strategy": "explode",
    "predators.spawn.region": [[60, 25], [75, 35]],
    "obstacles.region": [[40, 10], [80, 45]],
    "prey.perception": 12,
}


@pytest.fixture(scope="module", params=["places", "swept"])
def trials(request) -> list[Recording]:
    scenario = tiswarm.load("delft/pronav-10", {**CLOSE, "world.contact_test": request.param})
    return [tiswarm.record(scenario, trial, seed=5) for trial in range(8)]


def ends(swarm: Swarm) -> np.ndarray:
    return swarm.alive.sum(axis=0)


def test_whoever_is_gone_was_somewhere_and_nobody_else(trials):
    fates = set()
    for recording in trials:
        for swarm in (recording.prey, recording.predators):
            assert swarm.judged is not None
            assert (np.isfinite(swarm.judged).all(axis=1) == (swarm.fate != "alive")).all()
            fates |= set(swarm.fate)
    assert fates == {"alive", "arrived", "captured", "crashed"}


def test_who_met_overlapped_there(trials):
    rules = trials[0].scenario
    for recording in trials:
        prey, predators = recording.prey, recording.predators
        for agent in np.flatnonzero(prey.fate == "captured"):
            rivals = (predators.fate == "captured") & (ends(predators) == ends(prey)[agent])
            if ((prey.fate == "captured") & (ends(prey) == ends(prey)[agent])).sum() > 1:
                continue  # who took two touched them at two moments of the tick, and is where it came closest to either
            apart = np.linalg.norm(predators.judged[rivals] - prey.judged[agent], axis=1)
            assert apart.min() < (rules.prey.radius + rules.predators.radius) * (1 + 1e-4)
        for agent in np.flatnonzero(prey.fate == "crashed"):
            away = np.linalg.norm(recording.obstacle_position - prey.judged[agent], axis=1) - recording.obstacle_radius
            assert away.min() < rules.prey.radius * (1 + 1e-4)
        home = np.linalg.norm(prey.judged[prey.fate == "arrived"] - rules.target.position, axis=1)
        assert (home < (rules.target.radius - rules.prey.radius) * (1 + 1e-4)).all()


def test_it_is_where_the_last_step_led(trials):
    rules = trials[0].scenario
    for recording in trials:
        for swarm, most in ((recording.prey, rules.prey.max_speed), (recording.predators, rules.predators.max_speed)):
            gone = np.flatnonzero(swarm.fate != "alive")
            step = swarm.judged[gone] - swarm.position[ends(swarm)[gone] - 1, gone]
            assert (np.linalg.norm(step, axis=1) <= 1.01 * most * rules.world.dt).all()


def test_a_recording_keeps_it_and_one_of_before_is_read(trials, tmp_path):
    recording = trials[0]
    read = Recording.load(recording.save(tmp_path / "new.npz"))
    assert np.array_equal(read.prey.judged, recording.prey.judged, equal_nan=True)
    before = dataclasses.replace(
        recording,
        prey=dataclasses.replace(recording.prey, judged=None),
        predators=dataclasses.replace(recording.predators, judged=None),
    )
    assert Recording.load(before.save(tmp_path / "old.npz")).prey.judged is None
    wrong = dataclasses.replace(recording, prey=dataclasses.replace(recording.prey, judged=np.zeros((1, 2))))
    with pytest.raises(ValueError, match="judged"):
        Recording.load(wrong.save(tmp_path / "wrong.npz"))


def test_films_end_paths_there(trials):
    for recording in trials:
        paths = Trajectories([recording])
        spots = paths.spots(float(recording.ticks) + 1)
        judged = np.concatenate([recording.prey.judged, recording.predators.judged])
        known = np.isfinite(judged[:, 0])
        assert np.allclose(spots[known], judged[known], atol=1e-9)
