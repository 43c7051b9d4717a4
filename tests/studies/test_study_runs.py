"""Studies: cells on axes, kept on disk, gone on with after a kill, refused where they do not match, and filmed."""

import csv
import json
import pickle
import random
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import tiswarm
from tiswarm.studies.design import cells, load_study
from tiswarm.studies.export import write
from tiswarm.studies.run import run_study

MIXED = """
title = "Hunted or not"
measures = ["success", "captured"]
trials = 30
[[tables]]
name = "calm"
title = "No predators"
base = "delft/avoidance-10"
key = "prey.avoidance"
values = ["spiral", "kitchen-sink"]
[[tables]]
name = "hunted"
title = "Predators"
base = "delft/pronav-10"
axes = [{ key = "prey.strategy", values = ["evasive", "split"] }, { key = "predators.strategy", values = ["centre", "pronav"] }]
"""


def test_each_cell_is_what_its_scenario_gives_on_its_own(study, f32):
    report = run_study(str(study), seed=3)
    assert [row.cell.point for row in report.rows][:2] == [
        {"prey.goal": 0.05, "prey.count": 2},
        {"prey.goal": 0.05, "prey.count": 6},
    ]
    for row in report.rows[::3]:
        alone = tiswarm.simulate(tiswarm.load("delft/avoidance-10", {"world.ticks": 120, **row.cell.point}), 20, seed=3)
        np.testing.assert_array_equal(row.values("success"), alone.success)
        np.testing.assert_array_equal(row.outcomes["ticks"], alone.ticks)


def test_scenarios_that_cannot_share_a_kernel_run_apart_and_stand_in_their_order(tmp_path, f32):
    (tmp_path / "m.toml").write_text(MIXED)
    report = run_study(str(tmp_path / "m.toml"))
    assert [row.cell.row for row in report.rows] == [
        *("spiral", "kitchen-sink"),
        *("evasive/centre", "evasive/pronav", "split/centre", "split/pronav"),
    ]
    assert [len(table) for table in report.tables] == [2, 4]
    alone = tiswarm.simulate(tiswarm.load("delft/centre-10", {"prey.strategy": "split"}), 30)
    np.testing.assert_array_equal(report.rows[4].outcomes["captured"], alone.captured)


def test_independent_cells_have_seeds_of_their_own(study, f32):
    study.write_text(study.read_text().replace("trials = 20", "trials = 20\nindependent = true"))
    found = cells(str(study), load_study(str(study)), seed=1)
    assert len({cell.seed for cell in found}) == 8
    report = run_study(str(study), seed=1, overrides={"prey.count": 3})
    alone = tiswarm.simulate(report.rows[5].cell.scenario, 20, found[5].seed)
    np.testing.assert_array_equal(report.rows[5].values("time"), alone.time)


def test_tables_are_tidy_and_the_manifest_says_what_was_computed(study, tmp_path, bench):
    done = bench(study, "-o", "o", "--per-trial", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader((tmp_path / "o" / "cells.csv").open()))
    assert list(rows[0])[:6] == ["cell", "prey.goal", "prey.count", "n", "success", "success_stderr"]
    assert len(rows) == 8
    trials = list(csv.DictReader((tmp_path / "o" / "trials.csv").open()))
    assert len(trials) == 160
    share = np.mean([float(row["success"]) for row in trials if row["cell"] == "3"])
    assert float(rows[3]["success"]) == pytest.approx(share)
    assert all(float(row["success_low"]) <= float(row["success"]) <= float(row["success_high"]) for row in rows)
    told = json.loads((tmp_path / "o" / "manifest.json").read_text())
    assert "Wilson" in told["computed"]["share"]
    assert told["correlations"][0]["n"] == 8
    assert "Spearman" in done.stdout
    assert "Holm" in done.stdout
    pairs = list(csv.DictReader((tmp_path / "o" / "pairs.csv").open()))
    assert len(pairs) == 7 * 3
    assert (tmp_path / "o" / "s-pairs.png").exists()


def test_parquet_holds_what_the_csv_holds(study, tmp_path, f32):
    parquet = pytest.importorskip("pyarrow.parquet")
    write(run_study(str(study)), tmp_path, per_trial=True, parquet=True)
    for name in ("cells", "trials"):
        table = parquet.read_table(tmp_path / f"{name}.parquet")
        lines = list(csv.DictReader((tmp_path / f"{name}.csv").open()))
        assert table.num_rows == len(lines)
        assert table.column_names == list(lines[0])
        assert [str(value) for value in table.column("prey.goal").to_pylist()] == [line["prey.goal"] for line in lines]


def _kept(folder):
    return len(list(folder.glob("cells/[0-9]*.npz")))


