"""Tables and datasets: they hold what results and recordings hold, and say what it is."""

import copy
import csv
import io
import json
import pickle
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from pyarrow import parquet

import tiswarm
from tiswarm.system import extras

pytestmark = pytest.mark.quick

EVASIVE = {"prey.strategy": "evasive"}
LARGEST = 2**64 - 1


@pytest.fixture(scope="module")
def results():
    scenario = tiswarm.load("delft/pronav-10", EVASIVE)
    return tiswarm.simulate(scenario, 40, LARGEST, weights={"prey.weights.evade": np.linspace(0, 0.02, 40)})


@pytest.fixture(scope="module")
def path():
    return tiswarm.record(tiswarm.load("delft/pronav-10", EVASIVE), trial=3, seed=7, terms=True)


def test_a_frame_has_a_row_a_trial_and_says_what_was_run(results):
    frame = results.to_pandas()
    assert frame.index.name == "trial"
    assert len(frame) == 40
    for name in ("arrived", "ticks", "success", "time", "impact_spread"):
        np.testing.assert_array_equal(frame[name], getattr(results, name))
    np.testing.assert_array_equal(frame["prey.weights.evade"], results.weights["prey.weights.evade"])
    assert frame["seed"].unique().tolist() == [LARGEST]
    assert tiswarm.Scenario.from_json(frame.attrs["scenario"]) == results.scenario
    assert frame.attrs["seed"] == str(LARGEST)


def test_a_frame_belongs_to_the_user(results):
    before = results.arrived.copy()
    frame = results.to_pandas()
    frame.loc[:, "arrived"] = -1
    np.testing.assert_array_equal(results.arrived, before)


def test_trials_as_parquet_and_netcdf_are_the_frame(results, tmp_path):
    frame = results.to_pandas()
    results.save(tmp_path, "parquet")
    results.save(tmp_path, "netcdf")
    again = pd.read_parquet(tmp_path / "trials.parquet")
    pd.testing.assert_frame_equal(again, frame)
    assert parquet.read_schema(tmp_path / "trials.parquet").metadata[b"scenario_hash"].decode() == results.scenario.hash()
    with xr.open_dataset(tmp_path / "trials.nc") as dataset:
        xr.testing.assert_identical(dataset.load(), results.to_xarray())
        assert dataset["time"].attrs["units"] == "s"
        np.testing.assert_array_equal(dataset["success"], frame["success"])
    assert {file.name for file in tmp_path.iterdir()} == {"trials.parquet", "trials.nc", "summary.json", "manifest.json"}


def test_an_unknown_format_is_refused_before_anything_is_written(results, tmp_path):
    with pytest.raises(ValueError, match="use csv, parquet, netcdf"):
        results.save(tmp_path / "run", "excel")
    assert not (tmp_path / "run").exists()


def test_a_dataset_of_a_path_has_dims_units_and_attributes(path):
    dataset = path.to_xarray()
    assert dict(dataset.sizes) == {"tick": path.ticks + 1, "agent": 21, "axis": 2, "obstacle": 10}
    prey = dataset.where(dataset["kind"] == "prey", drop=True)
    np.testing.assert_array_equal(prey["position"], path.prey.position)
    np.testing.assert_array_equal(dataset["velocity"][:, 6:], path.predators.velocity)
    np.testing.assert_array_equal(dataset["fate"][:6], path.prey.fate)
    np.testing.assert_array_equal(dataset["term_evasive"][:, :6], path.prey.terms["evasive"])
    assert np.isnan(dataset["term_evasive"][:, 6:]).all()
    units = {name: dataset[name].attrs.get("units") for name in ("position", "velocity", "time", "obstacle_radius")}
    assert units == {"position": "m", "velocity": "m s-1", "time": "s", "obstacle_radius": "m"}
    assert (dataset.attrs["seed"], dataset.attrs["trial"], dataset.attrs["version"]) == ("7", 3, tiswarm.__version__)
    assert tiswarm.Scenario.from_json(dataset.attrs["scenario"]) == path.scenario


@pytest.mark.parametrize("preset", ["delft/avoidance-10", "lookout/aquarium"])
def test_a_path_as_netcdf_is_the_dataset(preset, tmp_path):
    recording = tiswarm.record(tiswarm.load(preset, {"world.ticks": 5}))
    with xr.open_dataset(recording.to_netcdf(tmp_path / "path.nc")) as dataset:
        xr.testing.assert_identical(dataset.load(), recording.to_xarray())
        assert dataset["time"].dtype.kind == "f"  # seconds, not dates
    assert [file.name for file in tmp_path.iterdir()] == ["path.nc"]


