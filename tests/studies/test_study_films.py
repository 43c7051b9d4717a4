"""Films of a study's trials: what is filmed is the trial that was counted."""

import numpy as np

from tiswarm.studies.design import MEASURES
from tiswarm.studies.run import columns_of, run_study
from tiswarm.studies.store import read_cell, read_manifest


def test_a_film_of_a_counted_trial_shows_the_outcome_that_was_counted(study, tmp_path, f32):
    from tiswarm.cli.rerun import Rebuilt

    run_study(str(study), seed=4, folder=tmp_path / "o")
    rebuilt = Rebuilt(tmp_path / "o" / "manifest.json")
    for number in (0, 5):
        held = read_cell(tmp_path / "o", read_manifest(tmp_path / "o" / "manifest.json"), number, columns_of(MEASURES))
        picks = [rebuilt.picked(number, pick) for pick in ("worst", "median", "best")]
        success = [held["success"][trial] for trial in picks]
        assert success == [held["success"].min(), np.sort(held["success"])[::-1][10], held["success"].max()]
        for trial in (*picks, 7):
            recording = rebuilt.record(number, trial)
            assert (recording.prey.fate == "arrived").mean() == held["success"][trial]
            assert recording.ticks == held["ticks"][trial]
    (tmp_path / "o" / "cells" / "00005.npz").unlink()  # run again instead of read
    assert rebuilt.picked(5, "worst") == picks[0]


def test_the_command_line_films_it_and_refuses_what_cannot_be(study, tmp_path, bench, command):
    assert bench(study, "-o", "o", "--quiet", "--figures", "none", cwd=tmp_path).returncode == 0

    asked = ("o/manifest.json", "--cell", 3, "--worst", "-o", "x.mp4", "--size", "320x180", "--fps", 10, "--speed", 40)
    done = command("film", *asked, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "cell 3 (0.1/6), trial" in done.stdout
    assert (tmp_path / "x.mp4").stat().st_size > 1000
    for arguments, said in (
        (("o/manifest.json",), "--cell"),
        (("o/manifest.json", "--cell", "8"), "cells 0 to 7"),
        (("o/manifest.json", "--cell", "1", "--trial", "20"), "trials 0 to 19"),
        (("o/manifest.json", "--cell", "1", "--best", "--worst"), "use one"),
        (("o/manifest.json", "--cell", "1", "--seed", "3"), "drop"),
        (("delft/pronav-10", "--cell", "1"), "no manifest"),
        (("p/manifest.json", "--cell", "1"), "no such file"),
    ):
        done = command("film", *arguments, cwd=tmp_path)
        assert (done.returncode, len(done.stderr.strip().splitlines())) == (2, 1)
        assert said in done.stderr
