"""Tuning: what is found is validated on trials that nobody saw, kept, gone on with after a kill, refused where it differs."""

import json
import os
import random
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import tiswarm
from tiswarm.records.results import compare

QUICK = {"prey.strategy": "evasive", "prey.avoidance": "kitchen-sink", "world.ticks": 120}
SMALL = {"budget": 8 * 20 * 12, "candidates": 8, "trials": 20, "checks": 60, "validation": 150}
OVER = {"prey.goal": (0.01, 1.0, "log"), "prey.weights.evade": (0.0, 0.05)}


def _files(folder):
    return {f.relative_to(folder).as_posix(): f.read_bytes() for f in sorted(folder.rglob("*")) if f.suffix in (".npz", ".csv")}


@pytest.fixture
def scenario():
    return tiswarm.load("delft/pronav-10", QUICK)


def test_the_result_is_told_on_trials_of_its_own(scenario, f32):
    tuned = tiswarm.tune(scenario, OVER, seed=2, **SMALL)
    assert len(tuned.history) == 12
    before, after = (tiswarm.simulate(each, 150, 2) for each in (scenario, tuned.scenario))
    told = tuned.validations[0]
    assert told.start.mean == before.success.mean()
    assert told.tuned.mean == after.success.mean()
    assert told.difference == compare(before, after)["success"]
    assert tuned.improved
    assert tuned.best.score > tuned.best.start.mean()
    assert set(tuned.changes) == set(OVER)
    for path, (old, new) in tuned.changes.items():
        assert old == scenario.numbers()[path]
        assert new == tuned.scenario.numbers()[path]


def test_halving_spends_the_budget_on_more_generations(scenario, f32):
    tuned = tiswarm.tune(scenario, OVER, seed=2, halve=True, **SMALL)
    assert len(tuned.history) == 24
    for made in tuned.history:
        assert sorted(made.met.tolist()) == [5] * 4 + [10] * 2 + [20] * 2
        assert made.best == made.scores[made.met == 20].max()
    assert sum(made.met.sum() for made in tuned.history) == SMALL["budget"]


def test_a_weight_that_harms_is_taken_back(scenario, f32):
    harmed = scenario.replaced({"prey.goal": 0.012})
    tuned = tiswarm.tune(harmed, OVER, **SMALL)
    told = tuned.validations[0]
    assert told.difference.low > 0.05
    assert tuned.scenario.prey.goal > 0.05


def test_where_nothing_is_to_be_gained_the_start_stays(f32):
    still = tiswarm.load("delft/pronav-10", {**QUICK, "world.ticks": 1})
    tuned = tiswarm.tune(still, OVER, **SMALL)
    assert not tuned.improved
    assert tuned.changes == {}
    assert tuned.validations[0].difference.mean == 0.0
    assert tuned.scenario.hash() == still.hash()


def test_choices_race_each_other(scenario, f32):
    over = {"prey.strategy": ["baseline", "split", "evasive"], "prey.weights.evade": (0.0, 0.05), "prey.goal": (0.05, 0.5)}
    tuned = tiswarm.tune(scenario.replaced({"prey.strategy": "baseline"}), over, **SMALL)
    runs = [sum(made.arm_number == k for made in tuned.history) for k in range(3)]
    assert sum(runs) == 12
    assert len({made.arm_number for made in tuned.history[-4:]}) == 1
    assert tuned.scenario.prey.strategy in over["prey.strategy"]
    only = tiswarm.tune(scenario, {"prey.strategy": ["baseline", "evasive"]}, **SMALL)
    assert len(only.history) == 2
    assert only.scenario.prey.strategy == max(only.history, key=lambda made: made.check.score).arm.chosen[0][1]


