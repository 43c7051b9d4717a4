"""Store: the generations of a tuning on disk, and the manifest that says whose they are."""

import json
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.records.manifest import manifest
from tiswarm.scenario.model import Scenario
from tiswarm.simd import runtime
from tiswarm.studies.store import code_hash
from tiswarm.system.files import check_writable, replacing, write_text

MANIFEST = "manifest.json"


class Store:
    """What a tuning has found so far, in one folder: each generation is written as soon as it is over, whole or not at all.

    A killed tuning leaves its manifest and generations, and is gone on with; `about` is the manifest.
    """

    def __init__(self, folder: Path, told: Mapping[str, Any], scenarios: Sequence[Scenario]) -> None:
        """Say whose the folder is; nothing is read or written yet.

        told: what must be the same for generations to go together; its first key says of what they are.
        """
        import cmaes

        own = sorted(Path(__file__).parent.glob("*.py"))
        code = code_hash(scenarios) + "".join(sha256(file.read_bytes()).hexdigest() for file in own)
        fixed = {**told, "cmaes": cmaes.__version__, "code": sha256(code.encode()).hexdigest()[:16]}
        self.folder = folder
        self.about: dict[str, Any] = json.loads(manifest(runtime.start(), **fixed))
        self._what = {"tune": "tuning"}.get(next(iter(told)), next(iter(told)))
        self._fixed = [*fixed, "precision", "tiswarm", "taichi"]

    def open(self, fresh: bool = False) -> None:
        """Begin, or go on with what the folder holds; fresh: throw that away.

        Errors: ValueError when it holds something else; OSError when it cannot be written.
        """
        check_writable(self.folder)
        place = self.folder / MANIFEST
        if fresh:
            place.unlink(missing_ok=True)  # first, so that a run killed here finds no manifest that claims the generations
        if place.exists():
            self._compare(place)
            self._sweep(".*.part*")
            return
        self._sweep("*.npz")
        self._sweep(".*.part*")
        self.write()

    def _compare(self, place: Path) -> None:
        mend = "write to another folder with -o, or begin anew with --fresh"
        try:
            held = json.loads(place.read_text(encoding="utf-8"))
        except (ValueError, UnicodeDecodeError):
            held = None
        if not isinstance(held, dict) or self._fixed[0] not in held:
            raise ValueError(f"{place}: is no manifest of a {self._what}; {mend}")
        for key in self._fixed:
            if held.get(key) != self.about[key]:
                raise ValueError(
                    f"{self.folder}: holds another {self._what}: {_difference(key, held.get(key), self.about[key])}; {mend}"
                )

    def _sweep(self, pattern: str) -> None:
        for file in (self.folder / "generations").glob(pattern):
            file.unlink(missing_ok=True)

    def write(self, **more: Any) -> None:
        """Write the manifest, with more in it."""
        self.about |= more
        write_text(self.folder / MANIFEST, json.dumps(self.about, indent=2, ensure_ascii=False) + "\n")

    def keep(self, name: str, arrays: Mapping[str, np.ndarray]) -> None:
        """Write what a generation came to."""
        with replacing(self.folder / "generations" / f"{name}.npz") as part, part.open("wb") as file:
            np.savez(file, allow_pickle=False, **arrays)

    def read(self, name: str) -> dict[str, np.ndarray] | None:
        """Read what `keep` wrote, None unless it is there whole."""
        try:
            with np.load(self.folder / "generations" / f"{name}.npz", allow_pickle=False) as stored:
                return {each: stored[each] for each in stored.files}
        except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile, zlib.error):
            return None


def _difference(key: str, old: Any, new: Any) -> str:
    if isinstance(old, dict) and isinstance(new, dict):
        inner = next(name for name in (*old, *new) if old.get(name) != new.get(name))
        return f"{inner} {_short(old.get(inner))}, not {_short(new.get(inner))}"
    return f"{key} {_short(old)}, not {_short(new)}"


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