def test_a_path_as_csv_has_a_row_for_everybody_who_is_there(path):
    rows = list(csv.DictReader(io.StringIO(path.to_csv())))
    assert len(rows) == path.prey.alive.sum() + path.predators.alive.sum()
    last = rows[-1]
    tick, agent = int(last["tick"]), int(last["agent"]) - 6
    assert last["kind"] == "predators"
    assert (float(last["x"]), float(last["y"])) == tuple(path.predators.position[tick, agent])
    assert {row["state"] for row in rows} <= {"calm", "alarmed"}


def _same(a, b):
    np.testing.assert_array_equal(a.arrived, b.arrived)
    assert a.scenario == b.scenario
    assert a.summary() == b.summary()


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda each: pickle.loads(pickle.dumps(each))])
def test_scenarios_results_and_recordings_are_copied_and_pickled(results, path, again):
    assert again(results.scenario) == results.scenario
    assert hash(again(results.scenario)) == hash(results.scenario)
    assert again(results.scenario).hash() == results.scenario.hash()
    _same(again(results), results)
    other = again(path)
    other.check()
    np.testing.assert_array_equal(other.prey.position, path.prey.position)
    assert list(other.prey.terms) == list(path.prey.terms)


@pytest.mark.parametrize("preset", ["delft/pronav-10", "m20/hawk", "lookout/aquarium", "sanitation/arena"])
def test_notebooks_show_small_sound_html(preset):
    scenario = tiswarm.load(preset, {"world.ticks": 5, "title": "A <b> & more"})
    shown = [scenario, tiswarm.simulate(scenario, 3), tiswarm.record(scenario)]
    for each in shown:
        html = each._repr_html_()
        tree = ElementTree.fromstring(html)
        assert "A <b> & more" in next(iter(tree)).text
        assert tree.find(".//{http://www.w3.org/2000/svg}svg") is not None
        assert tree.find(".//table") is not None
        assert len(html) < 100_000


def test_a_missing_extra_names_the_command():
    with pytest.raises(ImportError) as caught:
        extras.needed("data", "nothing_of_that_name")
    assert str(caught.value) == "nothing_of_that_name is not installed; pip install 'tiswarm[data]'"
    assert isinstance(caught.value, ValueError)  # which the command line tells in one line, with exit code 2


def _run(*arguments, without=()):
    """Run the command line as if some modules were not installed."""
    lost = "".join(f"sys.modules['{name}'] = None\n" for name in without)
    code = f"import sys\n{lost}from tiswarm.cli import main\nsys.argv = ['tiswarm', *{list(map(str, arguments))!r}]\nmain()"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=120)


def test_the_command_line_writes_each_format(tmp_path, command):
    for form, name in (("csv", "trials.csv"), ("parquet", "trials.parquet"), ("netcdf", "trials.nc")):
        words = ("--trials", 5, "--quiet", "-o", form, "--format", form)
        done = command("run", "delft/avoidance-10", *words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert (tmp_path / form / name).is_file()
        assert json.loads((tmp_path / form / "manifest.json").read_text())["trials"] == 5


@pytest.mark.parametrize(
    ("arguments", "without", "told"),
    [
        (("--format", "parquet"), (), "say where to write, with -o DIR"),
        (("--format", "excel", "-o", "OUT"), (), "use csv, parquet, netcdf"),
        (("--format", "parquet", "-o", "OUT"), ("pyarrow",), "pyarrow is not installed; pip install 'tiswarm[data]'"),
        (("--format", "netcdf", "-o", "OUT"), ("netCDF4",), "netCDF4 is not installed; pip install 'tiswarm[data]'"),
    ],
)
def test_a_format_that_cannot_be_gets_one_line(arguments, without, told, tmp_path):
    given = [tmp_path / "run" if each == "OUT" else each for each in arguments]
    done = _run("run", "delft/avoidance-10", "--trials", 5, *given, without=without)
    assert done.returncode == 2
    assert told in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "run").exists()


def test_importing_tiswarm_imports_none_of_the_extras():
    names = ["pandas", "xarray", "netCDF4", "pyarrow", "gymnasium", "pettingzoo"]
    begun = "import sys, tiswarm, render\ntiswarm.Results, tiswarm.Recording, tiswarm.study\n"
    code = f"{begun}print(set({names}) & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
