"""Tuned: what a tuning found, held against where it started on trials that no search saw."""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.engine.run import simulate_many
from tiswarm.learning.keys import Arm, json_of
from tiswarm.learning.objective import Across, Objective
from tiswarm.records.results import Estimate
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.overrides import overridden
from tiswarm.system.files import write_text


@dataclass(frozen=True, eq=False)
class Check:
    """The middle of a search, run through the trials that choose among generations.

    arm: its place, -1 for the start; values: [range]; outcomes: the objective, [scenario, trial]; start: the start's, or
    None; shares: [scenario], how much each counts in the mean, or None.
    """

    arm: int
    values: np.ndarray
    score: float
    outcomes: np.ndarray
    start: np.ndarray | None
    shares: np.ndarray | None = None

    @property
    def gain(self) -> Estimate:
        """Estimate the paired difference to the start, scenarios joined by their mean, whatever is searched for."""
        before = self.outcomes if self.start is None else self.start
        return Estimate.of(np.average(self.outcomes - before, axis=0, weights=self.shares))


@dataclass(frozen=True, eq=False)
class Generation:
    """One generation: its candidates in the unit cube, [candidate, range], their scores, [candidate], and the middle, [range].

    met: trials that each candidate met, [candidate]; check: where the middle was looked at; seconds: how long it took, with its
    check.
    """

    number: int
    of: int
    arm_number: int
    arm: Arm
    units: np.ndarray
    scores: np.ndarray
    met: np.ndarray
    centre: np.ndarray
    check: Check | None
    seconds: float

    @property
    def best(self) -> float:
        """Give the best score of those that met all trials."""
        return float(self.scores[self.met == self.met.max()].max())


@dataclass(frozen=True)
class Validation:
    """One scenario before and after, on the same trials: the objective's mean, and the mean of the paired differences."""

    title: str
    start: Estimate
    tuned: Estimate
    difference: Estimate


@dataclass(frozen=True, eq=False)
class Tuned:
    """What a tuning found.

    starts, scenarios: before and tuned, in the order given; best: the check that chose them; validations: one a scenario;
    history: all generations.
    """

    starts: tuple[Scenario, ...]
    scenarios: tuple[Scenario, ...]
    objective: Objective
    across: Across
    seed: int
    trials: int
    best: Check
    history: list[Generation]
    validations: tuple[Validation, ...]
    seconds: float

    @property
    def scenario(self) -> Scenario:
        """Give the first tuned scenario."""
        return self.scenarios[0]

    @property
    def improved(self) -> bool:
        """Tell whether any generation's check beat the start's."""
        return self.best.arm >= 0

    @property
    def changes(self) -> dict[str, tuple[Any, Any]]:
        """Map each key that was found to what it was and what it is; a key that the start lacks was None."""
        if not self.improved:
            return {}
        arm = next(each.arm for each in self.history if each.arm_number == self.best.arm)
        before = self.starts[0].numbers()
        chosen = {path: (_word(self.starts[0], path), value) for path, value in arm.chosen}
        found = {each.path: float(value) for each, value in zip(arm.ranges, self.best.values, strict=False)}
        return chosen | {path: (before.get(path), value) for path, value in found.items()}

    def told(self) -> dict[str, Any]:
        """Give what goes into the manifest."""
        return {
            "validation": [
                {"scenario": each.title, **{key: _plain(getattr(each, key)) for key in ("start", "tuned", "difference")}}
                for each in self.validations
            ],
            "changes": {path: {"from": old, "to": new} for path, (old, new) in self.changes.items()},
            "tuned_hash": [each.hash() for each in self.scenarios],
        }

    def save(self, folder: Path) -> list[Path]:
        """Write the tuned presets and a row for each generation into a folder; give the presets' files."""
        files = []
        for k, scenario in enumerate(self.scenarios):
            files.append(folder / ("best.toml" if len(self.scenarios) == 1 else f"best-{k + 1}.toml"))
            side = self.history[0].arm.side if self.improved else ""
            beside = {f"{side}.weights.network": "network.npz"} if side else {}  # the folder may be moved
            write_text(files[-1], toml_of(scenario, beside))
        write_text(folder / "generations.csv", self.to_csv())
        return files

    def to_csv(self) -> str:
        """Write one row for each generation."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        paths = list(dict.fromkeys(each.path for made in self.history for each in made.arm.ranges))
        writer.writerow(("generation", "choice", "best", "mean", "check", "gain", "gain_low", "gain_high", *paths))
        for made in self.history:
            check = ("", "", "", "")
            if made.check is not None:
                gain = made.check.gain
                check = tuple(map(repr, (made.check.score, gain.mean, gain.low, gain.high)))  # type: ignore[assignment]
            middle = dict(zip((each.path for each in made.arm.ranges), made.arm.values(made.centre[None])[0], strict=False))
            best, mean = (repr(each) for each in (made.best, float(made.scores.mean())))
            writer.writerow(
                (
                    made.number,
                    made.arm.name,
                    best,
                    mean,
                    *check,
                    *(repr(float(middle[path])) if path in middle else "" for path in paths),
                )
            )
        return text.getvalue()


def validated(
    starts: Sequence[Scenario],
    found: Sequence[Scenario],
    objective: Objective,
    across: Across,
    trials: int,
    seed: int,
    best: Check,
    history: list[Generation],
    seconds: float,
) -> Tuned:
    """Run start and result through trials 0, 1, ..., which neither search nor checks saw, and pair them."""
    titled = tuple(each.replaced({"title": f"{each.title}, tuned for {objective}"}) for each in found)
    validations = []
    for before, after in zip(starts, titled, strict=True):
        old = objective.of(simulate_many([before], trials, seed)[0])
        new = objective.of(simulate_many([after], trials, seed)[0])
        away = Estimate.of(new - old)
        validations.append(Validation(before.preset or before.title, Estimate.of(old), Estimate.of(new), away))
    return Tuned(tuple(starts), titled, objective, across, seed, trials, best, history, tuple(validations), seconds)


def toml_of(scenario: Scenario, changes: Mapping[str, Any]) -> str:
    """Write a scenario as TOML with some keys changed, which need not be true here."""
    import tomlkit

    return tomlkit.dumps(overridden(json_of(scenario), changes))


def _word(scenario: Scenario, path: str) -> Any:
    place: Any = json_of(scenario)
    for key in path.split("."):
        place = place.get(key) if isinstance(place, dict) else None
    return place


def _plain(estimate: Estimate) -> dict[str, float | None]:
    return {key: value if math.isfinite(value) else None for key, value in asdict(estimate).items()}
