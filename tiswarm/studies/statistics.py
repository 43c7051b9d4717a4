"""Statistics: what a study's trials allow to say, with 95 % intervals, paired tests and correlations."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tiswarm.records.results import Z95, Estimate

RESAMPLES = 9999
"""Bootstrap resamples of a rank correlation."""


def share_estimate(values: np.ndarray, agents: np.ndarray) -> Estimate:
    """Estimate a share pooled over trials, with Wilson's interval at the effective number of independent agents.

    values: [trial], the share of a trial's agents; agents: [trial], how many these are.

    Agents of one trial share its luck, so that they count for fewer than they are: their number is divided by the design
    effect, the variance of the mean between trials over that of as many independent agents (Kish 1965), which is taken to
    lie between 1 and the agents of a trial. Where no trial differs from another (all arrive, or none), a trial counts once.
    Trials without a value (NaN) are left out.
    """
    there = np.isfinite(values)
    values, agents = values[there], agents[there]
    plain = Estimate.of(values)
    trials, mean = len(values), plain.mean
    if trials == 0:
        return plain
    pooled = float(np.sum(agents))
    alone = mean * (1 - mean) / pooled
    between = plain.stderr**2 if trials > 1 else math.nan
    effect = between / alone if alone > 0 and between > 0 else math.inf
    low, high = wilson(mean, pooled / min(max(effect, 1.0), pooled / trials))
    return Estimate(mean, plain.stderr, low, high)


def wilson(share: float, count: float) -> tuple[float, float]:
    """Give Wilson's score interval of a share among `count` independent ones, which need not be a whole number."""
    z2 = Z95**2 / count
    centre = (share + z2 / 2) / (1 + z2)
    away = Z95 * math.sqrt(share * (1 - share) / count + z2 / (4 * count)) / (1 + z2)
    return max(0.0, min(share, centre - away)), min(1.0, max(share, centre + away))


@dataclass(frozen=True)
class Paired:
    """A mean difference between trials of the same number, its p, and p after Holm's correction for the others beside it."""

    difference: Estimate
    p: float
    p_holm: float


def paired_tests(first: np.ndarray, others: Sequence[np.ndarray]) -> list[Paired]:
    """Test each of several batches against one whose trials met the same luck: paired t-tests, corrected by Holm.

    first, others: [trial]. A batch that differs nowhere has p = 1; a single pair cannot be tested (NaN). Pairs of which one has
    no value (NaN) are left out.
    """
    away = [(other - first)[np.isfinite(other - first)] for other in others]
    p = [_paired_p(each) for each in away]
    return [Paired(Estimate.of(a), each, holm) for a, each, holm in zip(away, p, holm_corrected(p), strict=True)]


def _paired_p(differences: np.ndarray) -> float:
    from scipy.stats import ttest_1samp

    if len(differences) < 2:
        return math.nan
    if np.ptp(differences) == 0:
        return 0.0 if differences[0] else 1.0
    return float(ttest_1samp(differences, 0.0).pvalue)


def holm_corrected(p: Sequence[float]) -> list[float]:
    """Correct p-values for there being several (Holm 1979): the k-th smallest of n counts n - k + 1 times."""
    order = np.argsort(p, kind="stable")
    times = np.asarray(p, np.float64)[order] * np.arange(len(p), 0, -1)
    corrected = np.empty(len(p))
    corrected[order] = np.minimum(np.maximum.accumulate(times), 1.0)
    return [float(each) for each in corrected]


@dataclass(frozen=True)
class Correlation:
    """Pearson's r with Fisher's interval and Spearman's rho with a bootstrap one, both 95 %, over n cells."""

    x: str
    y: str
    n: int
    pearson: tuple[float, float, float]  # value, low, high
    spearman: tuple[float, float, float]


def correlation(x_name: str, y_name: str, x: np.ndarray, y: np.ndarray) -> Correlation:
    """Correlate the means of cells: x, y: [cell]. Errors: ValueError for fewer than four cells, or values all alike."""
    from scipy import stats

    if len(x) < 4 or np.ptp(x) == 0 or np.ptp(y) == 0:
        raise ValueError(f"correlate: {x_name} and {y_name} need four cells or more, and values that differ")
    linear = stats.pearsonr(x, y)
    fisher = linear.confidence_interval(0.95)

    def rho(a: np.ndarray, b: np.ndarray, axis: int = -1) -> np.ndarray:
        a, b = (stats.rankdata(each, axis=axis) for each in (a, b))
        a, b = (each - each.mean(axis=axis, keepdims=True) for each in (a, b))
        with np.errstate(invalid="ignore"):  # a resample that is all one cell
            return np.sum(a * b, axis=axis) / np.sqrt(np.sum(a * a, axis=axis) * np.sum(b * b, axis=axis))

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)  # a resample of one cell many times has no rho
        drawn = stats.bootstrap(
            (x, y), rho, paired=True, vectorized=True, n_resamples=RESAMPLES, method="percentile", rng=np.random.default_rng(0)
        )
    low, high = np.nanpercentile(drawn.bootstrap_distribution, [2.5, 97.5])
    return Correlation(
        x_name,
        y_name,
        len(x),
        (float(linear.statistic), float(fisher.low), float(fisher.high)),
        (float(rho(x, y)), float(low), float(high)),
    )
