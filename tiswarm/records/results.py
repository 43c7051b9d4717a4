"""Results: one row per trial, estimates with intervals, paired comparisons; CSV and JSON."""

import csv
import io
import json
import math
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tiswarm.records import tables
from tiswarm.records.manifest import manifest
from tiswarm.scenario import picture
from tiswarm.scenario.measures import COUNTED
from tiswarm.scenario.model import Scenario
from tiswarm.simd.runtime import Settings
from tiswarm.system import card
from tiswarm.system.files import write_text

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

Z95 = 1.959963984540054
"""Half the width of a 95 % interval in standard errors."""

COLUMNS = ("trial", "seed", "arrived", "captured", "crashed", "alive", "ticks", "first_arrival", "last_arrival")
"""Columns of trials.csv; arrivals are ticks, 0 when nobody arrived."""


@dataclass(frozen=True)
class Estimate:
    """A mean with its standard error and 95 % interval (normal approximation)."""

    mean: float
    stderr: float
    low: float
    high: float

    @classmethod
    def of(cls, values: np.ndarray) -> "Estimate":
        """Estimate the mean of independent values, NaN left out; one value has no standard error (NaN)."""
        values = values[np.isfinite(values)]
        if len(values) == 0:
            return cls(math.nan, math.nan, math.nan, math.nan)
        mean = float(np.mean(values))
        stderr = float(np.std(values, ddof=1) / math.sqrt(len(values))) if len(values) > 1 else math.nan
        return cls(mean, stderr, mean - Z95 * stderr, mean + Z95 * stderr)