def test_whole_numbers_stay_whole_and_several_scenarios_have_a_result_each(f32):
    over = {"predators.count": (2, 6), "prey.goal": (0.05, 0.5)}
    subjects = [tiswarm.load(name, {**QUICK, "world.ticks": 60}) for name in ("delft/pronav-10", "delft/centre-10")]
    tuned = tiswarm.tune(subjects, over, objective="-captured", across="worst", **SMALL)
    assert [each.title for each in tuned.validations] == ["delft/pronav-10", "delft/centre-10"]
    assert len({each.predators.count for each in tuned.scenarios}) == 1
    assert isinstance(tuned.scenario.predators.count, int)
    for made in tuned.history:
        count = made.arm.values(made.units)[:, 0]
        assert (count == np.round(count)).all()


def test_a_folder_holds_what_is_needed_to_run_it_again(scenario, tmp_path, f32):
    tuned = tiswarm.tune(scenario, OVER, folder=tmp_path, **SMALL)
    again = tiswarm.load(str(tmp_path / "best.toml"))
    assert again.hash() == tuned.scenario.hash()
    told = json.loads((tmp_path / "manifest.json").read_text())
    assert told["validation"][0]["tuned"]["mean"] == tuned.validations[0].tuned.mean
    assert told["tune"] == {"prey.goal": [0.01, 1.0, "log"], "prey.weights.evade": [0.0, 0.05]}
    rows = (tmp_path / "generations.csv").read_text().splitlines()
    assert len(rows) == 13
    assert rows[0].endswith("prey.goal,prey.weights.evade")
    before = _files(tmp_path)
    ran = []
    tiswarm.tune(scenario, OVER, folder=tmp_path, finished=ran.append, **SMALL)
    assert _files(tmp_path) == before
    tiswarm.tune(scenario, dict(reversed(OVER.items())), folder=tmp_path, **SMALL)  # no bit depends on the order of keys
    assert _files(tmp_path) == before
    np.testing.assert_array_equal([made.scores.max() for made in ran], [made.scores.max() for made in tuned.history])


def test_a_damaged_generation_is_run_again(scenario, tmp_path, f32):
    tiswarm.tune(scenario, OVER, folder=tmp_path, **SMALL)
    before = _files(tmp_path)
    (tmp_path / "generations" / "00003.npz").write_bytes(b"half")
    (tmp_path / "generations" / "00007.npz").unlink()
    (tmp_path / "generations" / ".00008.x.part.npz").write_bytes(b"left by a kill")
    tiswarm.tune(scenario, OVER, folder=tmp_path, **SMALL)
    assert _files(tmp_path) == before


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"over": {"prey.goal": (0.01, 2.0, "log")}}, 'prey.goal [0.01, 1.0, "log"], not [0.01, 2.0'),
        ({"seed": 5}, "seed 0, not 5"),
        ({"objective": "time"}, "maximise"),
        ({"trials": 10}, "trials 20, not 10"),
    ],
)
def test_the_folder_of_another_tuning_is_refused_and_kept(scenario, tmp_path, f32, change, told):
    tiswarm.tune(scenario, OVER, folder=tmp_path, **SMALL)
    before = _files(tmp_path)
    with pytest.raises(ValueError, match="holds another tuning") as error:
        tiswarm.tune(scenario, folder=tmp_path, **{"over": OVER, **SMALL, **change})
    assert told in str(error.value)
    assert "--fresh" in str(error.value)
    assert _files(tmp_path) == before
    (tmp_path / "manifest.json").write_text('{"study": "delft"}')
    with pytest.raises(ValueError, match="no manifest of a tuning"):
        tiswarm.tune(scenario, OVER, folder=tmp_path, **SMALL)
    assert _files(tmp_path) == before
    tiswarm.tune(scenario, OVER, folder=tmp_path, fresh=True, **SMALL)
    assert _files(tmp_path) == before


def _command(*arguments):
    return [sys.executable, "-m", "tiswarm", "tune", *map(str, arguments)]


