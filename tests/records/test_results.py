"""Results: estimates, files, and paired comparisons."""

import csv
import json
import math

import numpy as np
import pytest

import tiswarm
from tiswarm.records.results import COLUMNS

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def results():
    return tiswarm.simulate(tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive"}), 400, seed=5)


def test_success_time_and_impact_spread_follow_from_the_counts(results):
    np.testing.assert_allclose(results.success, results.arrived / 6)
    np.testing.assert_array_equal(results.time, results.ticks)
    spread = np.where(results.arrived >= 2, results.last_arrival - results.first_arrival, 0)
    np.testing.assert_array_equal(results.impact_spread, spread)
    assert (results.impact_spread[results.arrived < 2] == 0).all()


def test_time_counts_in_seconds():
    scenario = tiswarm.load("delft/avoidance-10", {"world.dt": 0.5})
    results = tiswarm.simulate(scenario, 10)
    np.testing.assert_allclose(results.time, results.ticks * 0.5)


def test_an_estimate_is_mean_standard_error_and_interval():
    estimate = tiswarm.Estimate.of(np.array([1.0, 2, 3, 4]))
    stderr = math.sqrt(5 / 3) / 2
    assert estimate.mean == 2.5
    assert estimate.stderr == pytest.approx(stderr)
    assert (estimate.low, estimate.high) == pytest.approx((2.5 - 1.959964 * stderr, 2.5 + 1.959964 * stderr), rel=1e-6)


def test_the_interval_covers_the_mean_of_many_more_trials(results):
    many = tiswarm.simulate(results.scenario, 20_000, seed=99).summary()
    for name, estimate in results.summary().items():
        assert abs(estimate.mean - many[name].mean) <= 4 * math.hypot(estimate.stderr, many[name].stderr), name


def test_files_hold_every_trial_the_summary_and_the_manifest(results, tmp_path):
    results.save(tmp_path / "run")
    rows = list(csv.DictReader((tmp_path / "run" / "trials.csv").open()))
    assert tuple(rows[0]) == COLUMNS
    assert len(rows) == 400
    assert [int(row["trial"]) for row in rows] == list(range(400))
    assert sum(int(row["arrived"]) for row in rows) == results.arrived.sum()
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["summary"]["success"]["mean"] == pytest.approx(results.success.mean())
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    assert manifest["scenario_hash"] == results.scenario.hash()
    assert {"tiswarm", "taichi", "precision", "machine", "seed", "trials"} <= set(manifest)
    assert sorted(file.name for file in (tmp_path / "run").iterdir()) == ["manifest.json", "summary.json", "trials.csv"]


def test_numbers_of_single_trials_are_written_beside_them(tmp_path):
    evade = np.linspace(0, 0.02, 5)
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive"})
    results = tiswarm.simulate(scenario, 5, weights={"prey.weights.evade": evade})
    rows = list(csv.DictReader(results.to_csv().splitlines()))
    assert [float(row["prey.weights.evade"]) for row in rows] == evade.tolist()


def test_one_trial_has_no_standard_error_and_still_valid_json():
    results = tiswarm.simulate(tiswarm.load("delft/avoidance-10"), 1)
    assert json.loads(results.summary_json())["summary"]["success"]["stderr"] is None


def test_pairs_with_one_seed_give_a_narrower_interval_than_independent_runs():
    """Common random numbers: the README says by how much."""
    base = tiswarm.load("delft/avoidance-10")
    a = tiswarm.simulate(base, 4000, seed=1)
    b = tiswarm.simulate(base.replaced({"prey.avoidance": "directed-spiral", "prey.weights": {}}), 4000, seed=1)
    paired = tiswarm.compare(a, b)["success"]
    independent = math.hypot(a.summary()["success"].stderr, b.summary()["success"].stderr)
    assert paired.mean == pytest.approx(b.success.mean() - a.success.mean())
    assert paired.stderr < 0.95 * independent


def test_runs_that_are_no_pairs_are_refused(results):
    other = tiswarm.simulate(results.scenario, 400, seed=6)
    with pytest.raises(ValueError, match="cannot be paired"):
        tiswarm.compare(results, other)
