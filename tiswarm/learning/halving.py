"""Halving: a generation's trials for candidates of whom the worse half leaves twice, so that hopeless ones cost little."""

from collections.abc import Callable

import numpy as np

PARTS = 4
"""The first rung is a quarter of the trials, the second a half."""


def rungs(trials: int) -> tuple[int, ...]:
    """List how many trials candidates have met at the end of each rung (Karnin, Koren, Somekh 2013)."""
    return trials // PARTS, trials // 2, trials


def survivors(candidates: int, rung: int) -> int:
    """Count who runs on a rung."""
    return -(-candidates // 2**rung)


def cost(candidates: int, ends: tuple[int, ...]) -> int:
    """Count the trials of a generation."""
    return sum(survivors(candidates, k) * (end - begin) for k, (begin, end) in enumerate(zip((0, *ends), ends, strict=False)))


def run(
    outcomes_of: Callable[[np.ndarray, np.ndarray], np.ndarray],
    scores_of: Callable[[np.ndarray], np.ndarray],
    values: np.ndarray,
    trials: np.ndarray,
    ends: tuple[int, ...],
) -> tuple[np.ndarray, np.ndarray]:
    """Run candidates through the rungs; give their scores on what they met, and how many trials that was: [candidate] each.

    outcomes_of: values, [candidate, coordinate], and trials, [trial], to outcomes, [scenario, candidate, trial]; scores_of:
    outcomes to scores, those that are NaN left out.
    """
    here = np.arange(len(values))
    met = np.zeros(len(values), np.int64)
    scores = np.zeros(len(values))
    seen = np.zeros((0, 0, 0))
    for k, (begin, end) in enumerate(zip((0, *ends), ends, strict=False)):
        if k:
            kept = np.sort(np.argsort(-scores[here], kind="stable")[: survivors(len(values), k)])
            here, seen = here[kept], seen[:, kept]
        new = outcomes_of(values[here], trials[begin:end])
        seen = np.concatenate([seen, new], axis=2) if k else new
        met[here] = end
        scores[here] = scores_of(seen)
    return scores, met


def standing(scores: np.ndarray, met: np.ndarray) -> np.ndarray:
    """Give what candidates are ranked by: [candidate], scores where all met the same trials, else whoever ran longer first."""
    if len(set(met.tolist())) == 1:
        return scores
    ranks = np.empty(len(scores))
    ranks[np.lexsort((-np.arange(len(scores)), scores, met))] = np.arange(len(scores))
    return ranks
