"""Intervals: against scipy, against hand-worked cases, and against how often they cover."""

import numpy as np
import pytest
from scipy import stats

from tiswarm.studies.statistics import correlation, holm_corrected, paired_tests, share_estimate, wilson

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(("hits", "n"), [(0, 5), (3, 10), (50, 50), (731, 1000)])
def test_wilson_is_scipys_for_whole_counts(hits, n):
    theirs = stats.binomtest(hits, n).proportion_ci(method="wilson")
    assert wilson(hits / n, n) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_a_trial_of_one_agent_gives_the_plain_wilson_interval():
    values = np.array([1.0] * 30 + [0.0] * 10)
    each = share_estimate(values, np.ones(40))
    assert (each.low, each.high) == pytest.approx(wilson(0.75, 40))


def test_agents_that_share_a_fate_count_once_and_independent_ones_six_times():
    rng = np.random.default_rng(1)
    together = np.repeat(rng.random(4000) < 0.3, 6).reshape(4000, 6).mean(axis=1)
    alone = (rng.random((4000, 6)) < 0.3).mean(axis=1)
    six = np.full(4000, 6)
    assert (share_estimate(together, six).low, share_estimate(together, six).high) == pytest.approx(
        wilson(together.mean(), 4000)
    )
    ends = share_estimate(alone, six)
    assert ends.high - ends.low == pytest.approx(np.diff(wilson(alone.mean(), 24_000))[0], rel=0.05)


def test_where_all_arrive_the_interval_does_not_vanish():
    each = share_estimate(np.ones(100), np.full(100, 6))
    assert (each.low, each.high) == pytest.approx(wilson(1.0, 100))
    assert each.low < 0.97


@pytest.mark.parametrize("mean", [0.03, 0.5, 0.9])
def test_the_interval_of_clustered_shares_covers_in_nineteen_of_twenty_cases(mean):
    rng = np.random.default_rng(2)
    luck = rng.beta(2 * mean, 2 * (1 - mean), (2000, 120))  # each trial has its own chance: correlation 1/3 within it
    shares = rng.binomial(6, luck) / 6
    ends = [share_estimate(values, np.full(120, 6)) for values in shares]
    covered = np.mean([each.low <= mean <= each.high for each in ends])
    assert 0.93 <= covered <= 0.97


def test_holm_by_hand():
    assert holm_corrected([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm_corrected([0.6, 0.9]) == [1.0, 1.0]
    assert holm_corrected([]) == []


def test_paired_tests_are_scipys_and_know_batches_that_never_differ():
    rng = np.random.default_rng(3)
    first = rng.integers(0, 7, 50) / 8
    others = [first + rng.normal(0.1, 0.2, 50), first.copy(), first + 1.0]
    found = paired_tests(first, others)
    assert found[0].p == pytest.approx(stats.ttest_rel(others[0], first).pvalue)
    assert found[0].p_holm == pytest.approx(min(2 * found[0].p, 1))
    assert found[0].difference.mean == pytest.approx((others[0] - first).mean())
    assert (found[1].p, found[1].p_holm) == (1.0, 1.0)
    assert found[2].p < 1e-12


def test_correlations_are_scipys_with_intervals_around_them():
    rng = np.random.default_rng(4)
    x = rng.random(60)
    y = x**3 + rng.normal(0, 0.1, 60)
    found = correlation("x", "y", x, y)
    r = stats.pearsonr(x, y)
    assert found.pearson == pytest.approx((r.statistic, *r.confidence_interval()))
    assert found.spearman[0] == pytest.approx(stats.spearmanr(x, y).statistic)
    assert found.spearman[1] < found.spearman[0] < found.spearman[2]
    assert correlation("x", "y", x, y) == found
    with pytest.raises(ValueError, match="differ"):
        correlation("x", "y", x, np.ones(60))
