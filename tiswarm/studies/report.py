"""Report: a study after its run, as rows with intervals, pairs and correlations."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from tiswarm.records.results import Estimate
from tiswarm.studies.design import Cell, Study
from tiswarm.studies.statistics import Correlation, Paired, correlation, paired_tests, share_estimate
from tiswarm.system import card
from tiswarm.system.extras import needed
from tiswarm.version import __version__

if TYPE_CHECKING:
    import pandas as pd

OUTCOMES = ("arrived", "captured", "crashed", "alive", "ticks", "first_arrival", "last_arrival")
"""What is kept of each trial besides the study's measures."""

COMPUTED = {
    "mean": "mean and stderr are over the trials of a cell; prey of one trial share its luck, so that the trial is the unit; "
    "trials that have no value of a measure are left out",
    "share": "95 % interval of {names}: Wilson's, at the effective number of independent prey (prey pooled over trials, divided"
    " by the design effect between trials)",
    "normal": "95 % interval of {names}: normal approximation, mean ± 1.96 stderr",
    "pairs": "differences are between trials of one number, which meet the same obstacles and starts; p is of a paired t-test, "
    "corrected by Holm within each table and measure; their intervals are not corrected",
    "correlation": "correlations are over the means of cells; intervals are Fisher's for Pearson's r, the percentiles of 9999 "
    "bootstrap resamples of cells for Spearman's rho",
}
"""What the numbers of a report are, as it says itself."""


