"""Objectives: sums of measures, candidates that meet the same trials, and numbers of trials that never mix."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.trials.candidates import Candidates
from tiswarm.learning import objective
from tiswarm.learning.keys import arms
from tiswarm.learning.objective import Evaluation, Objective, Term, scores_of

TUNED = {"prey.strategy": "evasive", "prey.avoidance": "kitchen-sink"}


@pytest.mark.parametrize(
    ("text", "terms"),
    [
        ("success", [Term(1, "success")]),
        ("-captured", [Term(-1, "captured")]),
        ("success - 0.001 time", [Term(1, "success"), Term(-0.001, "time")]),
        ("2*success + 1e-3*time-to-50 -crashed", [Term(2, "success"), Term(1e-3, "time-to-50"), Term(-1, "crashed")]),
        ("-|nearest - 4| + success", [Term(-1, "nearest", 4), Term(1, "success")]),
        (" 0.5 |time-to-50 - .5|", [Term(0.5, "time-to-50", 0.5)]),
    ],
)
def test_sums_are_read_and_written(text, terms):
    read = Objective.read(text)
    assert list(read.terms) == terms
    assert Objective.read(str(read)) == read


@pytest.mark.parametrize(
    "text", ["", " ", "success -", "3", "success time", "Success!", "|nearest|", "|nearest - 4", "success-"]
)
def test_what_is_no_sum_is_refused(text):
    with pytest.raises(tiswarm.ScenarioError, match="write measures"):
        Objective.read(text)


def test_a_measure_that_the_scenario_lacks_is_refused_with_the_mend():
    scenario = tiswarm.load("delft/pronav-10")
    with pytest.raises(tiswarm.ScenarioError, match="did you mean 'success'"):
        Objective.read("succes").check(scenario)
    with pytest.raises(tiswarm.ScenarioError, match=r"measures\.names"):
        Objective.read("polarisation").check(scenario)
    Objective.read("polarisation").check(scenario.replaced({"measures.names": ["polarisation"]}))


def test_the_objective_of_a_batch_is_the_sum_of_its_measures(f32):
    results = tiswarm.simulate(tiswarm.load("delft/pronav-10", TUNED), 40, 1)
    found = Objective.read("success - 0.001 time + 0.5 crashed").of(results)
    np.testing.assert_allclose(found, results.success - 0.001 * results.time + 0.5 * results.crashed, rtol=1e-12)


@pytest.mark.parametrize("counted", [False, True])
def test_a_candidate_gets_the_bits_of_its_scenario_on_its_own(precision, counted):
    scenario = tiswarm.load("delft/pronav-10", TUNED)
    bounds = {"prey.weights.evade": (0.0, 0.1), "prey.goal": (0.0, 1.0)} | ({"prey.count": (1, 9)} if counted else {})
    values = np.array([[0.01, 0.1], [0.05, 0.3], [0.0, 0.9]])
    values = np.hstack([values, [[6.0], [9.0], [1.0]]]) if counted else values
    results = Candidates(scenario, bounds).run(values, np.arange(3, 24), seed=7)
    for k, row in enumerate(values):
        own = {p: int(v) if p.endswith("count") else float(v) for p, v in zip(bounds, row, strict=True)}
        alone = tiswarm.simulate(scenario.replaced(own), 24, 7)
        for name in ("success", "ticks", "captured", "crashed", "last_arrival"):
            np.testing.assert_array_equal(results.measure(name).reshape(3, 21)[k], alone.measure(name)[3:])


def test_candidates_beyond_one_launch_get_the_same_bits(f32, monkeypatch):
    scenario = tiswarm.load("delft/pronav-10", {**TUNED, "world.ticks": 90})
    crowd = Candidates(scenario, {"prey.goal": (0.0, 1.0)})
    values = np.linspace(0, 1, 7)[:, None]
    whole = crowd.run(values, np.arange(10), 0).success
    monkeypatch.setattr("tiswarm.engine.trials.candidates.CHUNK", 16)
    np.testing.assert_array_equal(crowd.run(values, np.arange(10), 0).success, whole)


def test_ranges_that_could_cross_are_refused(f32):
    scenario = tiswarm.load("delft/pronav-10")
    with pytest.raises(tiswarm.ScenarioError, match="can exceed"):
        Candidates(scenario, {"obstacles.radius.0": (0.5, 1.8), "obstacles.radius.1": (1.5, 3.0)})
    with pytest.raises(tiswarm.ScenarioError, match="is above"):
        Candidates(scenario, {"obstacles.radius.0": (0.5, 2.5)})
    Candidates(scenario, {"obstacles.radius.0": (0.5, 1.5), "obstacles.radius.1": (1.5, 3.0)})


def test_what_is_the_same_for_all_trials_cannot_be_searched(f32):
    with pytest.raises(tiswarm.ScenarioError, match="the same for all trials"):
        Candidates(tiswarm.load("delft/pronav-10"), {"coverage.cell": (0.5, 1.0)})
    with pytest.raises(tiswarm.ScenarioError, match=r"prey\.perception"):
        Candidates(tiswarm.load("delft/pronav-10"), {"prey.perception": (-1.0, 5.0)})


def test_scores_join_scenarios_by_mean_or_worst_and_rank_those_without_a_value_last():
    outcomes = np.array([[[1.0, 3.0], [np.nan, 4.0]], [[5.0, 5.0], [np.nan, np.nan]]])
    assert scores_of(outcomes, "mean").tolist() == [3.5, -np.inf]
    assert scores_of(outcomes, "worst").tolist() == [2.0, -np.inf]
    assert scores_of(outcomes[:1], "mean").tolist() == [2.0, 4.0]


def test_several_scenarios_are_counted_each(f32):
    scenarios = [tiswarm.load(name, {**TUNED, "world.ticks": 80}) for name in ("delft/pronav-10", "delft/centre-10")]
    arm = arms(scenarios, {"prey.goal": (0.0, 1.0)})[0]
    found = Evaluation(arm, Objective.read("time"), "worst", 0).outcomes(np.array([[0.1], [0.9]]), np.arange(6))
    assert found.shape == (2, 2, 6)
    for each, scenario in zip(found, scenarios, strict=True):
        alone = tiswarm.simulate(scenario.replaced({"prey.goal": 0.9}), 6, 0).time
        np.testing.assert_array_equal(each[1], alone)


def test_no_trial_is_of_two_kinds():
    validation = np.arange(objective.MOST_VALIDATION)
    checks = objective.check_trials(objective.SEARCH_FIRST - objective.CHECK_FIRST)
    generations = [objective.search_trials(g, 200) for g in range(50)]
    assert validation[-1] < checks[0]
    assert checks[-1] < generations[0][0]
    assert len(np.unique(np.concatenate(generations))) == 50 * 200
    with pytest.raises(tiswarm.ScenarioError, match="smaller budget"):
        objective.check_numbers(20_000_000, 200, 100, 100)
    with pytest.raises(tiswarm.ScenarioError, match="validation of 1 trials"):
        objective.check_numbers(1, 200, 100, 1)
