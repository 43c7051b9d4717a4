"""The verb replay."""

import json
import re
import shutil
from pathlib import Path

import pytest

import tiswarm

SAVED = Path(__file__).parents[1] / "records" / "saved"


def headers(path: Path) -> list[dict]:
    return [json.loads(each) for each in re.findall(r'class="header">(.*?)</script>', path.read_text(encoding="utf-8"))]


def test_a_preset_is_run_and_shown(tmp_path, command):
    done = command("replay", "delft/pronav-10", "--trial", "3", "--set", "world.ticks=20", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    path = tmp_path / "out" / "delft-pronav-10-3.html"
    assert str(path.relative_to(tmp_path)) in done.stdout
    (header,) = headers(path)
    assert (header["trial"], header["seed"], header["ticks"]) == (3, 0, 20)
    assert "field" in header["sections"]


def test_strategies_are_compared(tmp_path, command):
    words = ("--versus", "evasive,split-evasive", "--set", "world.ticks=10", "-o", "both.html", "--quiet")
    done = command("replay", "delft/pronav-10", *words, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "")
    both = headers(tmp_path / "both.html")
    assert [each["label"] for each in both] == ["evasive", "split-evasive"]
    assert both[0]["obstacles"] == both[1]["obstacles"]


def test_a_folder_is_a_gallery(f32, tmp_path, command):
    folder = tmp_path / "trials"
    scenario = tiswarm.load("delft/pronav-10", {"world.ticks": 5})
    tiswarm.record(scenario, 1).save(folder / "one.npz")
    shutil.copy(SAVED / "avoidance_spiral.json", folder / "two.json")
    (folder / "summary.json").write_text("{}")
    (folder / "notes.txt").write_text("nothing")
    done = command("replay", "trials", "-o", "all.html", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert [each["label"] for each in headers(tmp_path / "all.html")] == ["one", "two"]
    done = command("replay", "trials/one.npz", "trials/two.json", "-o", "pair.html", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert [each["ticks"] for each in headers(tmp_path / "pair.html")] == [5, 14]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("nothing.npz",), "no such file"),
        (("other.json",), "not a simulation saved by the thesis's simulator"),
        (("empty",), "holds no recording"),
        (("delft/pronav-10", "-o", "page.pdf"), "write -o page.html"),
        (("delft/pronav-10", "--versus", "evasive"), "two to four"),
        (("other.json", "--versus", "evasive,split"), "is recorded already"),
        (("delft/pronav-10", "m20/hawk"), "is no recording"),
    ],
)
def test_wrong_input_gets_one_line(tmp_path, command, words, told):
    (tmp_path / "other.json").write_text('{"a": 1}')
    (tmp_path / "empty").mkdir()
    done = command("replay", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert told in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()