@dataclass(frozen=True)
class Row:
    """One cell of a study after its run.

    outcomes: name -> [trial]; published: measure -> mean, empty where nothing was published.
    """

    cell: Cell
    outcomes: Mapping[str, np.ndarray]
    shares: tuple[str, ...]
    published: Mapping[str, float] = field(default_factory=dict)
    spread: float = 1.0
    published_trials: int = 1

    @property
    def trials(self) -> int:
        """Count the trials."""
        return len(next(iter(self.outcomes.values())))

    def values(self, measure: str) -> np.ndarray:
        """Give a measure of each trial: [trial]."""
        return np.asarray(self.outcomes[measure], np.float64)

    def counted(self, measure: str) -> int:
        """Count the trials that have a measure at all."""
        return int(np.isfinite(self.values(measure)).sum())

    def estimate(self, measure: str) -> Estimate:
        """Estimate a measure from our trials."""
        values = self.values(measure)
        if measure in self.shares:
            return share_estimate(values, np.full(len(values), self.cell.scenario.prey.count))
        return Estimate.of(values)

    def published_stderr(self, measure: str) -> float:
        """Give the standard error of the published mean, its spread of trials taken to be ours."""
        sd = self.estimate(measure).stderr * math.sqrt(self.counted(measure))
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
    ran: int  # cells that this run simulated; the others were on disk

    @property
    def tables(self) -> list[list[Row]]:
        """Give the rows table by table."""
        ends = [0, *(k + 1 for k, (a, b) in enumerate(pairwise(self.rows)) if a.cell.table is not b.cell.table), len(self.rows)]
        return [self.rows[start:end] for start, end in pairwise(ends)]

    @property
    def keys(self) -> list[str]:
        """List the keys of all axes, in their order."""
        return list(dict.fromkeys(key for row in self.rows for key in row.cell.table.keys))

    @property
    def shown(self) -> list[str]:
        """List those that a table on the terminal shows."""
        return list(dict.fromkeys(key for row in self.rows for key in row.cell.table.shown))

    def z_summary(self, measures: tuple[str, ...] | None = None) -> tuple[float, float]:
        """Give the root mean square and the largest |z| over all rows and the given measures, all when None."""
        z = np.array([row.z(measure) for row in self.rows for measure in measures or self.study.measures])
        z = z[np.isfinite(z)]
        return (float(np.sqrt(np.mean(z**2))), float(np.abs(z).max())) if z.size else (math.nan, math.nan)

    @cached_property
    def correlations(self) -> list[Correlation]:
        """Give the correlations that the study asks for. Errors: ValueError for values that are no numbers or all alike."""

        def over(name: str) -> np.ndarray:
            if name in self.study.measures:
                return np.array([row.estimate(name).mean for row in self.rows])
            values = [row.cell.point.get(name) for row in self.rows]
            if not all(isinstance(value, int | float) for value in values):
                raise ValueError(f"correlate: '{name}' is not a number in every cell; correlate an axis of numbers")
            return np.array(values, np.float64)

        found = []
        for pair in self.study.correlate:
            x, y = over(pair.x), over(pair.y)
            both = np.isfinite(x) & np.isfinite(y)
            found.append(correlation(pair.x, pair.y, x[both], y[both]))
        return found

    def pairs(self, rows: list[Row], measure: str) -> list[Paired]:
        """Test every row of a table against its first one."""
        return paired_tests(rows[0].values(measure), [row.values(measure) for row in rows[1:]])

    @property
    def computed(self) -> dict[str, str]:
        """Say what the numbers are."""
        shares = [name for name in self.study.measures if name in self.study.shares]
        others = [name for name in self.study.measures if name not in shares]
        told = {"mean": COMPUTED["mean"]}
        told |= {"share": COMPUTED["share"].format(names=", ".join(shares))} if shares else {}
        told |= {"normal": COMPUTED["normal"].format(names=", ".join(others))} if others else {}
        told |= {"pairs": COMPUTED["pairs"]} if "pairs" in figures_of(self.study) else {}
        return told | ({"correlation": COMPUTED["correlation"]} if self.study.correlate else {})

    def cells(self) -> list[dict[str, Any]]:
        """Lay the estimates out, one line a cell: its number and place, n, and mean, stderr, low, high of each measure.

        A measure that some trials do not have says of how many its estimates are, as MEASURE_n.
        """
        partial = [name for name in self.study.measures if any(row.counted(name) < row.trials for row in self.rows)]
        lines = []
        for row in self.rows:
            line = {**self.place(row), "n": row.trials}
            for measure in self.study.measures:
                ours = row.estimate(measure)
                ends = {"": ours.mean, "_stderr": ours.stderr, "_low": ours.low, "_high": ours.high}
                ends |= {"_n": row.counted(measure)} if measure in partial else {}
                line |= {f"{measure}{end}": value for end, value in ends.items()}
            lines.append(line)
        return lines

    def to_pandas(self, per_trial: bool = False) -> "pd.DataFrame":
        """Give a row for each cell: its place on the axes, n, and mean, stderr, low and high of each measure.

        per_trial: a row for each trial of each cell instead, with its outcomes and measures. Needs the extra `data`.
        Errors: MissingExtra (an ImportError).
        """
        pandas = needed("data", "pandas")
        if not per_trial:
            frame = pandas.DataFrame(self.cells()).set_index("cell")
        else:
            parts = [pandas.DataFrame({"trial": range(row.trials), **row.outcomes}) for row in self.rows]
            for part, row in zip(parts, self.rows, strict=True):
                for at, (key, value) in enumerate(self.place(row).items()):
                    part.insert(at, key, [value] * len(part))
            frame = pandas.concat(parts, ignore_index=True).set_index(["cell", "trial"])
        frame.attrs = {"title": self.study.title, "study": self.name, "seed": str(self.seed), "version": __version__}
        return frame

    def _repr_html_(self) -> str:
        lines = self.cells()
        shown = [name for name in lines[0] if not name.endswith(("_stderr", "_n"))]
        told = f"{self.study.title}: {len(lines)} cells of {self.rows[0].trials:,} trials, seed {self.seed}"
        return card.card(told, card.table([[line[name] for name in shown] for line in lines], shown))

    def place(self, row: Row) -> dict[str, Any]:
        """Name a cell: its number, its table where there are several, its point on the axes, its seed where it has its own."""
        place: dict[str, Any] = {"cell": row.cell.number}
        if self.study.tables is not None:
            place["table"] = row.cell.table.name
        point = row.cell.point
        return place | {key: point.get(key) for key in self.keys} | ({"seed": row.cell.seed} if self.study.independent else {})


def figures_of(study: Study) -> tuple[str, ...]:
    """Choose figures by a study's shape, unless it names its own."""
    if study.figures is not None:
        return study.figures
    if study.published is not None or study.game is not None:
        return ("bars",) if study.game is None else ()
    axes = [axis for table in study.all_tables("") for axis in table.axes]
    if any(table.combine == "latin" for table in study.all_tables("")):
        return ("scatter",)
    return ("heat",) if study.tables is None and len(axes) > 1 else ("bars", "pairs", "scatter")