KILLED = (
    "delft/pronav-10", "--set", "prey.strategy=evasive", "--set", "world.ticks=100", "--over", "prey.goal=0.01:1:log", "--over",
    "prey.weights.evade=0:0.05", "--budget", 24_000, "--candidates", 8, "--trials", 100,
    "--checks", 100, "--validation", 300,
)  # fmt: skip


@pytest.mark.parametrize("how", [("--halve",), ("--method", "openai-es")])
def test_kill_at_any_moment_leaves_the_same_bits(tmp_path, how, command, small_films):
    asked = (*KILLED, *how)
    assert command("tune", *asked, "-o", "whole", cwd=tmp_path).returncode == 0
    chance = random.Random(14)
    for k in range(4):
        run = subprocess.Popen(_command(*asked, "-o", tmp_path / "cut"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        folder, due = tmp_path / "cut" / "generations", chance.randint(7 * k, 7 * k + 6)
        begun = time.monotonic()
        while run.poll() is None and time.monotonic() - begun < 60 and len(list(folder.glob("[0-9]*.npz"))) < due:
            time.sleep(0.005)
        if run.poll() is None:
            os.kill(run.pid, signal.SIGKILL)
            run.wait()
    assert command("tune", *asked, "--film", "-o", "cut", cwd=tmp_path).returncode == 0
    assert (tmp_path / "cut" / "film.mp4").stat().st_size > 10_000
    whole, cut = _files(tmp_path / "whole"), _files(tmp_path / "cut")
    assert whole.keys() == cut.keys()
    assert whole == cut
    assert (tmp_path / "whole" / "best.toml").read_text() == (tmp_path / "cut" / "best.toml").read_text()
    assert {each.name for each in (tmp_path / "cut").glob("*.png")} == {"progress.png", "sensitivity.png", "candidates.png"}


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((), "name a key"),
        (("--over", "prey.goal=1:0"), "lower to a higher"),
        (("--over", "prey.goal=0:1", "--budget", 0), "do not pay one generation"),
        (("--over", "prey.goal=0:1", "--candidates", 2), "too few to rank"),
        (("--over", "prey.goal=0:1", "--trials", 0), "use 1 or more"),
        (("--over", "prey.goal=0:1", "--validation", 1), "validation of 1 trials"),
        (("--over", "prey.goal=0:1", "--over", "prey.goal=0:2"), "named twice"),
        (("--over", "prey.goal=0:1", "--across", "median"), "use 'mean' or 'worst'"),
        (("--over", "prey.goal=0:1", "--maximise", "time", "--minimise", "time"), "use one of them"),
        (("--over", "prey.goal=0:1", "--minimise", "succes"), "did you mean 'success'"),
        (("--over", "prey.strategy=evasive,nobody"), "unknown 'nobody'"),
        (("--over", "prey.goal=0:1", "--also", "delft/pronav-99"), "unknown 'delft/pronav-99'"),
        (("--over", "prey.perception=-3:4"), "prey.perception"),
        (("--over", "prey.goal=0:1", "--method", "nes"), "use 'cma-es' or 'openai-es'"),
        (("--over", "prey.goal=0:1", "--method", "openai-es", "--candidates", 7), "is odd"),
        (("--over", "prey.goal=0:1", "--halve", "--trials", 3), "too few to part"),
        (("--over", "prey.strategy=0:1"), "is no number"),
        (("--network", "prey"), "add --set prey.strategy=neural"),
        (("--network", "preys"), "use prey or predators"),
    ],
)
def test_wrong_input_is_one_line_and_exit_code_2(tmp_path, arguments, told, command):
    run = command("tune", "delft/pronav-10", *arguments, "-o", tmp_path / "out", cwd=tmp_path)
    assert run.returncode == 2
    assert told in run.stderr
    assert len(run.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_a_missing_library_names_the_mend(scenario, monkeypatch, f32):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"pip install 'tiswarm\[tune\]'"):
        tiswarm.tune(scenario, OVER, **SMALL)
