"""Find strategies: one file each, in this package, in a user's folder, or from an entry point."""

import ast
import importlib
import importlib.metadata
import importlib.util
import sys
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from math import isfinite
from pathlib import Path
from types import ModuleType
from typing import Any, Literal, get_args, get_origin

from tiswarm.strategies.lane_rules import check_lanes
from tiswarm.system.words import did_you_mean

Kind = Literal["prey", "predators", "avoidance"]
KINDS: tuple[Kind, ...] = ("prey", "predators", "avoidance")

Side = Literal["prey", "predators"]
Role = Literal["strategy", "avoidance"]

_folders: list[Path] = []


class UnknownStrategy(ValueError):
    """No file has this name; the message names the nearest one."""


def add_path(folder: str | Path) -> None:
    """Also look for strategies in `folder`/prey, `folder`/predators and `folder`/avoidance.

    Errors: ValueError when none of the three is there, or a name is taken.
    """
    folder = Path(folder).resolve()
    if not any((folder / kind).is_dir() for kind in KINDS):
        raise ValueError(
            f"strategy path: {folder} has no folder named prey, predators or avoidance; put your file in one of these"
        )
    if folder not in _folders:
        _folders.append(folder)
        for cached in (_files, load, parts):
            cached.cache_clear()
        try:
            for kind in KINDS:
                _files(kind)
        except ValueError:
            _folders.remove(folder)
            raise


@cache
def _files(kind: Kind) -> dict[str, Path | str]:
    """Map each name to its file, or to the module of an entry point."""
    found: dict[str, Path | str] = {}
    for folder in (Path(__file__).parent, *_folders):
        for file in sorted((folder / kind).glob("*.py")):
            if not file.stem.startswith("_"):
                name = file.stem.replace("_", "-")
                if name in found:
                    raise ValueError(f"strategy path: {file} and {found[name]} have one name; rename yours")
                found[name] = file
    for entry in importlib.metadata.entry_points(group=f"tiswarm.{kind}"):
        found.setdefault(entry.name.replace("_", "-"), entry.value)
    return found


def names(kind: Kind) -> list[str]:
    """List the names of a kind, as presets and the command line use them."""
    return sorted(_files(kind))


def described(kind: Kind) -> dict[str, str]:
    """Map each name to the first line of its file's docstring, without importing the file."""
    return {name: _first_line(file) for name, file in sorted(_files(kind).items())}


@cache
def _first_line(file: Path | str) -> str:
    if isinstance(file, str):
        return f"(from {file})"
    doc = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return doc.splitlines()[0] if doc else ""


@cache
def load(kind: Kind, name: str) -> Any:
    """Import a strategy's class.

    Errors: UnknownStrategy for a name without a file; ValueError for a file without a class named Strategy.
    """
    file = _files(kind).get(name)
    if file is None:
        raise UnknownStrategy(f"unknown {name!r}; {did_you_mean(name, names(kind))}")
    if isinstance(file, Path):
        check_lanes(file)
    module = _imported(kind, file)
    strategy = getattr(module, "Strategy", None)
    if not isinstance(strategy, type):
        raise ValueError(f"{file}: has no class named Strategy; see CONTRIBUTING, 'Add a strategy'")
    _check_class(strategy, kind, file)
    strategy.name = name  # type: ignore[attr-defined]
    return strategy


_FORMER = {f"tiswarm.{kind}": f"tiswarm.strategies.{kind}" for kind in KINDS} | {"tiswarm.lanes": "tiswarm.simd.lanes"}
"""Where strategies of version 0.1 import from, and what is there now: users' files go on working."""


def _imported(kind: Kind, file: Path | str) -> ModuleType:
    for former, place in _FORMER.items():
        sys.modules.setdefault(former, importlib.import_module(place))
    if isinstance(file, str):
        return importlib.import_module(file.partition(":")[0])
    if file.parent.parent == Path(__file__).parent:
        return importlib.import_module(f"tiswarm.strategies.{kind}.{file.stem}")
    spec = importlib.util.spec_from_file_location(f"tiswarm_user_{kind}_{file.stem}", file)
    if spec is None or spec.loader is None:
        raise ValueError(f"{file}: cannot be imported")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # Taichi reads a function's source through its module
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # whatever a user's file raises
        raise ValueError(f"{file}: cannot be imported: {type(error).__name__}: {error}") from None
    return module


