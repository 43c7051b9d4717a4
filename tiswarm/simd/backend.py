"""Backend: what stands behind `import taichi`: Taichi, or Quadrants, a fork of it that speaks the same language.

Kernels are written for Taichi and import it by its name. Where TISWARM_BACKEND=quadrants, or where Taichi is not installed and
Quadrants is, that name and those of its modules give Quadrants' instead; what differs inside them is met here. Where neither is
there, whoever imports Taichi is told what installs it.
"""

import importlib
import importlib.abc
import importlib.metadata
import importlib.util
import os
import sys
import warnings
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from tiswarm.simd import tracing

VARIABLE = "TISWARM_BACKEND"
BACKENDS = ("taichi", "quadrants")

_ABSENT = {
    "taichi": "taichi is not installed; pip install taichi==1.7.4, or its fork: pip install 'tiswarm[quadrants]'",
    "quadrants": "quadrants is not installed; pip install 'tiswarm[quadrants]'",
}


class MissingBackend(ImportError):
    """Neither is installed, or not the one that was chosen; the message is one line that names the command which installs it.

    No ValueError: a scenario whose strategy cannot be imported for it is not wrong.
    """


def name() -> str:
    """Name the package that stands behind `import taichi`. Errors: ValueError for one that is not known."""
    chosen = os.environ.get(VARIABLE, "")
    if chosen:
        if chosen not in BACKENDS:
            raise ValueError(f"{VARIABLE}={chosen}: not known; use taichi or quadrants")
        return chosen
    taken = any(isinstance(each, _Alias) for each in sys.meta_path)  # then it is what is found by Taichi's name
    return "quadrants" if taken or (_missing("taichi") and not _missing("quadrants")) else "taichi"


def version() -> str:
    """Give the version of Taichi, or Quadrants' with its name: outcomes of the two are kept apart. Errors: MissingBackend."""
    own = name()
    if _missing(own):
        raise MissingBackend(_ABSENT[own])
    told = importlib.metadata.version(own)
    return told if own == "taichi" else f"{own} {told}"


def choose() -> None:
    """Let `import taichi` give what was chosen; before anybody imports it."""
    if os.environ.get(VARIABLE, "") not in ("", *BACKENDS):
        return  # told where errors are heard, when Taichi is started
    if _missing(name()):
        sys.meta_path.insert(0, _Absent(name()))
        return
    if name() == "taichi":
        tracing.watch()
        return
    os.environ.setdefault("ENABLE_QUADRANTS_HEADER_PRINT", "False")
    # It warns of every call of a kernel's author that it does not read itself: our Bundles and tables of funcs.
    warnings.filterwarnings("ignore", r"(?s).*Calling non-quadrants function", SyntaxWarning)
    sys.meta_path.insert(0, _Alias())


def program(runtime: Any) -> Any:
    """Give what Taichi has started, None where it has not: Quadrants complains when it is asked for that."""
    return runtime._prog if hasattr(type(runtime), "prog") else runtime.prog


class _Alias(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds taichi and its modules in Quadrants."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,  # noqa: ARG002 - as Python calls it
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        """Give what loads a module of Taichi's, and of nobody else's."""
        if fullname.partition(".")[0] != "taichi":
            return None
        return importlib.util.spec_from_loader(fullname, self)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Give the module that there is."""
        module = importlib.import_module("quadrants" + spec.name.removeprefix("taichi"))
        spec.loader_state = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Let the module, which has run under its own name, keep that."""
        assert module.__spec__ is not None
        module.__spec__ = module.__spec__.loader_state


class _Absent(importlib.abc.MetaPathFinder):
    """Finds that taichi is not there, where kernels are first needed: what needs none goes without."""

    def __init__(self, backend: str) -> None:
        """Tell it of a backend."""
        self._backend = backend

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,  # noqa: ARG002 - as Python calls it
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        """Raise MissingBackend for taichi."""
        if fullname == "taichi":
            raise MissingBackend(_ABSENT[self._backend])
        return None


def _missing(package: str) -> bool:
    try:
        return importlib.util.find_spec(package) is None
    except MissingBackend:
        return True
