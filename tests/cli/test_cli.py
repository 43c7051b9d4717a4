"""The command line as a user meets it: exit codes, single lines of complaint, and a process of its own where that matters."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

import tiswarm


def _run(*arguments, cwd=None, timeout=120, **environment):
    return subprocess.run(
        [sys.executable, "-m", "tiswarm", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=cwd,
        timeout=timeout,
        env={**os.environ, **environment},
        check=False,
    )


VERBS = ("presets", "show", "demo", "film", "run", "bench", "speed")


@pytest.mark.parametrize("verb", VERBS)
def test_each_verb_has_help(verb, tmp_path, command):
    done = command(verb, "--help", cwd=tmp_path)
    assert done.returncode == 0
    assert "--help" in done.stdout
    for option in ("--seed", "--threads", "--precision", "--quiet"):
        assert option in done.stdout


def test_without_a_verb_it_shows_help():
    done = _run()
    assert done.returncode == 0
    assert all(verb in done.stdout for verb in VERBS)


def test_presets_lists_presets_studies_and_strategies(tmp_path, command):
    listed = command("presets", cwd=tmp_path).stdout
    for name in ("delft/pronav-10", "demo/chase", "split-evasive", "kitchen-sink", "pronav", "Studies"):
        assert name in listed


def test_show_prints_a_preset_that_loads_again(tmp_path, command):
    done = command("show", "delft/pronav-10", "--set", "prey.strategy=evasive", "--set", "prey.count=5", cwd=tmp_path)
    (tmp_path / "own.toml").write_text(done.stdout)
    scenario = tiswarm.load(str(tmp_path / "own.toml"))
    assert (scenario.prey.strategy, scenario.prey.count, scenario.prey.weights["evade"]) == ("evasive", 5, 0.01)


def test_show_prints_the_schema(tmp_path, command):
    assert "prey" in json.loads(command("show", "--schema", cwd=tmp_path).stdout)["properties"]


def test_run_gives_the_summary_as_json_and_saves_it(tmp_path):
    done = _run("run", "delft/avoidance-10", "--trials", 50, "--seed", 4, "--json", "-o", tmp_path / "r")
    expected = tiswarm.simulate(tiswarm.load("delft/avoidance-10"), 50, seed=4).summary()["success"].mean
    assert json.loads(done.stdout)["summary"]["success"]["mean"] == pytest.approx(expected)
    assert done.stderr == ""
    assert {file.name for file in (tmp_path / "r").iterdir()} == {"trials.csv", "summary.json", "manifest.json"}


@pytest.mark.anew
def test_the_command_line_gives_the_bits_that_the_library_gives_at_any_number_of_threads(tmp_path, command):
    asked = ("run", "delft/pronav-10", "--trials", 40, "--json", "--threads")
    one, two = (command(*asked, n, cwd=tmp_path) for n in (1, 2))
    assert (one.returncode, two.returncode) == (0, 0)
    assert one.stdout == two.stdout


def test_bench_writes_rows_a_manifest_and_charts(tmp_path):
    done = _run("bench", "delft", "--trials", 20, "-o", tmp_path, "--quiet")
    assert done.returncode == 0, done.stderr
    assert "root mean square" in done.stdout
    assert len((tmp_path / "rows.csv").read_text().splitlines()) == 47
    manifest = json.loads((tmp_path / "manifest.json").read_text())
    told = {"tiswarm", "taichi", "precision", "machine", "scenario_hash", "seed", "trials", "wall_time_s"}
    assert told <= set(manifest)
    assert {file.stem for file in tmp_path.glob("*.png")} >= {f"figure-{n}" for n in range(6, 12)}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("run", "delft/pronav-1"), "did you mean 'delft/pronav-10'"),
        (("run", "nowhere.toml"), "cannot be read"),
        (("run", "delft/pronav-10", "--set", "prey.count=0"), "prey.count: 0 is not allowed; use 1 or more"),
        (("run", "delft/pronav-10", "--set", "prey.strategy=explod"), "did you mean 'explode'?"),
        (("run", "delft/pronav-10", "--set", "prey.count"), "write KEY=VALUE"),
        (("run", "delft/pronav-10", "--trials", "0"), "trials"),
        (("run", "delft/pronav-10", "--trials", "many"), "--trials"),
        (("run", "delft/pronav-10", "--threads", "0"), "threads"),
        (("run", "delft/pronav-10", "--precision", "f16"), "f32"),
        (("run", "delft/pronav-10", "--seed", "-1"), "seed"),
        (("run", "delft/pronav-10", "--strategy-path", "/"), "prey, predators or avoidance"),
        (("run", "--trails", "5"), "--trails"),
        (("run",), "PRESET"),
        (("show",), "name a preset"),
        (("show", "delft/pronav-10", "--set", "a.b=1"), "a: unknown key"),
        (("bench", "delfd"), "did you mean 'delft'"),
        (("bench", "delft", "--trials", "-4"), "--trials"),
        (("bench", "delft", "--seed", "-1"), "seed"),
        (("bench", "delft", "--figures", "bras"), "did you mean 'bars'"),
        (("bench", "delft", "--set", "prey.cuont=3"), "did you mean 'count'"),
        (("film", "delft/pronav-10", "--size", "big"), "for example --size 1280x720"),
        (("film", "delft/pronav-10", "--trial", "-1"), "trial"),
        (("film", "nothing.npz"), "no such file"),
        (("film", "delft/pronav-10", "--theme", "pink"), "dark"),
        (("film", "delft/pronav-10", "--camera", "1,2,3"), "x0,y0,x1,y1"),
        (("film", "delft/pronav-10", "--overlay", "perceptoin"), "perception"),
        (("film", "delft/pronav-10", "--versus", "evasive"), "two prey strategies"),
        (("film", "delft/pronav-10", "--versus", "evasive,explod"), "did you mean 'explode'?"),
        (("film", "delft/pronav-10", "--for", "cinema"), "--for: unknown 'cinema'; use one of slide, square, phone, paper"),
        (("film", "delft/pronav-10", "--label", "a"), "--label a: write agents' numbers"),
        (("film", "delft/pronav-10", "--chart", "beauty"), "chart: unknown 'beauty'; use any of alive"),
        (("film", "delft/pronav-10", "--subtitles", "x.srt"), "name a file that ends in .vtt"),
        (("film", "delft/pronav-10", "--subtitles", "x.vtt", "--grid", "2x1"), "--subtitles: needs one recorded trial"),
        (("film", "delft/pronav-10", "--among", "5", "--grid", "2x1"), "--among: needs one trial of a preset"),
        (("film", "delft/pronav-10", "--grid", "4"), "--grid 4x4"),
        (("film", "delft/pronav-10", "--speed", "0"), "speed"),
        (("film", "delft/pronav-10", "--fps", "0"), "fps"),
        (("film", "delft/pronav-10", "--quality", "superb"), "good"),
        (("film", "delft/pronav-10", "-o", "x.avi"), "avi"),
        (("film", "delft/pronav-10", "--size", "641x360"), "642x360"),
        (("demo", "chaise"), "did you mean"),
        (("spead",), "spead"),
        (("speed", "--precision", "x"), "f32"),
        (("presets", "--loud"), "--loud"),
    ],
)
def test_wrong_input_gets_one_line_and_exit_code_2(arguments, said, tmp_path, command):
    done = command(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_a_broken_recording_gets_one_line(tmp_path, command):
    (tmp_path / "x.npz").write_bytes(b"not one")
    done = command("film", "x.npz", cwd=tmp_path)
    assert done.returncode == 2
    assert "not a recording" in done.stderr
    assert [file.name for file in tmp_path.iterdir()] == ["x.npz"]


def test_an_unwritable_place_gets_one_line(tmp_path, command):
    (tmp_path / "out").write_text("a file where a folder must be")
    for verb in (("run", "delft/avoidance-10", "--trials", 5, "-o", "out"), ("bench", "delft", "--trials", 2), ("demo",)):
        done = command(*verb, cwd=tmp_path)
        assert done.returncode == 1, verb
        assert "out" in done.stderr
        assert len(done.stderr.strip().splitlines()) == 1
    assert [file.name for file in tmp_path.iterdir()] == ["out"]


FULL = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
import tiswarm.cli
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
sys.argv = ["tiswarm", "run", "delft/avoidance-10", "--trials", "2000", "-o", "r"]
tiswarm.cli.main()
"""


def test_a_full_disk_gets_one_line_and_leaves_no_part(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", FULL],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        # Taichi writes the list of a folder's kernels all the same, and what is cut short of it throws all of them away.
        env={**os.environ, "TI_OFFLINE_CACHE": "0", "TI_OFFLINE_CACHE_FILE_PATH": str(tmp_path / "kernels")},
        check=False,
    )
    assert done.returncode == 1, done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert not list(tmp_path.rglob("*trials*"))


@pytest.mark.parametrize("after", [0.8, 2.5, 4.0])
def test_ctrl_c_ends_with_130_and_nothing_half_written(after, tmp_path):
    arguments = [sys.executable, "-m", "tiswarm", "run", "delft/pronav-10", "--trials", "3000000", "-o", "r"]
    process = subprocess.Popen(arguments, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    time.sleep(after)
    process.send_signal(signal.SIGINT)
    _, complaint = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted" in complaint
    assert "Traceback" not in complaint
    assert list(tmp_path.iterdir()) == []
