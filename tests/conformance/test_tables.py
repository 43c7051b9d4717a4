"""The 46 published rows; `tiswarm bench delft --trials 10000` is the same check with ten times the trials."""

import numpy as np
import pytest

from tiswarm.studies.design import load_study
from tiswarm.studies.export import against_published
from tiswarm.studies.run import run_study

pytestmark = pytest.mark.usefixtures("f32")


@pytest.fixture(scope="module")
def report():
    return run_study("delft")


def test_the_study_has_all_46_rows_with_published_figures(report):
    assert len(report.rows) == 46
    assert all(set(row.published) == {"success", "time", "impact_spread"} for row in report.rows)


def test_every_row_agrees_with_the_published_one(report):
    for row in report.rows:
        for measure in ("success", "time"):
            assert abs(row.z(measure)) <= 3.5, f"{row.cell.table.name}/{row.cell.row} {measure}"


def test_the_rows_agree_as_a_whole(report):
    rms, _ = report.z_summary(("success", "time"))
    assert rms <= 1.25


def test_z_uses_both_standard_errors(report):
    row = report.rows[0]
    values = row.values("success")
    ours = values.std(ddof=1) / np.sqrt(len(values))
    theirs = 1.35 * values.std(ddof=1) / np.sqrt(1000)
    assert row.z("success") == pytest.approx((values.mean() - row.published["success"]) / np.hypot(ours, theirs))


def test_the_csv_has_one_line_a_row(report):
    lines = against_published(report).splitlines()
    assert len(lines) == 47
    assert lines[0].startswith("table,row,trials,success,success_stderr,success_published,success_z,time")


def test_published_rows_must_be_rows_of_the_study(tmp_path):
    from tiswarm import ScenarioError

    text = 'title = "t"\n[published]\nfile = "p.csv"\ntrials = 10\n[[tables]]\nname = "a"\ntitle = "a"\n'
    (tmp_path / "s.toml").write_text(text + 'base = "delft/avoidance-10"\nkey = "prey.avoidance"\nvalues = ["none"]\n')
    (tmp_path / "p.csv").write_text("table,row,success,time,impact_spread\na,nonne,1,2,3\n")
    with pytest.raises(ScenarioError, match="a/nonne"):
        run_study(str(tmp_path / "s.toml"), 2)


def test_a_study_without_rows_is_refused(tmp_path):
    from tiswarm import ScenarioError

    (tmp_path / "s.toml").write_text('title = "t"\ntables = []\n')
    with pytest.raises(ScenarioError, match="tables"):
        load_study(str(tmp_path / "s.toml"))


def test_a_misspelt_key_of_a_study_is_named(tmp_path):
    from tiswarm import ScenarioError

    (tmp_path / "s.toml").write_text(
        'title = "t"\ntrails = 3\ntables = [{ name = "a", title = "a", base = "b", key = "k", values = ["v"] }]\n'
    )
    with pytest.raises(ScenarioError, match="trails: unknown key; did you mean 'trials'"):
        load_study(str(tmp_path / "s.toml"))
