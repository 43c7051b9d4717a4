"""Objective: what a tuning makes large, of one scenario or over several, and the trials that show it."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from tiswarm.engine.trials.candidates import Candidates
from tiswarm.learning.keys import Arm
from tiswarm.records.results import Results
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.measures import COUNTED
from tiswarm.scenario.model import Scenario
from tiswarm.system.words import did_you_mean

Across = Literal["mean", "worst"]

MOST_VALIDATION = 1 << 20
CHECK_FIRST = 1 << 20
SEARCH_FIRST = 1 << 24
"""Numbers of trials: validation has those from 0, as `tiswarm run` has; the checks that choose among generations those from
CHECK_FIRST; the search those from SEARCH_FIRST, each generation new ones. No number is of two kinds."""

LAST_TRIAL = 2**31 - 1

_NUMBER = r"(?:\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+)"
_NAME = r"[a-z](?:[a-z0-9_]|-(?=[a-z0-9]))*"
_TERM = re.compile(rf"\s*([+-]?)\s*(?:({_NUMBER})\s*\*?\s*)?(?:({_NAME})|\|\s*({_NAME})\s+-\s+({_NUMBER})\s*\|)(?=\s|$)")


@dataclass(frozen=True)
class Term:
    """One part of an objective: factor times a measure, or times how far that is from an aim."""

    factor: float
    measure: str
    aim: float | None = None

    def of(self, results: Results) -> np.ndarray:
        """Give the part: [trial], NaN where the measure has no value."""
        values = results.measure(self.measure)
        return self.factor * (values if self.aim is None else np.abs(values - self.aim))

    def __str__(self) -> str:
        """Write the part without its sign."""
        factor = "" if abs(self.factor) == 1 else f"{abs(self.factor):g} "
        return factor + (self.measure if self.aim is None else f"|{self.measure} - {self.aim:g}|")


@dataclass(frozen=True)
class Objective:
    """A weighted sum of measures, made large."""

    terms: tuple[Term, ...]

    @classmethod
    def read(cls, text: str) -> "Objective":
        """Read "success", "-captured", "success - 0.001 time" or "-|nearest - 4|". Errors: ScenarioError."""
        terms: list[Term] = []
        place = 0
        while place < len(text.rstrip()):
            match = _TERM.match(text, place)
            if match is None or (terms and not match[1]):
                break
            sign, factor, name, near, aim = match.groups()
            value = float(factor or 1) * (-1 if sign == "-" else 1)
            terms.append(Term(value, name or near, None if aim is None else float(aim)))
            place = match.end()
        if not terms or text[place:].strip():
            raise ScenarioError(
                f"objective '{text}': write measures with signs and factors, as in 'success - 0.001 time' or '-|nearest - 4|'"
            )
        return cls(tuple(terms))

    def __str__(self) -> str:
        """Write the sum as it is read."""
        first, *others = self.terms
        words = [f"{'-' if first.factor < 0 else ''}{first}"]
        return " ".join([*words, *(f"{'-' if each.factor < 0 else '+'} {each}" for each in others)])

    def check(self, scenario: Scenario) -> None:
        """Raise ScenarioError for a measure that the scenario does not have."""
        known = [*COUNTED, *scenario.measures.names]
        for name in (each.measure for each in self.terms):
            if name not in known:
                hint = f"{did_you_mean(name, known)}; others need --set 'measures.names=[\"{name}\"]'"
                raise ScenarioError(f"objective: no measure '{name}' in {scenario.preset or scenario.title}; {hint}")

    def of(self, results: Results) -> np.ndarray:
        """Give the sum: [trial], NaN where a measure has no value."""
        return np.asarray(np.sum([each.of(results) for each in self.terms], axis=0))


World = Callable[[Scenario, Mapping[str, tuple[float, float]]], Candidates]
"""Makes what runs a scenario's candidates of it and the bounds of their numbers."""


class Evaluation:
    """One arm's candidates run through trials, in all its scenarios."""

    def __init__(
        self,
        arm: Arm,
        objective: Objective,
        across: Across,
        seed: int,
        shares: np.ndarray | None = None,
        world: World = Candidates,
    ) -> None:
        """Check, and allocate. shares: [scenario], how much each counts in the mean; world: what runs a scenario's candidates.

        Errors: ScenarioError; as `world`.
        """
        for scenario in arm.scenarios:
            objective.check(scenario)
        bounds = {each.path: (each.low, each.high) for each in arm.ranges}
        self.arm = arm
        self._objective = objective
        self._across: Across = across
        self.shares = shares
        self._seed = seed
        self._worlds = [world(scenario, bounds) for scenario in arm.scenarios]

    def outcomes(self, values: np.ndarray, trials: np.ndarray) -> np.ndarray:
        """Give the objective: [scenario, candidate, trial]. values: [candidate, coordinate]; trials: [trial], their numbers."""
        shape = (len(values), len(trials))
        numbers, weights = np.split(values, [len(self.arm.ranges)], axis=1)
        networks = {self.arm.side: weights} if self.arm.side else None
        results = [world.run(numbers, trials, self._seed, networks) for world in self._worlds]
        return np.stack([self._objective.of(each).reshape(shape) for each in results])

    def joined(self, outcomes: np.ndarray) -> np.ndarray:
        """Give what candidates are ranked by: [candidate], -inf for one without a value in some scenario."""
        return scores_of(outcomes, self._across, self.shares)


def scores_of(outcomes: np.ndarray, across: Across, shares: np.ndarray | None = None) -> np.ndarray:
    """Join trials by their mean, scenarios by mean or worst: [scenario, candidate, trial] to [candidate].

    shares: [scenario], how much each counts in the mean, all alike when None.
    Trials without a value are left out; a candidate without any is ranked last.
    """
    there = np.isfinite(outcomes)
    count = there.sum(axis=2)
    with np.errstate(invalid="ignore", divide="ignore"):
        means = np.where(there, outcomes, 0.0).sum(axis=2) / count
    means = np.where(count > 0, means, -np.inf)
    return np.asarray(np.average(means, axis=0, weights=shares) if across == "mean" else means.min(axis=0))


def search_trials(generation: int, count: int) -> np.ndarray:
    """Give the numbers of a generation's trials, new ones for each."""
    first = SEARCH_FIRST + generation * count
    return np.arange(first, first + count)


def check_trials(count: int) -> np.ndarray:
    """Give the numbers of the trials that choose among generations."""
    return np.arange(CHECK_FIRST, CHECK_FIRST + count)


def check_numbers(generations: int, trials: int, checks: int, validation: int) -> None:
    """Raise ScenarioError where numbers of trials run out or into each other."""
    if generations * trials > LAST_TRIAL - SEARCH_FIRST:
        raise ScenarioError(f"tune: {generations} generations of {trials} trials are more than there are; use a smaller budget")
    for name, count, most in (("checks", checks, SEARCH_FIRST - CHECK_FIRST), ("validation", validation, MOST_VALIDATION)):
        if not 2 <= count <= most:
            raise ScenarioError(f"tune: {name} of {count} trials are not possible; use 2 to {most:,}")
