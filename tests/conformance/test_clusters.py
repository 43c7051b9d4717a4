"""Clustering predators against 300 trials by the rule of the thesis's simulator (fits.py), in the same worlds."""

import sys
from pathlib import Path

import numpy as np
import pytest

import tiswarm

sys.path.insert(0, str(Path(__file__).parent))
import fits


def _z(labels, prey):
    """Give the differences of success and time to the file's, trial by trial, in standard errors."""
    arrived, ticks = np.load(fits.FILE)[prey].T
    assert len(ticks) == 300
    scenario = tiswarm.load("delft/cluster-10", {"prey.strategy": prey, "predators.weights.labels": labels})
    ours = tiswarm.simulate(scenario, len(ticks))
    differences = np.stack([ours.arrived - arrived, ours.ticks - ticks])
    return differences.mean(axis=1) / (differences.std(axis=1, ddof=1) / np.sqrt(len(ticks)))


@pytest.mark.parametrize("prey", fits.PREY)
def test_success_and_time_are_those_of_fits_by_every_predator(prey, f64):
    assert np.abs(_z("redrawn", prey)).max() < 3


def test_kept_labels_are_another_rule(f64):
    success, _ = _z("kept", "explode")
    assert success < -5


@pytest.mark.anew
def test_the_trials_of_the_file_are_what_its_script_gives():
    assert fits.trials("jump", [17]).tolist() == np.load(fits.FILE)["jump"][[17]].tolist()


def test_fits_are_those_of_scikit_learn(f64):
    """A single prey apart from a pair is the first centre as often in both, and the inertia is the same."""
    from sklearn.cluster import KMeans

    points = np.array([[0.0, 0], [1, 0], [9, 2]])
    random = np.random.RandomState(0)
    theirs = [KMeans(2, n_init=10, random_state=random).fit(points) for _ in range(200)]
    inertia, label = fits.fit(points, 2, 2000, np.random.default_rng(0))
    np.testing.assert_allclose(inertia, theirs[0].inertia_)
    assert abs(np.mean([fit.labels_[2] for fit in theirs]) - label[:, 2].mean()) < 3 * 0.48 / np.sqrt(200)
