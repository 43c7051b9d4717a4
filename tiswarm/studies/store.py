"""Store: the finished cells of a study on disk, and the manifest that says whose they are."""

import inspect
import json
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.records.archive import Archive, DamagedArchive, digest
from tiswarm.records.manifest import manifest
from tiswarm.scenario.model import Scenario
from tiswarm.simd.runtime import Settings
from tiswarm.strategies import registry
from tiswarm.studies.design import Cell
from tiswarm.system.files import read_bounded, replacing, sweep, write_text

MANIFEST = "manifest.json"

WRITERS = 8
"""Threads that write cells: each mostly waits for the disc, and waiting together is no slower than waiting alone."""

MOST_MANIFEST = 1 << 28
MOST_IDENTITY = 1 << 14
"""Most bytes of a manifest, and characters of a cell's identity, that are read."""

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
        self.refused = 0
        self._writers = ThreadPoolExecutor(WRITERS, "cells")
        self._writing: list[Future[None]] = []
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
        place = self.folder / MANIFEST
        if fresh:
            place.unlink(missing_ok=True)  # first, so that a run killed here finds no manifest that claims the cells
        if place.exists():
            held = read_manifest(place)
            self._compare(held)
            self.about |= {key: held[key] for key in ("wall_time_s",) if key in held}
            sweep(self.folder / "cells")
            return
        for file in (self.folder / "cells").glob("[0-9]*.npz"):
            file.unlink(missing_ok=True)
        sweep(self.folder / "cells")
        self.write()

    def _compare(self, held: Mapping[str, Any]) -> None:
        for key, text in _TOLD.items():
            old, new = held.get(key), self.about[key]
            if old != new:
                difference = text.format(old=_short(old), new=_short(new))
                raise ValueError(
                    f"{self.folder}: holds {difference}; write to another folder with -o, or begin anew with --fresh"
                )

    def write(self, **more: Any) -> None:
        """Write the manifest, with more in it."""
        self.about |= more
        rest = json.dumps({key: value for key, value in self.about.items() if key != "cells"}, indent=2, ensure_ascii=False)
        cells = ",\n    ".join(json.dumps(cell) for cell in self.about["cells"])  # a line each: there may be thousands
        write_text(self.folder / MANIFEST, f'{rest[:-2]},\n  "cells": [\n    {cells}\n  ]\n}}\n')

    def keep(self, cell: Cell, outcomes: Mapping[str, np.ndarray]) -> None:
        """Write a finished cell, name -> [trial], while the next ones run. Errors: OSError, of this cell or one before."""
        self._writing.append(self._writers.submit(self._write_cell, cell, outcomes))
        while self._writing and self._writing[0].done():
            self._writing.pop(0).result()

    def close(self) -> None:
        """Wait until all cells are on the disc. Errors: OSError when one could not be written."""
        self._writers.shutdown()
        for each in self._writing:
            each.result()

    def _write_cell(self, cell: Cell, outcomes: Mapping[str, np.ndarray]) -> None:
        identity = identity_of(self.about, cell.number, list(outcomes)) | {"digest": digest(outcomes)}
        with replacing(cell_file(self.folder, cell.number), durable=True) as part, part.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, identity=np.array(json.dumps(identity)), **outcomes)

    def read(self, cell: Cell, columns: Sequence[str]) -> dict[str, np.ndarray] | None:
        """Read a cell with these columns. None unless it is there; `refused` counts those that are there and do not fit."""
        found = read_cell(self.folder, self.about, cell.number, columns)
        if found is None and cell_file(self.folder, cell.number).exists():
            self.refused += 1
        return found


def read_manifest(path: Path) -> dict[str, Any]:
    """Read a study's manifest. Errors: ValueError when it is none; OSError when it cannot be read."""
    try:
        told = json.loads(read_bounded(path, MOST_MANIFEST).decode("utf-8-sig"))
        whole = _is_manifest(told)
    except (ValueError, RecursionError):
        whole = False
    if not whole:
        raise ValueError(
            f"{path}: is no manifest of a study's cells; write to another folder with -o, or begin anew with --fresh"
        )
    if not isinstance(told.get("wall_time_s"), int | float):
        told.pop("wall_time_s", None)
    return dict(told)


_MANIFEST = {"study": str, "seed": int, "trials": int, "precision": str, "code": str, "measures": list, "cells": list}
_CELL = {"cell": int, "row": str, "seed": int, "scenario_hash": str, "scenario": dict}
"""What a manifest and its cells must hold to be worked with: key -> type."""


def _is_manifest(told: Any) -> bool:
    if not isinstance(told, dict) or not all(isinstance(told.get(key), kind) for key, kind in _MANIFEST.items()):
        return False
    cells = (each if isinstance(each, dict) else {} for each in told["cells"])
    whole = all(isinstance(each.get(key), kind) for each in cells for key, kind in _CELL.items())
    return whole and told["trials"] >= 1 and all(isinstance(name, str) for name in told["measures"])


def cell_file(folder: Path, number: int) -> Path:
    """Name the file of a cell."""
    return folder / "cells" / f"{number:05d}.npz"


def identity_of(about: Mapping[str, Any], number: int, columns: Sequence[str]) -> dict[str, Any]:
    """Say whose the outcomes of a cell are, by the manifest of its study."""
    told = about["cells"][number]
    of_study = {key: about.get(key) for key in ("study", "trials", "precision", "code")}
    return of_study | {"cell": number, "scenario_hash": told["scenario_hash"], "seed": told["seed"], "columns": list(columns)}


def read_cell(folder: Path, about: Mapping[str, Any], number: int, columns: Sequence[str]) -> dict[str, np.ndarray] | None:
    """Read the outcomes of a cell, name -> [trial]; None unless they are there whole, and those of this study's cell.

    about: the study's manifest; columns: the names that are expected, in their order.
    """
    trials, wanted = about["trials"], identity_of(about, number, columns)
    try:
        with Archive(cell_file(folder, number), most=(len(columns) * 8 * trials + 4 * MOST_IDENTITY) * 2) as stored:
            identity = json.loads(stored.text("identity", MOST_IDENTITY))
            shapes = {header.shape for name, header in stored.headers.items() if name != "identity"}
            if not isinstance(identity, dict) or shapes != {(trials,)} or set(stored.headers) != {"identity", *columns}:
                return None
            outcomes = {name: stored.read(name) for name in columns}
    except (OSError, DamagedArchive, ValueError, RecursionError):
        return None
    return outcomes if identity == wanted | {"digest": digest(outcomes)} else None


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
