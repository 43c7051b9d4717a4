"""Rerun: the trials that a study's tables counted, run again from its manifest."""

from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.cli.options import WrongInput
from tiswarm.engine.run import record, simulate
from tiswarm.scenario.model import Scenario, validated
from tiswarm.studies.run import columns_of, outcomes_of
from tiswarm.studies.store import read_cell, read_manifest


class Rebuilt:
    """A study's manifest, read to run a cell's trials again."""

    def __init__(self, path: Path) -> None:
        """Read a manifest. Errors: WrongInput when there is none."""
        if not path.is_file():
            raise WrongInput(f"{path}: no such file; 'tiswarm bench STUDY' writes one into its folder")
        self._folder = path.parent
        self._told = read_manifest(path)
        self.precision: str = self._told["precision"]

    @property
    def count(self) -> int:
        """Count the cells."""
        return len(self._told["cells"])

    def row(self, number: int) -> str:
        """Name a cell by its row in the tables."""
        return str(self.cell(number)["row"])

    def cell(self, number: int) -> dict[str, Any]:
        """Find a cell by its number in the tables. Errors: WrongInput."""
        cells = self._told["cells"]
        if not 0 <= number < len(cells):
            raise WrongInput(f"--cell {number}: the study has cells 0 to {len(cells) - 1}")
        found: dict[str, Any] = cells[number]
        return found

    def outcomes(self, number: int) -> dict[str, np.ndarray]:
        """Give the outcomes of a cell's trials: from its file, or run again when that is gone. name -> [trial]."""
        cell = self.cell(number)
        held = read_cell(self._folder, self._told, number, columns_of(self._told["measures"]))
        if held is not None:
            return held
        results = simulate(self._scenario(cell), self._told["trials"], cell["seed"])
        return outcomes_of(results, self._told["measures"])

    def _scenario(self, cell: dict[str, Any]) -> Scenario:
        """Build a cell's scenario. Errors: WrongInput when it is not the one that the manifest counted."""
        scenario = validated(cell["scenario"])
        if scenario.hash() != cell["scenario_hash"]:
            raise WrongInput(f"{self._folder}: the manifest's cell {cell['cell']} is damaged; run the study again with --fresh")
        return scenario

    def picked(self, number: int, pick: str) -> int:
        """Choose a trial by the study's first measure, large is good; ties by time, short is good; then by number."""
        self.cell(number)
        found = self.outcomes(number)
        order = np.lexsort((found["ticks"], -found[self._told["measures"][0]]))
        return int(order[{"best": 0, "median": len(order) // 2, "worst": -1}[pick]])

    def record(self, number: int, trial: int) -> Any:
        """Record a trial of a cell, and check that its outcome is the one that the tables counted.

        Errors: WrongInput for a trial that the cell does not have, or an outcome that this code does not repeat.
        """
        cell = self.cell(number)
        if not 0 <= trial < self._told["trials"]:
            raise WrongInput(f"--trial {trial}: cell {number} has trials 0 to {self._told['trials'] - 1}")
        recording = record(self._scenario(cell), trial, cell["seed"])
        counted = {name: int(values[trial]) for name, values in self.outcomes(number).items() if name in ("arrived", "ticks")}
        again = {"arrived": int((recording.prey.fate == "arrived").sum()), "ticks": recording.ticks}
        if again != counted:
            raise WrongInput(
                f"cell {number}, trial {trial}: came out as {again}, the table counted {counted}; "
                "the code has changed since, run the study again with --fresh"
            )
        return recording

    def described(self, number: int, trial: int) -> str:
        """Say which trial it is and how it came out."""
        found = self.outcomes(number)
        measures = ", ".join(f"{name.replace('_', ' ')} {found[name][trial]:.4g}" for name in self._told["measures"])
        return f"cell {number} ({self.cell(number)['row']}), trial {trial}: {measures}"

    def name(self, number: int, trial: int) -> str:
        """Name the film's file."""
        return f"{self._told['study']}-{number}-{trial}"