def test_killed_at_twenty_random_moments_it_ends_with_the_same_bytes(study, tmp_path, bench):
    study.write_text(study.read_text().replace("steps = 4", "steps = 60").replace("figures = [", "figures = [] #"))
    options = ("--per-trial", "--quiet", study)
    assert bench("-o", "whole", *options, cwd=tmp_path).returncode == 0
    names = ("cells.csv", "trials.csv")
    whole = {name: (tmp_path / "whole" / name).read_bytes() for name in names}
    rng, kills, cut, round_ = random.Random(6), 0, 0, 0
    while kills < 20:
        folder = tmp_path / f"killed-{round_}"
        before = _kept(folder)
        process = subprocess.Popen(
            [sys.executable, "-m", "tiswarm", "bench", "-o", folder.name, *map(str, options)],
            cwd=tmp_path,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )
        if rng.random() < 0.5:  # anywhere, from the first import on
            time.sleep(rng.uniform(0.0, 1.6))
        else:  # once some more cells are there
            wanted = before + rng.randrange(1, 9)
            while process.poll() is None and _kept(folder) < min(wanted, 120):
                time.sleep(0.002)
            time.sleep(rng.choice((0.0, 0.0, 0.001, 0.005)))
        process.send_signal(signal.SIGKILL)  # exactly the one that was started, if it still runs
        _, complaint = process.communicate(timeout=30)
        kills += 1
        assert process.returncode in (0, -signal.SIGKILL), complaint
        done = _kept(folder)
        assert done >= before
        cut += before < done < 120
        if done == 120:
            assert bench("-o", folder.name, *options, cwd=tmp_path).returncode == 0
            assert {name: (folder / name).read_bytes() for name in names} == whole
            round_ += 1
    assert cut  # some were hit between two cells
    folder = tmp_path / f"killed-{round_}"
    assert bench("-o", folder.name, *options, cwd=tmp_path).returncode == 0
    assert {name: (folder / name).read_bytes() for name in names} == whole
    assert not list(folder.rglob("*.part*"))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"seed": 1}, "holds seed 0, not 1"),
        ({"trials": 21}, "holds 20 trials a cell, not 21"),
        ({"overrides": {"prey.spacing": 2.0}}, "other cells or scenarios"),
    ],
)
def test_another_run_is_refused_with_the_mend(study, tmp_path, change, said, f32):
    run_study(str(study), folder=tmp_path / "o")
    with pytest.raises(ValueError, match=f"{said}.*--fresh"):
        run_study(str(study), folder=tmp_path / "o", **change)
    assert run_study(str(study), folder=tmp_path / "o").ran == 0
    assert run_study(str(study), folder=tmp_path / "o", fresh=True, **change).ran == 8


def test_other_precision_version_and_code_are_refused(study, tmp_path, f32):
    run_study(str(study), folder=tmp_path / "o")
    place = tmp_path / "o" / "manifest.json"
    for key, said in (("precision", "f16"), ("tiswarm", "0.0.1"), ("code", "state of the code")):
        told = json.loads(place.read_text())
        place.write_text(json.dumps({**told, key: "f16" if key == "precision" else "0.0.1"}))
        with pytest.raises(ValueError, match=f"{said}.*--fresh"):
            run_study(str(study), folder=tmp_path / "o")
        place.write_text(json.dumps(told))
    for broken in ("{", "[]", '{"seed": 0}'):
        place.write_text(broken)
        with pytest.raises(ValueError, match=r"no manifest.*--fresh"):
            run_study(str(study), folder=tmp_path / "o")


def test_cells_that_are_broken_or_of_nobody_are_run_again(study, tmp_path, f32):
    first = run_study(str(study), folder=tmp_path / "o")
    (tmp_path / "o" / "cells" / "00002.npz").write_bytes(b"half")
    (tmp_path / "o" / "cells" / "00005.npz").unlink()
    with pytest.warns(UserWarning, match="1 of 8 cells were damaged"):
        again = run_study(str(study), folder=tmp_path / "o")
    assert again.ran == 2
    assert again.cells() == first.cells()
    (tmp_path / "o" / "manifest.json").unlink()  # as when --fresh is killed after its first step
    assert run_study(str(study), folder=tmp_path / "o").ran == 8


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('key = "prey.count"', 'key = "prey.cuont"', "prey.cuont: unknown key"),
        ("values = [2, 6]", "values = [0, 6]", "prey.count: 0 is not allowed"),
        ('y = "time"', 'y = "tmie"', "did you mean 'time'"),
        ('x = "prey.goal"', 'x = "prey.gaol"', "did you mean 'prey.goal'"),
        ('base = "delft/avoidance-10"', "", "tables"),
        ("trials = 20", 'trials = 20\nmeasures = ["sucess"]\ncorrelate = []', "did you mean 'success'"),
        ("trials = 20", "trials = 20\nsampels = 3", "did you mean 'samples'"),
        ("steps = 4", "stpes = 4", "did you mean 'steps'"),
    ],
)
def test_a_wrong_study_is_refused_in_one_line(study, old, new, said, f32):
    text = study.read_text().replace(old, new)
    if "correlate = []" in text:
        text = text[: text.index("[correlate]")]
    study.write_text(text)
    with pytest.raises(tiswarm.ScenarioError, match=said) as caught:
        run_study(str(study))
    assert "\n" not in str(caught.value)


