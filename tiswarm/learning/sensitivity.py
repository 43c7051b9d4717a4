"""Sensitivity: how much each number that was found matters, one moved at a time."""

from dataclasses import dataclass

import numpy as np

from tiswarm.learning.keys import Range
from tiswarm.learning.objective import Evaluation, check_trials
from tiswarm.learning.tuned import Tuned
from tiswarm.records.results import Estimate

POINTS = 9
"""Numbers that each range is looked at, its ends among them."""

TRIALS = 1000


@dataclass(frozen=True)
class Sensitivity:
    """One range: numbers, [point], the objective there, and the number that was found."""

    range: Range
    values: np.ndarray
    estimates: list[Estimate]
    found: float


def sensitivities(tuned: Tuned, trials: int = TRIALS) -> list[Sensitivity]:
    """Move each number over its range while the others stay as found, on trials of the checks, scenarios joined by mean."""
    if not tuned.improved:
        return []
    arm = next(each.arm for each in tuned.history if each.arm_number == tuned.best.arm)
    if not arm.ranges:
        return []
    world = Evaluation(arm, tuned.objective, tuned.across, tuned.seed)
    found = []
    for k, each in enumerate(arm.ranges):
        points = np.unique(each.value(np.linspace(0, 1, POINTS)))
        values = np.tile(tuned.best.values, (len(points), 1))
        values[:, k] = points
        outcomes = world.outcomes(values, check_trials(trials)).mean(axis=0)
        found.append(Sensitivity(each, points, [Estimate.of(one) for one in outcomes], float(tuned.best.values[k])))
    return found
