"""Plots: the files that appear, what their axes say, and what the command line complains about."""

import importlib.util
import os
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np
import pytest
from PIL import Image

import tiswarm
from render.plots import figure, time_series

FILES = ["positions.png", "velocities.png", "neighbours.png", "velocity-sum.png"]

CASES = {
    "sanitation/arena": ({"world.ticks": 40}, 2),
    "sanitation/potential": ({"world.ticks": 40, "measures.after": 0}, 2),
    "m20/hawk": ({"world.ticks": 20}, 2),
    "lookout/aquarium": ({"world.ticks": 10, "prey.count": 120}, 3),
    "delft/pronav-10": ({}, 2),
}


@pytest.fixture
def drawn(monkeypatch):
    """Keep every figure as it was when it was written: [(labels of y, label of x, legend, lines of the first panel)]."""
    kept = []
    close = plt.close

    def note(figure):
        panels = figure.axes
        names = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
        labels = [axis.get_ylabel() for axis in panels]
        kept.append((labels, panels[-1].get_xlabel(), names, [line.get_xydata() for line in panels[0].lines]))
        close(figure)

    monkeypatch.setattr(plt, "close", note)
    return kept


@pytest.mark.parametrize("preset", CASES)
def test_every_preset_gets_its_plots_with_labels_and_units(preset, tmp_path, drawn):
    settings, dim = CASES[preset]
    scenario = tiswarm.load(preset, settings)
    grid = bool(scenario.coverage.cell)
    recordings = [tiswarm.record(scenario, trial) for trial in range(3 if grid else 1)]
    files = time_series.draw(recordings, tmp_path)
    assert [file.name for file in files] == FILES + ["coverage.png"] * grid
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted(file.name for file in files)  # nothing half-written
    for file in files:
        width, height = Image.open(file).size
        assert width == 8 * figure.DPI
        assert height > 500
    axes = "xyz"[:dim]
    assert [labels for labels, *_ in drawn[:4]] == [
        [f"{axis} position [m]" for axis in axes],
        [f"{axis} velocity [m/s]" for axis in axes],
        ["distance to the nearest neighbour [m]"],
        ["sum of the prey's velocities [m/s]"],
    ]
    assert {time for _, time, *_ in drawn} == {"time [s]"}
    assert all(names for _, _, names, _ in drawn)


def test_lines_are_the_recording(tmp_path, drawn):
    recording = tiswarm.record(tiswarm.load("sanitation/potential", {"world.ticks": 30, "measures.after": 0}))
    time_series.draw([recording], tmp_path)
    lines = drawn[0][3]
    assert len(lines) == 6
    np.testing.assert_allclose(lines[2][:, 1], recording.prey.position[:, 2, 0])
    np.testing.assert_allclose(lines[2][:, 0], np.arange(31) * 0.01)
    assert drawn[0][2] == [f"prey {k}" for k in range(1, 7)]
    total = drawn[3][3][1]  # behind the line at zero
    np.testing.assert_allclose(total[:, 1], recording.prey.velocity[:, :, 0].sum(axis=1))


def test_paths_are_broken_at_periodic_edges(tmp_path, drawn):
    recording = tiswarm.record(tiswarm.load("m20/two-swallows"))
    time_series.draw([recording], tmp_path)
    for line in drawn[0][3]:
        steps = np.abs(np.diff(line[:, 1]))
        assert np.nanmax(steps) < 1
        assert np.isnan(steps).any()


def test_coverage_shows_trials_their_mean_and_when_it_passed_a_half(tmp_path, drawn):
    scenario = tiswarm.load("sanitation/arena", {"world.ticks": 60, "coverage.tool": 0.5})
    recordings = [tiswarm.record(scenario, trial) for trial in range(3)]
    time_series.draw(recordings, tmp_path)
    *trials, mean, marks = drawn[4][3]
    assert len(trials) == 3
    np.testing.assert_allclose(mean[:, 1], np.mean([line[:, 1] for line in trials], axis=0))
    assert marks[0, 1] == 50
    assert drawn[4][2][:2] == ["one trial each", "mean"]
    assert drawn[4][2][2].startswith("50 % after ")


def test_one_robot_has_plots_too(tmp_path, drawn):
    time_series.draw([tiswarm.record(tiswarm.load("sanitation/arena", {"world.ticks": 5, "prey.count": 1}))], tmp_path)
    assert len(drawn) == 5


def test_without_matplotlib_one_line_says_how_to_get_it(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'tiswarm\[plot\]'"):
        time_series.check_matplotlib()


def test_run_writes_plots_where_they_belong(tmp_path, command):
    short = ("--trials", 2, "--set", "world.ticks=10", "--plot")
    done = command("run", "sanitation/arena", *short, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert {file.name for file in (tmp_path / "out" / "sanitation-arena").iterdir()} == {*FILES, "coverage.png"}
    assert "out/sanitation-arena/coverage.png" in done.stdout.replace(os.sep, "/")
    done = command("run", "m20/two-swallows", *short, "-o", tmp_path / "own", "--json", cwd=tmp_path)
    assert done.stdout.startswith("{")
    assert {file.name for file in (tmp_path / "own").iterdir()} == {*FILES, "trials.csv", "summary.json", "manifest.json"}


def test_wrong_input_is_told_in_one_line(tmp_path, command):
    (tmp_path / "file").write_text("")
    done = command("run", "m20/hawk", "--plot", "-o", tmp_path / "file" / "plots", cwd=tmp_path)
    assert done.returncode in (1, 2)
    assert len(done.stderr.splitlines()) == 1
    hidden = "import importlib.util as u; find = u.find_spec; u.find_spec = lambda name, *a: None if name == 'matplotlib' else "
    hidden += "find(name, *a)\nimport sys, tiswarm.__main__ as m; sys.argv[0] = 'tiswarm'; m.main()"
    line = [sys.executable, "-c", hidden, "run", "m20/hawk", "--plot", "--trials", "2"]
    done = subprocess.run(line, capture_output=True, text=True, cwd=tmp_path, timeout=300, env=os.environ, check=False)
    assert done.returncode == 2
    assert done.stderr == "tiswarm: --plot: plots need matplotlib; pip install 'tiswarm[plot]'\n"
    assert not (tmp_path / "out").exists()


def test_titles_of_plots_run_from_right_to_left(tmp_path):
    """Of four thin letters and a broad one, the broad one is read last, and stands leftmost."""
    path = tmp_path / "title.png"
    with figure.sheet(1, 1, (4, 3), path, "\N{HEBREW LETTER VAV} " * 4 + "\N{HEBREW LETTER SHIN}"):
        pass
    ink = (np.asarray(Image.open(path).convert("L")) < 128)[:36].any(axis=0)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], ink, [0]])))
    widths = edges[1::2] - edges[::2]
    assert len(widths) == 5
    assert widths.argmax() == 0
