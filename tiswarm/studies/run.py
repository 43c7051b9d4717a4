"""Run: run the cells of a design, batch by batch, each kept as soon as it is finished."""

import os
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.engine.run import simulate_many
from tiswarm.engine.trials.batch import Progress
from tiswarm.records.results import Results
from tiswarm.scenario.model import Scenario
from tiswarm.simd import runtime
from tiswarm.studies.design import Cell, Figure, Published, cells, find_study, load_study, published_means
from tiswarm.studies.report import OUTCOMES, Report, Row
from tiswarm.studies.store import Ledger
from tiswarm.system.owner import locked
from tiswarm.system.progress import reporting

Runner = Callable[[Sequence[Sequence[Cell]], int, Callable[[int], None], Callable[[Cell, Results], None]], None]
"""Runs groups of cells that share a kernel and a seed, so many trials each; is told whom to tell how many trials are done, and
a cell's results once they are there."""


def study(
    name: str | os.PathLike,
    trials: int | None = None,
    seed: int | None = None,
    overrides: Mapping[str, Any] | None = None,
    *,
    folder: str | os.PathLike | None = None,
    progress: Progress = False,
) -> Report:
    """Run all cells of a study: its name, or the path of its TOML file.

    trials: per cell; seed: of all cells; the study's own when None. overrides: key -> value, in every cell.
    folder: where finished cells are kept, so that a run cut short goes on with them; None keeps nothing.
    progress: True shows a bar on a terminal; a function is called with trials done and trials in all.

    Errors: ScenarioError; ValueError for fewer than one trial, or when the folder holds another run.
    """
    return run_study(os.fspath(name), trials, seed, progress, Path(folder) if folder is not None else None, overrides=overrides)


def run_study(
    name: str,
    trials: int | None = None,
    seed: int | None = None,
    progress: Progress = False,
    folder: Path | None = None,
    fresh: bool = False,
    overrides: Mapping[str, Any] | None = None,
    finished: Callable[[Row], None] | None = None,
    figures: tuple[Figure, ...] | None = None,
    runner: Runner | None = None,
) -> Report:
    """Run all cells of a study; those that a kernel can hold together are one batch: two kernels for 46 rows, not dozens.

    trials: per cell; seed: of all cells; the study's own when None.
    folder: where finished cells are kept, and taken from when the same run was cut short before; None keeps nothing.
    fresh: throw away what the folder holds.
    overrides: key -> value, in every cell.
    finished: called with each row, in the order in which they are there.
    figures: which to draw, the study's own when None.
    runner: what runs the cells that are not there; this process when None.

    Errors: ScenarioError; ValueError when the folder holds another run, or another process writes into it.
    """
    started = time.perf_counter()
    study = load_study(name)
    if figures is not None:
        study = study.model_copy(update={"figures": figures})
    count = study.trials if trials is None else trials
    seed = study.seed if seed is None else seed
    found = cells(name, study, seed, overrides)
    published = published_means(study, find_study(name).parent, found)
    about = study.published or Published(file="", trials=1)
    rows: dict[int, Row] = {}

    def keep(cell: Cell, outcomes: Mapping[str, np.ndarray]) -> None:
        means = published.get((cell.table.name, cell.row), {})
        rows[cell.number] = Row(cell, outcomes, study.shares, means, about.spread, about.trials)
        if finished is not None:
            finished(rows[cell.number])

    with ExitStack() as held:
        ledger = None
        if folder is not None:
            held.enter_context(locked(folder))
            ledger = Ledger(folder, Path(name).stem, found, seed, count, study.measures, runtime.start())
            held.callback(ledger.close)
            ledger.open(fresh)
            _take_in(ledger, found, columns_of(study.measures), keep)
        missing = [cell for cell in found if cell.number not in rows]

        def finish(cell: Cell, results: Results) -> None:
            outcomes = outcomes_of(results, study.measures)
            if ledger:
                ledger.keep(cell, outcomes)
            keep(cell, outcomes)

        with reporting(progress, len(found) * count, "trials") as report:
            before = len(rows) * count
            report(before)
            (runner or run_here)(grouped(missing), count, lambda ran: report(before + ran), finish)
        ordered = [rows[cell.number] for cell in found]
        result = Report(Path(name).stem, study, ordered, seed, time.perf_counter() - started, len(missing))
        if ledger:
            ledger.close()
            _close(ledger, result)
    return result


def _take_in(
    ledger: Ledger, found: Sequence[Cell], columns: Sequence[str], keep: Callable[[Cell, Mapping[str, np.ndarray]], None]
) -> None:
    """Keep the cells that are on disk, and say once how many are there and do not fit."""
    for cell in found:
        outcomes = ledger.read(cell, columns)
        if outcomes is not None:
            keep(cell, outcomes)
    if ledger.refused:
        told = f"{ledger.refused} of {len(found)} cells were damaged or not of this run; they are computed anew"
        warnings.warn(f"{ledger.folder}: {told}", stacklevel=3)


def grouped(found: Sequence[Cell]) -> list[list[Cell]]:
    """Put cells together whose trials one kernel can run as one batch."""
    groups: dict[Any, list[Cell]] = {}
    for cell in found:
        groups.setdefault((_unmixed(cell.scenario), cell.seed), []).append(cell)
    return list(groups.values())


def run_here(
    groups: Sequence[Sequence[Cell]], count: int, report: Callable[[int], None], finish: Callable[[Cell, Results], None]
) -> None:
    """Run groups of cells in this process, batch by batch."""
    before = 0
    for group in groups:

        def tell(ran: int, _total: int, before: int = before) -> None:
            report(before + ran)

        def told(k: int, results: Results, group: Sequence[Cell] = group) -> None:
            finish(group[k], results)

        simulate_many([cell.scenario for cell in group], count, group[0].seed, tell, told)
        before += len(group) * count


def _unmixed(scenario: Scenario) -> tuple[Any, ...]:
    """Give what two scenarios must have in common to share a kernel: all of its structure but the strategies."""
    structure = Specialisation.of([scenario], scenario.predators.count)
    return tuple(getattr(structure, each.name) for each in fields(structure) if each.name != "parts")


def columns_of(measures: Sequence[str]) -> list[str]:
    """Name what is kept of a cell's trials, in its order."""
    return list(dict.fromkeys((*OUTCOMES, *measures)))


def outcomes_of(results: Results, measures: Sequence[str]) -> dict[str, np.ndarray]:
    """Give what is kept of a cell's trials: name -> [trial]."""
    return {name: getattr(results, name) for name in OUTCOMES} | {name: results.measure(name) for name in measures}


def _close(ledger: Ledger, report: Report) -> None:
    """Add to the manifest what was computed, and how long all its runs took that came to an end."""
    told: dict[str, Any] = {"computed": report.computed}
    if report.correlations:
        told["correlations"] = [
            {
                "x": each.x,
                "y": each.y,
                "n": each.n,
                "pearson": dict(zip(("r", "low", "high"), each.pearson, strict=True)),
                "spearman": dict(zip(("rho", "low", "high"), each.spearman, strict=True)),
            }
            for each in report.correlations
        ]
    if report.ran or "wall_time_s" not in ledger.about:
        told["wall_time_s"] = round(ledger.about.get("wall_time_s", 0.0) + report.seconds, 3)
    ledger.write(**told)
