"""Studies: tables of scenarios run against published figures."""

import csv
import io
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError

from tiswarm.batch import Progress, simulate_many
from tiswarm.explain import ScenarioError, explained
from tiswarm.presets import load, preset_folder, read_toml, study_names
from tiswarm.progress import reporting
from tiswarm.registry import nearest
from tiswarm.results import Estimate, Results, manifest, write_text
from tiswarm.scenario import Part, Positive

MEASURES = ("success", "time", "impact_spread")
"""What a study's rows compare."""

Trials = Annotated[int, Field(strict=True, ge=1)]


class Published(Part):
    """Where the published means are, and how sure they are."""

    file: str  # CSV beside the study: table, row and one column for each of MEASURES
    trials: Trials
    spread: Positive = 1.0  # their standard error is spread · sd/√trials


class Table(Part):
    """One table: a base scenario and one key that differs from row to row."""

    name: str
    title: str
    base: str
    key: str
    values: Annotated[tuple[str | int | float, ...], Field(min_length=1)]


class Study(Part):
    """A study as its TOML file states it."""

    title: str
    source: str = ""
    trials: Trials = 1000
    published: Published | None = None
    tables: Annotated[tuple[Table, ...], Field(min_length=1)]


@dataclass(frozen=True)
class Row:
    """One row of a table after its run.

    published: measure -> mean, empty where nothing was published.
    """

    table: Table
    value: str
    results: Results
    published: dict[str, float]
    spread: float
    published_trials: int

    def estimate(self, measure: str) -> Estimate:
        """Estimate a measure from our trials."""
        return Estimate.of(np.asarray(getattr(self.results, measure), np.float64))

    def published_stderr(self, measure: str) -> float:
        """Give the standard error of the published mean, its spread of trials taken to be ours."""
        sd = float(np.std(getattr(self.results, measure), ddof=1)) if self.results.trials > 1 else math.nan
        return self.spread * sd / math.sqrt(self.published_trials)

    def z(self, measure: str) -> float:
        """Give (ours - published) in standard errors of both together; NaN where nothing was published."""
        if measure not in self.published:
            return math.nan
        ours = self.estimate(measure)
        both = math.hypot(ours.stderr, self.published_stderr(measure))
        return (ours.mean - self.published[measure]) / both if both > 0 else math.nan


@dataclass(frozen=True)
class Report:
    """A study after its run."""

    name: str
    study: Study
    rows: list[Row]
    seed: int
    seconds: float

    def z_summary(self, measures: tuple[str, ...] = MEASURES) -> tuple[float, float]:
        """Give the root mean square and the largest |z| over all rows and the given measures."""
        z = np.array([row.z(measure) for row in self.rows for measure in measures])
        z = z[np.isfinite(z)]
        return (float(np.sqrt(np.mean(z**2))), float(np.abs(z).max())) if z.size else (math.nan, math.nan)

    def to_csv(self) -> str:
        """Write one line per row: our mean and standard error, the published mean and z for each measure."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        heads = [f"{measure}{end}" for measure in MEASURES for end in ("", "_stderr", "_published", "_z")]
        writer.writerow(["table", "row", "trials", *heads])
        for row in self.rows:
            cells: list[Any] = [row.table.name, row.value, row.results.trials]
            for measure in MEASURES:
                ours = row.estimate(measure)
                cells += [f"{ours.mean:.6f}", f"{ours.stderr:.6f}", row.published.get(measure, ""), f"{row.z(measure):.3f}"]
            writer.writerow(cells)
        return text.getvalue()

    def save(self, folder: Path) -> None:
        """Write rows.csv and manifest.json."""
        write_text(folder / "rows.csv", self.to_csv())
        scenarios = [row.results.scenario for row in self.rows]
        told = {
            "study": self.name,
            "scenario_hash": sha256("".join(scenario.hash() for scenario in scenarios).encode()).hexdigest()[:16],
            "scenarios": {f"{row.table.name}/{row.value}": row.results.scenario.hash() for row in self.rows},
            "seed": self.seed,
            "trials": self.rows[0].results.trials,
            "wall_time_s": round(self.seconds, 3),
        }
        write_text(folder / "manifest.json", manifest(self.rows[0].results.settings, **told))


def find_study(name: str) -> Path:
    """Find a study's file by name or path. Errors: ScenarioError."""
    if name.endswith(".toml"):
        return Path(name)
    if name not in study_names():
        raise ScenarioError(f"study: unknown '{name}'; {nearest(name, study_names())}")
    return preset_folder() / "studies" / f"{name}.toml"


def load_study(name: str) -> Study:
    """Load a study. Errors: ScenarioError."""
    try:
        return Study.model_validate(read_toml(find_study(name)))
    except ValidationError as error:
        raise ScenarioError(explained(error, Study)) from None


def run_study(name: str, trials: int | None = None, seed: int = 0, progress: Progress = False) -> Report:
    """Run all rows of a study; those with predators and those without are one batch each: two kernels, not dozens.

    trials: per row, the study's own number when None.
    """
    study = load_study(name)
    count = study.trials if trials is None else trials
    places = [(table, str(value)) for table in study.tables for value in table.values]
    scenarios = [load(table.base, {table.key: value}) for table in study.tables for value in table.values]
    published = _published(study, find_study(name).parent)
    started = time.perf_counter()
    results: list[Results | None] = [None] * len(scenarios)
    groups = [
        [k for k, scenario in enumerate(scenarios) if bool(scenario.predators.count) == hunted] for hunted in (False, True)
    ]
    before = 0
    with reporting(progress, len(scenarios) * count, "trials") as report:
        for group in filter(None, groups):
            ran = simulate_many([scenarios[k] for k in group], count, seed, _shifted(report, before))
            before += len(group) * count
            for k, result in zip(group, ran, strict=True):
                results[k] = result
    about = study.published or Published(file="", trials=1)
    rows = [
        Row(table, value, result, published.get((table.name, value), {}), about.spread, about.trials)
        for (table, value), result in zip(places, results, strict=True)
        if result is not None
    ]
    return Report(Path(name).stem, study, rows, seed, time.perf_counter() - started)


def _shifted(report: Callable[[int], None], before: int) -> Callable[[int, int], None]:
    return lambda done, _total: report(before + done)


def _published(study: Study, folder: Path) -> dict[tuple[str, str], dict[str, float]]:
    """Read the published means: (table, row) -> measure -> mean. Errors: ScenarioError for a file that does not fit."""
    if study.published is None:
        return {}
    path = folder / study.published.file
    try:
        lines = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
        found = {(line["table"], line["row"]): {measure: float(line[measure]) for measure in MEASURES} for line in lines}
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise ScenarioError(
            f"published.file: {path} cannot be used ({error}); it needs table, row, {', '.join(MEASURES)}"
        ) from None
    known = {(table.name, str(value)) for table in study.tables for value in table.values}
    for place in found:
        if place not in known:
            raise ScenarioError(f"published.file: {path} has a row {'/'.join(place)} that the study does not have")
    return found
