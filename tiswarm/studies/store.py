"""Store: the finished cells of a study on disk, and the manifest that says whose they are."""

import inspect
import json
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.records.manifest import manifest
from tiswarm.scenario.model import Scenario
from tiswarm.simd.runtime import Settings
from tiswarm.strategies import registry
from tiswarm.studies.design import Cell
from tiswarm.system.files import check_writable, replacing, write_text

MANIFEST = "manifest.json"

_OUTCOMES = ("simd", "space", "strategies", "scenario", "dynamics", "measures", "engine")
"""Packages that outcomes of trials come from. Of strategies, only those count that are used."""

_TOLD = {
    "study": "the study {old}, not {new}",
    "seed": "seed {old}, not {new}",
    "trials": "{old} trials a cell, not {new}",
    "precision": "{old}, not {new}",
    "tiswarm": "version {old}, not {new}",
    "taichi": "Taichi {old}, not {new}",
    "measures": "the measures {old}, not {new}",
    "scenario_hash": "other cells or scenarios (hash {old}, not {new})",
    "code": "outcomes of another state of the code ({old}, not {new})",
}
"""What must be the same for cells to go together, and how a difference is told."""


class Ledger:
    """Cells of one run of a study, in one folder: each is written as soon as it is finished, whole or not at all.

    A killed run leaves the manifest and the cells that it finished, and is gone on with; `about` is the manifest.
    """

    def __init__(
        self,
        folder: Path,
        study: str,
        cells: Sequence[Cell],
        seed: int,
        trials: int,
        measures: Sequence[str],
        settings: Settings,
    ) -> None:
        """Say whose the ledger is; nothing is read or written yet."""
        self.folder = folder
        self._cells = cells
        self._trials = trials
        told = {
            "study": study,
            "seed": seed,
            "trials": trials,
            "measures": list(measures),
            "scenario_hash": sha256("".join(f"{c.scenario.hash()} {c.seed}\n" for c in cells).encode()).hexdigest()[:16],
            "code": code_hash([cell.scenario for cell in cells]),
            "cells": [_told(cell) for cell in cells],
        }
        self.about: dict[str, Any] = json.loads(manifest(settings, **told))

    def open(self, fresh: bool = False) -> None:
        """Begin, or go on with what the folder holds.

        fresh: throw away what it holds.

        Errors: ValueError when it holds another run; OSError when it cannot be written.
        """
        check_writable(self.folder)
        place = self.folder / MANIFEST
        if fresh:
            place.unlink(missing_ok=True)  # first, so that a run killed here finds no manifest that claims the cells
        if place.exists():
            held = read_manifest(place)
            self._compare(held)
            self.about |= {key: held[key] for key in ("wall_time_s",) if key in held}
            self._sweep(".*.part*")
            return
        self._sweep("*.npz")
        self._sweep(".*.part*")
        self.write()

    def _compare(self, held: Mapping[str, Any]) -> None:
        for key, text in _TOLD.items():
            old, new = held.get(key), self.about[key]
            if old != new:
                difference = text.format(old=_short(old), new=_short(new))
                raise ValueError(
                    f"{self.folder}: holds {difference}; write to another folder with -o, or begin anew with --fresh"
                )

    def _sweep(self, pattern: str) -> None:
        for file in (self.folder / "cells").glob(pattern):
            file.unlink(missing_ok=True)

    def write(self, **more: Any) -> None:
        """Write the manifest, with more in it."""
        self.about |= more
        rest = json.dumps({key: value for key, value in self.about.items() if key != "cells"}, indent=2, ensure_ascii=False)
        cells = ",\n    ".join(json.dumps(cell) for cell in self.about["cells"])  # a line each: there may be thousands
        write_text(self.folder / MANIFEST, f'{rest[:-2]},\n  "cells": [\n    {cells}\n  ]\n}}\n')

    def keep(self, cell: Cell, outcomes: Mapping[str, np.ndarray]) -> None:
        """Write a finished cell: name -> [trial]."""
        with replacing(cell_file(self.folder, cell.number)) as part, part.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, **outcomes)

    def read(self, cell: Cell) -> dict[str, np.ndarray] | None:
        """Read a cell, None unless it is there whole."""
        return read_cell(self.folder, cell.number, self._trials)


def read_manifest(path: Path) -> dict[str, Any]:
    """Read a study's manifest. Errors: ValueError when it is none."""
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, UnicodeDecodeError):
        told = None
    if not isinstance(told, dict) or not isinstance(told.get("cells"), list):
        raise ValueError(
            f"{path}: is no manifest of a study's cells; write to another folder with -o, or begin anew with --fresh"
        )
    return told


def cell_file(folder: Path, number: int) -> Path:
    """Name the file of a cell."""
    return folder / "cells" / f"{number:05d}.npz"


def read_cell(folder: Path, number: int, trials: int) -> dict[str, np.ndarray] | None:
    """Read the outcomes of a cell, name -> [trial]; None unless they are there whole."""
    try:
        with np.load(cell_file(folder, number), allow_pickle=False) as stored:
            outcomes = {name: stored[name] for name in stored.files}
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile, zlib.error):
        return None
    return outcomes if outcomes and all(each.shape == (trials,) for each in outcomes.values()) else None


def code_hash(scenarios: Sequence[Scenario]) -> str:
    """Name the state of the code that outcomes come from: the simulator's packages, and the files of strategies in use."""
    root = Path(__file__).parents[1]
    behaviours = {root / "strategies" / kind for kind in registry.KINDS}
    files = {file for package in _OUTCOMES for file in (root / package).rglob("*.py") if file.parent not in behaviours}
    files |= {folder / "__init__.py" for folder in behaviours}
    for scenario in scenarios:
        for _, _, kind, name in registry.roles(scenario):
            files |= {_file(kind, part) for part in registry.parts(kind, name)}
    hashes = sorted(sha256(file.read_bytes()).hexdigest() for file in files)
    return sha256("".join(hashes).encode()).hexdigest()[:16]


@cache
def _file(kind: registry.Kind, name: str) -> Path:
    return Path(inspect.getfile(registry.load(kind, name))).resolve()


def _told(cell: Cell) -> dict[str, Any]:
    return {
        "cell": cell.number,
        "table": cell.table.name,
        "row": cell.row,
        "axes": cell.point,
        "seed": cell.seed,
        "scenario_hash": cell.scenario.hash(),
        "scenario": json.loads(cell.scenario.to_json()),
    }


def _short(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
