"""Games whose solution is known by hand, and rules that every solution keeps."""

import numpy as np
import pytest

from tiswarm.studies.zero_sum import best_responses, bootstrap, dominated, solve

pytestmark = pytest.mark.quick


def test_matching_pennies():
    found = solve(np.array([[1.0, -1], [-1, 1]]))
    assert found.value == pytest.approx(0)
    assert found.rows == pytest.approx([0.5, 0.5])
    assert found.columns == pytest.approx([0.5, 0.5])


def test_rock_paper_scissors_where_paper_pays_double():
    """Rock against scissors 1, paper against rock 2, scissors against paper 1: mixtures 1/4, 1/4, 1/2 by hand."""
    found = solve(np.array([[0.0, -2, 1], [2, 0, -1], [-1, 1, 0]]))
    assert found.value == pytest.approx(0, abs=1e-9)
    assert found.rows == pytest.approx([0.25, 0.25, 0.5])
    assert found.columns == pytest.approx([0.25, 0.25, 0.5])


def test_a_saddle_point_is_played_purely():
    payoff = np.array([[3.0, 1, 4], [5, 2, 6], [0, -1, 9]])
    found = solve(payoff)
    assert found.value == pytest.approx(2)
    assert found.rows == pytest.approx([0, 1, 0])
    assert found.columns == pytest.approx([0, 1, 0])


def test_a_two_by_two_game_by_its_formula():
    a, b, c, d = 0.8, 0.5, 0.3, 0.6
    found = solve(np.array([[a, b], [c, d]]))
    both = a - b - c + d
    assert found.value == pytest.approx((a * d - b * c) / both)
    assert found.rows[0] == pytest.approx((d - c) / both)
    assert found.columns[0] == pytest.approx((d - b) / both)


def test_neither_side_can_gain_by_another_answer():
    rng = np.random.default_rng(0)
    for shape in ((1, 1), (1, 4), (5, 1), (7, 3), (42, 3), (6, 9)):
        payoff = rng.normal(size=shape)
        found = solve(payoff)
        assert (found.rows @ payoff).min() == pytest.approx(found.value, abs=1e-7)
        assert (payoff @ found.columns).max() == pytest.approx(found.value, abs=1e-7)
        assert found.rows.sum() == pytest.approx(1)
        assert found.columns.min() >= 0


def test_best_responses_are_marked_on_both_sides():
    ours, theirs = best_responses(np.array([[3.0, 1], [2, 4]]))
    assert ours.tolist() == [[True, False], [False, True]]
    assert theirs.tolist() == [[False, True], [True, False]]


def test_dominated_by_one_row_or_by_a_mixture():
    single = dominated(np.array([[1.0, 2], [2, 3], [2, 3]]))
    assert single[0] is not None
    assert single[0].max() == 1
    assert single[1] is None  # as good is not better
    mixed = dominated(np.array([[4.0, 0], [0, 4], [1, 1]]))
    assert mixed[2] == pytest.approx([0.5, 0.5, 0])
    assert mixed[0] is None
    assert dominated(np.array([[1.0, 2]])) == [None]


def test_bootstrap_intervals_lie_around_the_solution_and_repeat():
    rng = np.random.default_rng(5)
    luck = rng.normal(0, 0.2, 2000)
    trials = [[mean + luck + rng.normal(0, 0.1, 2000) for mean in row] for row in ((0.8, 0.5), (0.3, 0.6))]
    spread = bootstrap(trials, paired=True, resamples=200)
    assert spread.value[0] < solve(np.array([[each.mean() for each in row] for row in trials])).value < spread.value[1]
    assert (spread.rows[:, 0] <= spread.rows[:, 1]).all()
    assert bootstrap(trials, paired=True, resamples=200).value == spread.value
    assert spread.best[0, 0] == 1.0
    alone = bootstrap(trials, paired=False, resamples=200)
    gap = np.diff(spread.columns[0])[0]
    assert gap < np.diff(alone.columns[0])[0]  # shared luck cancels in who does better