@dataclass(frozen=True)
class Results:
    """Outcomes of a batch, one entry a trial.

    arrived, captured, crashed, alive: prey counts; ticks: how long the trial ran; first_arrival, last_arrival: ticks, 0 when
    nobody arrived; spawned: prey at the start; dt: [s]. measures: what the scenario's `measures` name, NaN where a trial had no
    state to measure or never came so far; weights: numbers of single trials, by path; engine: "all-pairs" or
    "grid", which ran them (engine/choice.py).
    """

    scenario: Scenario
    seed: int
    settings: Settings
    arrived: np.ndarray
    captured: np.ndarray
    crashed: np.ndarray
    alive: np.ndarray
    ticks: np.ndarray
    first_arrival: np.ndarray
    last_arrival: np.ndarray
    spawned: np.ndarray
    dt: np.ndarray
    measures: Mapping[str, np.ndarray] = field(default_factory=dict)
    weights: Mapping[str, np.ndarray] = field(default_factory=dict)
    engine: str = "all-pairs"

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        seed: int,
        settings: Settings,
        outcomes: Mapping[str, np.ndarray],
        measures: Mapping[str, np.ndarray],
        weights: Mapping[str, np.ndarray] | None,
        engine: str = "all-pairs",
    ) -> "Results":
        """Put what the kernel wrote down beside what each trial started with."""
        own = dict(weights or {})
        shape = outcomes["ticks"].shape
        spawned = np.broadcast_to(np.asarray(own.get("prey.count", scenario.prey.count)), shape).astype(np.int32)
        dt = np.broadcast_to(np.asarray(own.get("world.dt", scenario.world.dt), np.float64), shape)
        return cls(scenario, seed, settings, **outcomes, spawned=spawned, dt=dt, measures=measures, weights=own, engine=engine)

    @property
    def trials(self) -> int:
        """Count the trials."""
        return len(self.ticks)

    @property
    def success(self) -> np.ndarray:
        """Give the share of prey that arrived: [trial]."""
        return self.arrived / self.spawned

    @property
    def time(self) -> np.ndarray:
        """Give how long each trial ran: [trial], s."""
        return self.ticks * self.dt

    @property
    def impact_spread(self) -> np.ndarray:
        """Give the time from first to last arrival, 0 for fewer than two arrivals: [trial], s."""
        return np.where(self.arrived >= 2, self.last_arrival - self.first_arrival, 0) * self.dt

    def summary(self) -> dict[str, Estimate]:
        """Estimate each measure over the trials; over those that have it, where some have not."""
        return {name: Estimate.of(self.measure(name)) for name in (*COUNTED, *self.measures)}

    def measure(self, name: str) -> np.ndarray:
        """Give a measure by name: [trial]. Errors: KeyError."""
        return np.asarray(self.measures[name] if name in self.measures else getattr(self, name), np.float64)

    def summary_json(self) -> str:
        """Write the summary as JSON, with what was run; a standard error that one trial cannot have is null."""
        estimates = {
            name: {key: _json_number(value) for key, value in asdict(each).items()} for name, each in self.summary().items()
        }
        return json.dumps(
            {"title": self.scenario.title, "trials": self.trials, "seed": self.seed, "summary": estimates}, indent=2
        )

    def to_csv(self) -> str:
        """Write one row per trial, with the weights of its own behind."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        columns = self.columns()
        writer.writerow(columns)
        writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
        return text.getvalue()

    def columns(self) -> dict[str, np.ndarray]:
        """Give what trials.csv holds: name -> [trial]; measures and weights of single trials behind."""
        own: dict[str, Any] = {"trial": np.arange(self.trials), "seed": np.full(self.trials, self.seed, dtype=object)}
        counted = {name: own.get(name, getattr(self, name, None)) for name in COLUMNS}
        return counted | {name: np.asarray(each) for name, each in {**self.measures, **self.weights}.items()}

    def to_pandas(self) -> "pd.DataFrame":
        """Give a row for each trial: the columns of trials.csv with success, time and impact_spread.

        `attrs` says what was run. Needs the extra `data`. Errors: MissingExtra (an ImportError).
        """
        return tables.frame_of(self)

    def to_xarray(self) -> "xr.Dataset":
        """Give the same along the dimension `trial`, with units, and attributes that say what was run.

        Needs the extra `data`. Errors: MissingExtra (an ImportError).
        """
        return tables.dataset_of(self)

    def _repr_html_(self) -> str:
        rows = [(name, each.mean, each.low, each.high) for name, each in self.summary().items()]
        told = f"{self.scenario.title}: {self.trials:,} trials, seed {self.seed}"
        shown = picture.drawing_of(self.scenario)
        return card.card(told, shown, card.table(rows, ("", "mean", "95 % from", "to")))

    def save(self, folder: str | os.PathLike, form: tables.Form = "csv", **more: Any) -> Path:
        """Write trials.csv, summary.json and manifest.json into a folder; `more` goes into the manifest.

        form: "csv", or "parquet" or "netcdf" for trials.parquet or trials.nc in the place of trials.csv, which need the extra
        `data`. Errors: ValueError for another one; MissingExtra.
        """
        tables.checked_form(form)
        folder = Path(folder)
        table = folder / f"trials.{tables.SUFFIXES[form]}"
        if form == "csv":
            write_text(table, self.to_csv())
        elif form == "parquet":
            tables.write_frame(self.to_pandas(), table)
        else:
            tables.write_dataset(self.to_xarray(), table)
        write_text(folder / "summary.json", self.summary_json() + "\n")
        told = {"scenario": json.loads(self.scenario.to_json()), "scenario_hash": self.scenario.hash(), "trials": self.trials}
        told["engine"] = self.engine
        told["weights_of_single_trials"] = sorted(self.weights)  # their numbers stand in the table of trials
        write_text(folder / "manifest.json", manifest(self.settings, seed=self.seed, **told, **more))
        return folder


def compare(a: Results, b: Results) -> dict[str, Estimate]:
    """Estimate the mean of b - a, trial by trial.

    Trials with the same seed and number meet the same obstacles and starts, so that the pairs share their luck and the
    interval is narrower than that of two independent runs.

    Errors: ValueError when seeds or numbers of trials differ: there are no pairs then.
    """
    if (a.seed, a.trials) != (b.seed, b.trials):
        raise ValueError(
            f"compare: seed {a.seed} with {a.trials} trials cannot be paired with seed {b.seed} with {b.trials}; run both alike"
        )
    both = [name for name in a.measures if name in b.measures]
    return {name: Estimate.of(b.measure(name) - a.measure(name)) for name in (*COUNTED, *both)}


def _json_number(value: float) -> float | None:
    return value if math.isfinite(value) else None
