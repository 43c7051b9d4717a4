"""Candidates: those of a tuning run by the workers of a cluster, to the bits of one machine."""

from collections.abc import Iterator, Mapping

import numpy as np

from tiswarm.cluster import worker
from tiswarm.cluster.client import AHEAD, Cluster
from tiswarm.engine.trials.candidates import Candidates
from tiswarm.records.results import Results
from tiswarm.scenario.model import Scenario
from tiswarm.simd import runtime
from tiswarm.simd.runtime import LANES

Part = tuple[slice, slice]
"""Some candidates, and some of their trials."""


class SharedCandidates(Candidates):
    """Candidates whose trials the workers share; what they come to is what they come to here."""

    def __init__(self, cluster: Cluster, scenario: Scenario, bounds: Mapping[str, tuple[float, float]]) -> None:
        """Check as Candidates, and compare the workers' code. Errors: as Candidates; OtherCode."""
        super().__init__(scenario, bounds)
        self._cluster, self._bounds = cluster, dict(bounds)
        self._text = scenario.to_json()
        cluster.compare((self._text,))

    def run(
        self, values: np.ndarray, trials: np.ndarray, seed: int, networks: Mapping[str, np.ndarray] | None = None
    ) -> Results:
        """Run the same trials for every candidate; see Candidates. Errors: as Candidates, and as Cluster.gather."""
        whole: tuple[dict[str, np.ndarray], dict[str, np.ndarray]] = ({}, {})

        def task(part: Part) -> worker.Generation:
            rows, columns = part
            return worker.Generation(
                scenario=self._text,
                hash=self.scenario.hash(),
                bounds=self._bounds,
                values=values[rows],
                trials=trials[columns],
                networks=networks and {side: weights[rows] for side, weights in networks.items()},
                seed=seed,
                precision=runtime.start().precision,
                threads=self._cluster.threads,
                folders=self._cluster.folders,
                identity=worker.identity((), (self._text,)),
            )

        def land(part: Part, came: tuple[Mapping[str, np.ndarray], Mapping[str, np.ndarray]]) -> None:
            for mine, theirs in zip(whole, came, strict=True):
                for name, found in theirs.items():
                    place = mine.setdefault(name, np.empty((len(values), len(trials)), found.dtype))[part]
                    place[...] = found.reshape(place.shape)

        parts = cut(len(values), len(trials), AHEAD * max(self._cluster.workers, 1))
        self._cluster.gather(worker.run_candidates, parts, task, land)
        outcomes, measures = ({name: each.ravel() for name, each in own.items()} for own in whole)
        return self.results(values, seed, outcomes, measures)


def cut(candidates: int, trials: int, parts: int) -> Iterator[Part]:
    """Cut a generation into about so many parts of one size: by candidates, or by trials where candidates are fewer."""
    everybody = slice(None)
    if candidates >= parts:
        step = -(-candidates // parts)
        yield from ((slice(first, first + step), everybody) for first in range(0, candidates, step))
    else:
        step = -(-trials // (parts * LANES)) * LANES
        yield from ((everybody, slice(first, first + step)) for first in range(0, trials, step))
