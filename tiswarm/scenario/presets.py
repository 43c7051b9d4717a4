"""Presets: find them by name or path, take in their base, load them as scenarios."""

import os
import tomllib
import warnings
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario, validated
from tiswarm.scenario.words import titled_table
from tiswarm.strategies import registry
from tiswarm.system.files import read_bounded
from tiswarm.system.words import did_you_mean, reason

MOST_TOML = 1 << 22
"""Most bytes of a preset or of a study that are read."""


def load(preset: str | os.PathLike, overrides: Mapping[str, Any] | None = None) -> Scenario:
    """Load a preset by name or a TOML file by path, and change some of its keys.

    overrides: dotted path -> value, as in {"prey.strategy": "evasive", "obstacles.region.0.0": 20}.

    Errors: ScenarioError, one line that names the key, the value and what is allowed.
    """
    name = os.fspath(preset)
    file = find(name)
    known = {path: each for each, path in presets().items()}
    scenario = validated({**_beside(_table(name), file.parent), "preset": known.get(file, file.name)})
    scenario = scenario.replaced(overrides) if overrides else scenario
    if file not in known or "world.dt" in (overrides or {}):
        _warn_of_ticks(scenario)
    return scenario


Subject = Scenario | str | os.PathLike
"""A scenario, or the name or path that it is loaded by."""


def loaded(subject: Subject) -> Scenario:
    """Give a scenario, loaded if it is named. Errors: as `load`."""
    return subject if isinstance(subject, Scenario) else load(subject)


def title(preset: str) -> str:
    """Give the title of a preset by name, its counts filled in, without checking the rest of it. Errors: ScenarioError."""
    return titled_table(_table(preset))


def _warn_of_ticks(scenario: Scenario) -> None:
    """Say in one line that gains which act once a tick mean something else when a tick is not a second."""
    dt = scenario.world.dt
    flocks = any(registry.load("prey", name).flocks for name in registry.parts("prey", scenario.prey.strategy))
    gains = [scenario.prey.goal] * scenario.target.present
    gains += [scenario.prey.cohesion, scenario.prey.separation, scenario.prey.alignment] * flocks
    if dt != 1 and scenario.world.gains == "per-tick" and any(gains):
        told = f"world.dt: {dt:g} s, and gains act once a tick, {1 / dt:g} times a second"
        warnings.warn_explicit(f'{told}; set world.gains = "per-second" if you mean them so', UserWarning, "tiswarm", 0)


def _beside(table: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Let networks that lie beside a preset be found from anywhere."""
    out = dict(table)
    for kind in ("prey", "predators"):
        agents = out.get(kind)
        weights = agents.get("weights") if isinstance(agents, dict) else None
        name = weights.get("network") if isinstance(weights, dict) else None
        if isinstance(name, str) and not Path(name).is_absolute() and (folder / name).is_file():
            out[kind] = {**agents, "weights": {**weights, "network": str(folder / name)}}  # type: ignore[dict-item]
    return out


def _table(preset: str, above: tuple[str, ...] = ()) -> dict[str, Any]:
    """Read a preset's TOML, with what it takes from its base."""
    if preset in above:
        raise ScenarioError(f"base: {' -> '.join((*above, preset))} is a circle; drop one 'base' key")
    table = read_toml(find(preset))
    base = table.pop("base", None)
    if base is None:
        return table
    if not isinstance(base, str):
        raise ScenarioError(f"base: {base!r} is not a preset's name")
    if base.endswith(".toml"):
        base = str(find(preset).parent / base)
    return _merged(_table(base, (*above, preset)), table)


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file, with or without a byte order mark. Errors: ScenarioError, for one that states nothing, too."""
    try:
        table = tomllib.loads(read_bounded(path, MOST_TOML).decode("utf-8-sig"))
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {reason(error)}") from None
    except UnicodeDecodeError:
        raise ScenarioError(f"{path}: cannot be read: not UTF-8; save it as UTF-8 text") from None
    except RecursionError:
        raise ScenarioError(f"{path}: a value is nested too deeply") from None
    except ValueError as error:
        raise ScenarioError(f"{path}: not valid TOML: {error}") from None
    if not table:
        raise ScenarioError(f'{path}: is empty; state what differs from the defaults, or base = "NAME"')
    return table


def _merged(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    out = dict(below)
    for key, value in above.items():
        both = isinstance(value, dict) and isinstance(out.get(key), dict)
        out[key] = _merged(out[key], value) if both else value
    return out


def preset_folder() -> Path:
    """Find the presets: inside an installed wheel, or beside the package in a checkout."""
    package = Path(__file__).parents[1]
    inside = package / "presets"
    return inside if inside.is_dir() else package.parent / "presets"


@cache
def presets() -> dict[str, Path]:
    """Map preset names (studies left out) to their files."""
    folder = preset_folder()
    found = {file.relative_to(folder).with_suffix("").as_posix(): file for file in sorted(folder.glob("*/*.toml"))}
    return {name: file for name, file in found.items() if not name.startswith("studies/")}


def study_names() -> list[str]:
    """List the studies that ship with tiswarm."""
    return sorted(file.stem for file in (preset_folder() / "studies").glob("*.toml"))


def find(preset: str) -> Path:
    """Find a preset's file: a path, a full name, or the plain name of a demo. Errors: ScenarioError."""
    if preset.endswith(".toml"):
        return Path(preset)
    known = presets()
    file = known.get(preset) or known.get(f"demo/{preset}")
    if file is None:
        hint = did_you_mean(preset, list(known))
        raise ScenarioError(f"preset: unknown '{preset}'; {hint} (list them with 'tiswarm presets')")
    return file
