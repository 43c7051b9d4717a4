"""Candidates: one scenario with numbers of its own for each of many candidates, all of whom meet the same trials."""

from collections.abc import Mapping, Sequence

import numpy as np

from tiswarm.engine.trials import kernel
from tiswarm.engine.trials.batch import CHUNK, NO_LIMIT, SPREAD, Blocks, check_weights, other_end, refuse_strange, with_numbers
from tiswarm.records.results import Results
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.simd import runtime


class Candidates:
    """The arrays and the kernel for candidates of one scenario, made once for all generations.

    The table has a row for each candidate, not for each trial, so that it stays small; a job is a row and a trial's number,
    from which the kernel draws the trial's luck: candidates that run the same numbers meet the same obstacles and starts.
    """

    def __init__(self, scenario: Scenario, bounds: Mapping[str, tuple[float, float]]) -> None:
        """Check what may differ, and allocate.

        bounds: path -> lowest and highest number that any candidate has.

        Errors: ScenarioError for a path that cannot differ from trial to trial, or a bound that the scenario refuses.
        """
        if scenario.world.neighbours == "grid":
            raise ScenarioError("weights: numbers of single trials need all pairs; set world.neighbours to 'all-pairs'")
        self.scenario = scenario
        self.paths = tuple(bounds)
        counts = None
        if bounds:
            counts = check_weights(scenario, {path: np.array(ends, np.float64) for path, ends in bounds.items()}, 2)
        _check_crossing(scenario, bounds)
        self._settings = runtime.start()
        self._blocks = Blocks([scenario], self._settings.threads, counts, spread=SPREAD)

    def run(
        self, values: np.ndarray, trials: np.ndarray, seed: int, networks: Mapping[str, np.ndarray] | None = None
    ) -> Results:
        """Run the same trials for every candidate.

        values: [candidate, path], in the order of `paths`; trials: [trial], their numbers; networks: prey or predators ->
        [candidate, weight], each candidate's own.
        Gives results of candidates * trials outcomes, all trials of the first candidate first; the numbers that candidates
        have of their own are its `weights`.
        """
        own = dict(zip(self.paths, values.T, strict=True))
        rows, count = len(values), len(values) * len(trials)
        table = self._blocks.layout.table([self.scenario], own or None, networks).astype(self._blocks.dtype)
        jobs = np.stack([np.repeat(np.arange(rows), len(trials)), np.tile(trials, rows)], axis=1).astype(np.int32)
        outcomes, measured = self._blocks.outcomes(count)
        for first in range(0, count, CHUNK):
            here = slice(first, min(first + CHUNK, count))
            queue = np.array([0, here.stop - first], np.int32)
            self._blocks.advance(table, jobs[here], queue, outcomes[here], measured[here], seed, NO_LIMIT)
        numbers = [dict(zip(self.paths, row, strict=True)) for row in values]
        refuse_strange(outcomes, lambda job: (with_numbers(self.scenario, numbers[jobs[job, 0]]), int(jobs[job, 1])), seed)
        told = dict(zip(kernel.OUTCOMES, outcomes.T, strict=True))
        return self.results(values, seed, told, dict(zip(self._blocks.measures, measured.T.astype(np.float64), strict=False)))

    def results(
        self, values: np.ndarray, seed: int, outcomes: Mapping[str, np.ndarray], measures: Mapping[str, np.ndarray]
    ) -> Results:
        """Put outcomes and measures, name -> [candidate * trial], beside the numbers of candidates: [candidate, path]."""
        trials = len(outcomes["ticks"]) // max(len(values), 1)
        weights = {path: np.repeat(each, trials) for path, each in zip(self.paths, values.T, strict=True)}
        return Results.of(self.scenario, seed, self._settings, outcomes, measures, weights)


def _check_crossing(scenario: Scenario, bounds: Mapping[str, Sequence[float]]) -> None:
    """Raise ScenarioError where some candidate's range could run from a larger to a smaller number."""
    numbers = scenario.numbers()
    for path in bounds:
        other = other_end(path)
        if other is not None:
            low, high = sorted((path, other))
            below, above = bounds.get(low, (numbers[low],))[-1], bounds.get(high, (numbers[high],))[0]
            if below > above:
                raise ScenarioError(f"{path}: {low} up to {below:g} can exceed {high} from {above:g}; keep the ranges apart")