def test_a_study_asks_for_what_it_reports_and_leaves_out_trials_without_a_value(tmp_path, f32):
    text = 'title = "w"\nbase = "sanitation/boids"\ntrials = 4\nmeasures = ["polarisation", "milling", "time-to-90"]\n'
    text += 'set = { "world.ticks" = 40, "prey.count" = 8 }\ncombine = "latin"\nsamples = 5\n'
    text += '[[axes]]\nkey = "prey.alignment"\nlow = 0.01\nhigh = 0.5\n[correlate]\nx = "prey.alignment"\ny = "polarisation"\n'
    (tmp_path / "w.toml").write_text(text)
    report = run_study(str(tmp_path / "w.toml"), folder=tmp_path / "o")
    assert "milling" in report.rows[0].cell.scenario.measures.names  # which the preset does not measure
    lines = report.cells()
    assert [line["time-to-90_n"] for line in lines] == [0] * 5  # nobody sweeps so much in 40 ticks
    assert all(0 < line["polarisation"] < 1 for line in lines)
    assert report.correlations[0].n == 5
    write(report, tmp_path / "o")
    assert ",,,,0\n" in (tmp_path / "o" / "cells.csv").read_text()
    assert run_study(str(tmp_path / "w.toml"), folder=tmp_path / "o").cells()[2]["milling"] == lines[2]["milling"]


def test_a_small_game_from_cells_to_mixtures(tmp_path, f32):
    from tiswarm.studies.payoffs import contest

    text = 'title = "g"\nbase = "delft/pronav-10"\ntrials = 60\n[game]\nprey = ["prey.strategy"]\n'
    text += 'predators = ["predators.strategy", "predators.weights.labels"]\n'
    text += '[[axes]]\nkey = "prey.strategy"\nvalues = ["baseline", "explode", "split"]\n'
    text += '[[axes]]\nkey = ["predators.strategy", "predators.weights.labels"]\n'
    text += 'values = [["centre"], ["pronav"], ["cluster", "kept"]]\n'
    (tmp_path / "g.toml").write_text(text)
    report = run_study(str(tmp_path / "g.toml"))
    played = contest(report)
    assert (played.rows, played.columns) == (["baseline", "explode", "split"], ["centre", "pronav", "cluster/kept"])
    assert played.payoff[2, 1] == report.rows[7].values("success").mean()
    assert report.keys == ["prey.strategy", "predators.strategy", "predators.weights.labels"]
    assert [line["predators.weights.labels"] for line in report.cells()[:3]] == [None, None, "kept"]
    told = json.loads(played.to_json())
    assert told["value"]["low"] <= told["value"]["mean"] <= told["value"]["high"]
    assert sum(each["share"] for each in told["prey"].values()) == pytest.approx(1)
    assert "baseline" in told["dominated"]["rows"]


def test_a_study_in_python_gives_frames_of_its_cells_and_trials(study, f32):
    report = tiswarm.study(study, trials=6, seed=3, overrides={"world.ticks": 60})
    cells, trials = report.to_pandas(), report.to_pandas(per_trial=True)
    assert cells.index.name == "cell"
    assert len(cells) == 8
    assert len(trials) == 48
    assert cells.loc[5, "prey.count"] == report.rows[5].cell.point["prey.count"]
    for number, row in enumerate(report.rows):
        assert cells.loc[number, "success"] == row.estimate("success").mean
        np.testing.assert_array_equal(trials.loc[number, "success"], row.outcomes["success"])
    assert (trials.loc[3, "prey.goal"] == report.rows[3].cell.point["prey.goal"]).all()
    assert "8 cells of 6 trials" in report._repr_html_()
    again = pickle.loads(pickle.dumps(report))
    assert again.to_pandas().equals(cells)


def test_the_learned_table_has_each_strategy_by_hand_and_tuned_beside_networks_that_ship_in_every_world():
    every = cells("delft-learned", load_study("delft-learned"), 0)
    names = list(dict.fromkeys(cell.point["name"] for cell in every))
    worlds = {cell.point["base"] for cell in every}
    assert (len(every), len(worlds)) == (len(names) * 6, 6)
    by_hand = [name for name in names if f"{name}, tuned" in names]
    assert len(by_hand) == 7
    led = [cell for cell in every if cell.point["name"] not in {*by_hand, *(f"{name}, tuned" for name in by_hand)}]
    assert len(led) == 12
    assert all(cell.scenario.network("prey") is not None for cell in led)
    assert len({cell.scenario.hash() for cell in every}) == len(every)