def catalogues(side: Side) -> tuple[tuple[Role, Kind], ...]:
    """Give the two roles of a side, each with the kind that it chooses from: both sides avoid by the same strategies."""
    return ("strategy", side), ("avoidance", "avoidance")


def roles(scenario: Any) -> Iterator[tuple[Side, Role, Kind, str]]:
    """List what a scenario chooses: side, role, the kind that is chosen from, and the name."""
    sides: tuple[Side, ...] = ("prey", "predators")
    for side in sides:
        for role, kind in catalogues(side):
            yield side, role, kind, getattr(getattr(scenario, side), role)


_BASES = {"prey": "Prey", "predators": "Predator", "avoidance": "Avoidance"}


def _check_class(strategy: Any, kind: Kind, file: Path | str) -> None:
    """Refuse a class that does not have what all strategies have. Errors: ValueError that names the mend."""
    base = getattr(importlib.import_module(f"tiswarm.strategies.{kind}"), _BASES[kind])
    if not issubclass(strategy, base):
        raise ValueError(f"{file}: Strategy is no {base.__name__}; write class Strategy({base.__name__})")
    named = strategy.parts
    if not isinstance(named, tuple) or not all(isinstance(each, str) for each in named):
        raise ValueError(f"{file}: parts is {named!r}; write a tuple of names, as in ('explode', 'evasive')")
    if not (isinstance(strategy.Weights, type) and is_dataclass(strategy.Weights)):
        raise ValueError(f"{file}: Weights is no dataclass; write @dataclass(frozen=True) above it")
    for field in fields(strategy.Weights):
        default = field.default
        if field.name == "network" and getattr(strategy, "networked", False):
            continue  # the file of a network, which scenario/network.py checks
        words = get_args(field.type) if get_origin(field.type) is Literal else ()
        if words and default not in words:
            raise ValueError(f"{file}: Weights.{field.name}: its default must be one of {', '.join(map(repr, words))}")
        if not words and (isinstance(default, bool) or not isinstance(default, int | float) or not isfinite(default)):
            raise ValueError(f"{file}: Weights.{field.name} has no number as its default; write {field.name}: float = 0.0")


@cache
def parts(kind: Kind, name: str) -> tuple[str, ...]:
    """Resolve a combination (kitchen-sink, explode-evasive, ...) into the strategies it is made of, in their order."""
    return _parts(kind, name, ())


def _parts(kind: Kind, name: str, above: tuple[str, ...]) -> tuple[str, ...]:
    try:
        strategy = load(kind, name)
    except UnknownStrategy as error:
        if not above:
            raise
        raise ValueError(f"{_files(kind)[above[-1]]}: parts: {error}") from None
    if name in above:
        raise ValueError(f"{_files(kind)[name]}: parts {' -> '.join((*above, name))} are a circle; leave one out")
    return tuple(part for each in strategy.parts for part in _parts(kind, each, (*above, name))) or (name,)


def defaults(kind: Kind, name: str) -> dict[str, float | str]:
    """Map the weights of a strategy, those of its parts included, to their defaults."""
    found: dict[str, float | str] = {}
    for part in parts(kind, name):
        weights = load(kind, part).Weights()
        found.update({key: value if isinstance(value, str) else float(value) for key, value in vars(weights).items()})
    return found


def choices(kind: Kind, name: str) -> dict[str, tuple[Any, ...]]:
    """Map those weights of a strategy that are a choice to what may be chosen; a kernel sees the place in that list."""
    return {
        field.name: get_args(field.type)
        for part in parts(kind, name)
        for field in fields(load(kind, part).Weights)
        if get_origin(field.type) is Literal
    }


def dimensions(kind: Kind, name: str) -> tuple[int, ...]:
    """List the dimensions of the worlds that a strategy and all its parts support."""
    return tuple(dim for dim in (2, 3) if all(dim in load(kind, part).dimensions for part in parts(kind, name)))
