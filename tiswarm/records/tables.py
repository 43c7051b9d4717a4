"""Tables: outcomes and paths for pandas and xarray, with units, and as files (extra `data`)."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from tiswarm.scenario.model import Scenario
from tiswarm.system.extras import needed
from tiswarm.system.files import replacing
from tiswarm.version import __version__

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from tiswarm.records.recording import Recording
    from tiswarm.records.results import Results

Form = Literal["csv", "parquet", "netcdf"]

SUFFIXES: dict[Form, str] = {"csv": "csv", "parquet": "parquet", "netcdf": "nc"}
"""Format of a table of trials -> how its file's name ends."""

_LIBRARIES: dict[Form, tuple[str, ...]] = {"csv": (), "parquet": ("pandas", "pyarrow"), "netcdf": ("xarray", "netCDF4")}

_MEANINGS = {
    "trial": ("number of the trial", "1"),
    "seed": ("seed of all random numbers", "1"),
    "arrived": ("prey that arrived", "1"),
    "captured": ("prey that predators captured", "1"),
    "crashed": ("prey that crashed into obstacles", "1"),
    "alive": ("prey alive at the end", "1"),
    "ticks": ("ticks that the trial ran", "1"),
    "first_arrival": ("tick of the first arrival, 0 for none", "1"),
    "last_arrival": ("tick of the last arrival, 0 for none", "1"),
    "success": ("share of prey that arrived", "1"),
    "time": ("how long the trial ran", "s"),
    "impact_spread": ("time from first to last arrival", "s"),
}
"""Column -> what it is, and its unit."""


def checked_form(form: str) -> Form:
    """Check that a table can be written in a format. Errors: ValueError for an unknown one; MissingExtra."""
    known: dict[str, Form] = {each: each for each in SUFFIXES}
    if form not in known:
        raise ValueError(f"format: '{form}' is unknown; use {', '.join(SUFFIXES)}")
    for name in _LIBRARIES[known[form]]:
        needed("data", name)
    return known[form]


def described(scenario: Scenario, seed: int, **more: Any) -> dict[str, Any]:
    """Give the attributes of a table or dataset: what was run, by what; the seed, of up to 64 bits, as text."""
    return {
        "title": scenario.title,
        "source": f"tiswarm {__version__}",
        "preset": scenario.preset,
        "seed": str(seed),
        **more,
        "scenario": scenario.to_json(),
        "scenario_hash": scenario.hash(),
        "version": __version__,
    }


def frame_of(results: "Results") -> "pd.DataFrame":
    """Lay outcomes out as a frame, a row a trial."""
    frame = needed("data", "pandas").DataFrame(_columns(results)).set_index("trial")
    frame.attrs = described(results.scenario, results.seed, engine=results.engine)
    return frame


def dataset_of(results: "Results") -> "xr.Dataset":
    """Lay outcomes out along the dimension `trial`."""
    xarray = needed("data", "xarray")
    columns = _columns(results)
    told = {name: dict(zip(("long_name", "units"), about, strict=True)) for name, about in _MEANINGS.items()}
    told |= {name: {"long_name": f"{name}, set for each trial"} for name in results.weights}
    variables = {name: ("trial", values, told.get(name, {})) for name, values in columns.items() if name != "trial"}
    about = {"Conventions": "CF-1.11", **described(results.scenario, results.seed, engine=results.engine)}
    return xarray.Dataset(variables, {"trial": ("trial", columns["trial"], told["trial"])}, about)


def _columns(results: "Results") -> dict[str, np.ndarray]:
    """Give all that is known of each trial: those of trials.csv, and what follows from them."""
    columns = results.columns()
    columns["seed"] = columns["seed"].astype(np.uint64)
    derived = {name: np.asarray(getattr(results, name)) for name in ("success", "time", "impact_spread")}
    return {name: columns[name] for name in columns if name not in (*results.measures, *results.weights)} | derived | columns


def write_frame(frame: "pd.DataFrame", path: str | os.PathLike) -> Path:
    """Write a frame as Parquet, whole or not at all; its attributes go into the file's metadata."""
    arrow, parquet = needed("data", "pyarrow"), needed("data", "pyarrow.parquet")
    about = {key: value if isinstance(value, str) else json.dumps(value) for key, value in frame.attrs.items()}
    plain = frame.copy(deep=False)
    plain.attrs = {}
    made = arrow.Table.from_pandas(plain)
    with replacing(Path(path)) as part:
        parquet.write_table(made.replace_schema_metadata({**(made.schema.metadata or {}), **about}), part)
    return Path(path)


def write_dataset(dataset: "xr.Dataset", path: str | os.PathLike) -> Path:
    """Write a dataset as netCDF-4, compressed, whole or not at all."""
    needed("data", "netCDF4")
    packed = {name: {"zlib": True, "complevel": 4} for name, each in dataset.data_vars.items() if each.dtype.kind in "fiu"}
    with replacing(Path(path)) as part:
        dataset.to_netcdf(part, format="NETCDF4", engine="netcdf4", encoding=packed)
    return Path(path)


def path_dataset(recording: "Recording") -> "xr.Dataset":
    """Lay a path out: dims tick, agent (prey first, then predators), axis, obstacle."""
    xarray = needed("data", "xarray")
    both = (recording.prey, recording.predators)
    kinds = np.repeat(["prey", "predators"], [each.count for each in both])
    ticks = np.arange(recording.ticks + 1)
    dt = recording.scenario.world.dt
    coords: Mapping[str, Any] = {
        "tick": ("tick", ticks, {"long_name": "ticks since the start", "units": "1"}),
        "time": ("tick", ticks * dt, {"long_name": "time since the start", "units": "s"}),
        "agent": ("agent", np.arange(len(kinds)), {"long_name": "number of the agent, prey first", "units": "1"}),
        "kind": ("agent", kinds, {"long_name": "prey or predators"}),
        "axis": ("axis", list("xyz"[: recording.dim]), {"long_name": "axis of space"}),
    }

    def joined(name: str) -> np.ndarray:
        return np.concatenate([getattr(each, name) for each in both], axis=1)

    paths = ("tick", "agent", "axis")
    variables: dict[str, Any] = {
        "position": (paths, joined("position"), {"long_name": "position, missing once gone", "units": "m"}),
        "velocity": (paths, joined("velocity"), {"long_name": "velocity, missing once gone", "units": "m s-1"}),
        "state": (paths[:2], joined("state").astype(str), {"long_name": "state of the agent"}),
        "group": (paths[:2], joined("group"), {"long_name": "sub-swarm, -1 for none", "units": "1"}),
        "fate": ("agent", np.concatenate([each.fate for each in both]).astype(str), {"long_name": "what became of the agent"}),
        "obstacle_position": (("obstacle", "axis"), recording.obstacle_position, {"long_name": "centre", "units": "m"}),
        "obstacle_radius": ("obstacle", recording.obstacle_radius, {"long_name": "radius", "units": "m"}),
    }
    for name in dict.fromkeys(term for each in both for term in each.terms):
        parts = [each.terms.get(name, np.full_like(each.velocity, np.nan)) for each in both]
        about = {"long_name": f"what {name} added to the velocity in the move that followed", "units": "m s-1"}
        variables[f"term_{name}"] = (paths, np.concatenate(parts, axis=1), about)
    attributes = {"Conventions": "CF-1.11", **described(recording.scenario, recording.seed, trial=recording.trial)}
    return xarray.Dataset(variables, coords, attributes)
