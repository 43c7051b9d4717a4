"""Slices: any of the trials of any of a batch's scenarios, to the bits that they have in the whole batch."""

from collections.abc import Mapping, Sequence

import numpy as np

from tiswarm.engine.choice import engine_of
from tiswarm.engine.swarms.batch import outcomes as grid_outcomes
from tiswarm.engine.trials import batch, kernel
from tiswarm.scenario.model import Scenario
from tiswarm.simd import runtime

Span = tuple[int, int]
"""Trials of a scenario: the first, and the one behind the last."""

Part = tuple[Mapping[str, np.ndarray], Mapping[str, np.ndarray]]
"""Outcomes and measures of a scenario's span: name -> [trial]."""


def run_spans(
    scenarios: Sequence[Scenario],
    spans: Sequence[Span],
    seed: int,
    company: Sequence[Scenario],
    counts: tuple[int, int, int],
) -> list[Part]:
    """Run a span of trials of each scenario, together.

    company: scenarios whose code the kernel holds, too, though none of their trials runs; counts: most prey, predators and
    obstacles. With those of the whole batch the kernel is the batch's.

    Errors: as simulate_many.
    """
    if any(engine_of(scenario) == "grid" for scenario in scenarios):
        return [
            grid_outcomes(scenario, last - first, seed, lambda _done: None, first)
            for scenario, (first, last) in zip(scenarios, spans, strict=True)
        ]
    batch.check_live(scenarios)
    blocks = batch.Blocks([*scenarios, *company], runtime.start().threads, counts, spread=batch.SPREAD)
    table = blocks.layout.table(list(scenarios)).astype(blocks.dtype)
    places = np.concatenate(
        [np.stack([np.full(last - first, k), np.arange(first, last)], axis=1) for k, (first, last) in enumerate(spans)]
    ).astype(np.int32)
    outcomes, measured = blocks.outcomes(len(places))
    for first in range(0, len(places), batch.CHUNK):
        here = slice(first, min(first + batch.CHUNK, len(places)))
        queue = np.array([0, here.stop - first], np.int32)
        blocks.advance(table, places[here], queue, outcomes[here], measured[here], seed, batch.NO_LIMIT)

        def told(job: int, first: int = first) -> tuple[Scenario, int]:
            which, trial = places[first + job]
            return scenarios[which], int(trial)

        batch.refuse_strange(outcomes[here], told, seed)
    ends = np.cumsum([last - first for first, last in spans])[:-1]
    return [
        (
            dict(zip(kernel.OUTCOMES, np.ascontiguousarray(own.T), strict=True)),
            dict(zip(blocks.measures, values.T.astype(np.float64), strict=False)),
        )
        for own, values in zip(np.split(outcomes, ends), np.split(measured, ends), strict=True)
    ]
