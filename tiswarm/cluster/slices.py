"""Slices: how the trials of a study's cells are cut into tasks, and put together again."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.engine.choice import engine_of
from tiswarm.engine.slices import Part, Span
from tiswarm.scenario.model import Scenario
from tiswarm.simd.runtime import LANES
from tiswarm.studies.design import Cell

SHARES = 8
"""Tasks that a worker should have of a study: what it may wait for at the end is then an eighth of its time, at most."""

MOST_TRIALS = 1 << 18
"""Trials of a task: seconds of work, and megabytes that travel back."""


@dataclass(frozen=True)
class Batch:
    """Cells that share a kernel and a seed; company: one scenario for each code that a kernel for all of them holds."""

    cells: Sequence[Cell]
    company: tuple[Scenario, ...]
    counts: tuple[int, int, int]

    @classmethod
    def of(cls, cells: Sequence[Cell]) -> "Batch":
        """Find what the kernel of these cells needs."""
        kinds = {Specialisation.of([cell.scenario], cell.scenario.predators.count).parts: cell.scenario for cell in cells}
        most = [max(getattr(cell.scenario, kind).count for cell in cells) for kind in ("prey", "predators", "obstacles")]
        return cls(cells, tuple(kinds.values()), (most[0], most[1], most[2]))


@dataclass(frozen=True)
class Slice:
    """Spans of trials of some cells of a batch: one task."""

    batch: Batch
    cells: tuple[Cell, ...]
    spans: tuple[Span, ...]

    @property
    def trials(self) -> int:
        """Count the trials."""
        return sum(last - first for first, last in self.spans)


def cut(groups: Sequence[Sequence[Cell]], count: int, workers: int) -> Iterator[Slice]:
    """Cut the trials of all cells, `count` each, into slices of about one size, in their order."""
    total = sum(map(len, groups)) * count
    size = min(math.ceil(total / (SHARES * max(workers, 1))), MOST_TRIALS)
    for group in groups:
        apart = any(engine_of(cell.scenario) == "grid" for cell in group)  # these run one after the other anyway
        for cells in [[cell] for cell in group] if apart else [group]:
            batch = Batch.of(cells)
            step = size if apart else math.ceil(size / LANES) * LANES
            for first in range(0, len(cells) * count, step):
                yield _between(batch, count, first, min(first + step, len(cells) * count))


def _between(batch: Batch, count: int, first: int, last: int) -> Slice:
    """Give the slice of trials first to last - 1, counted through all cells of a batch."""
    held = range(first // count, (last - 1) // count + 1)
    spans = tuple((max(first - k * count, 0), min(last - k * count, count)) for k in held)
    return Slice(batch, tuple(batch.cells[k] for k in held), spans)


class Gathered:
    """The parts of cells that are not whole yet."""

    def __init__(self, count: int) -> None:
        """Begin with nothing. count: trials of a cell."""
        self._count = count
        self._parts: dict[int, dict[int, Part]] = {}

    def put(self, cell: Cell, span: Span, part: Part) -> tuple[Mapping[str, np.ndarray], Mapping[str, np.ndarray]] | None:
        """Add a span; give outcomes and measures of the whole cell, name -> [trial], with its last one."""
        parts = self._parts.setdefault(cell.number, {})
        parts[span[0]] = part
        if sum(len(each[0]["ticks"]) for each in parts.values()) < self._count:
            return None
        ordered = [each for _, each in sorted(self._parts.pop(cell.number).items())]
        outcomes, measures = ({name: np.concatenate([p[k][name] for p in ordered]) for name in ordered[0][k]} for k in (0, 1))
        return outcomes, measures
