"""The command line at its edges: streams that are closed or full, signals at any moment, odd names, warnings."""

import os
import signal
import subprocess
import sys
import time

import pytest

COMMAND = [sys.executable, "-m", "tiswarm"]


def _shell(line, cwd=None):
    line = line.replace("tiswarm", f"{sys.executable} -m tiswarm")
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True, cwd=cwd, timeout=120, check=False)


def test_a_reader_that_has_seen_enough_is_no_fault():
    done = _shell("tiswarm presets | head -1; echo ${PIPESTATUS[0]}")
    assert done.stdout.splitlines()[1:] == ["0"]
    assert done.stderr == ""


@pytest.mark.parametrize("verb", ["presets", "show delft/pronav-10", "show --schema", "--help", "--version"])
@pytest.mark.parametrize(
    ("where", "said"), [(">&-", "standard output is closed; send it to"), (">/dev/full", "standard output: no space left on")]
)
def test_output_that_goes_nowhere_gets_one_line(verb, where, said):
    done = _shell(f"tiswarm {verb} {where}")
    assert done.returncode == 1
    assert said in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


def test_without_standard_error_and_input_it_works_all_the_same():
    assert "delft/pronav-10" in _shell("tiswarm presets 2>&- <&-").stdout
    assert _shell("tiswarm show nothing 2>&-").returncode == 2


INTERRUPTED = """
import os, signal, sys
def hear(event, arguments):
    if event == "import" and arguments[0] == "MODULE":
        os.kill(os.getpid(), signal.SIGINT)
sys.addaudithook(hear)
sys.argv = ["tiswarm", "show", "delft/pronav-10"]
import tiswarm.__main__
tiswarm.__main__.main()
"""
MODULES = ("tiswarm.system.progress", "tiswarm.cli.entry", "typer", "rich.console", "pydantic", "taichi")


@pytest.mark.parametrize("module", MODULES)
def test_ctrl_c_during_start_up_gives_no_traceback(module):
    code = INTERRUPTED.replace("MODULE", module)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode in (130, -signal.SIGINT)
    assert "Traceback" not in done.stderr
    assert len(done.stderr.splitlines()) <= 1


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_what_asks_to_end_leaves_nothing_half_written(number, code, tmp_path):
    arguments = [*COMMAND, "film", "demo/chase", "-o", "a.mp4", "--size", "640x360", "--quality", "best"]
    process = subprocess.Popen(arguments, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    while process.poll() is None and not list(tmp_path.glob(".a.*.part.mp4")):
        time.sleep(0.002)  # and leave the processor to it
    process.send_signal(number)
    _, complaint = process.communicate(timeout=60)
    assert process.returncode == code, complaint
    assert complaint == ""
    assert list(tmp_path.iterdir()) == []


def test_nohup_is_heeded(tmp_path):
    process = subprocess.Popen(["nohup", *COMMAND, "presets"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.send_signal(signal.SIGHUP)
    process.communicate(timeout=60)
    assert process.returncode in (0, -signal.SIGHUP)  # the latter before nohup itself had begun


NASTY = [
    ('title = "\\u001b[31mred\\u0007"\n[prey]\n"\\u001b]0;x\\u0007" = 1', "\\x1b"),
    (f"[prey]\n{'a' * 1000} = 1", "…"),
    (f'[prey]\nstrategy = "{"b" * 1000}"', "…"),
    (f'[prey]\nstrategy = "{"b c" * 1000}"', "…"),
    ('[prey]\nstrategy = "\\u202Eesab\\nline"', "\\u202e"),
    ('[prey.weights]\n"\\u009b31m" = 1', "\\x9b"),
    (f'base = "{"c" * 1000}"', "…"),
    ("", "is empty"),
    (" \n\t\n", "is empty"),
    ("# nothing but words\n", "is empty"),
    ("a = " + "[" * 5000, "nested too deeply"),
    ("a = " + "9" * 5000, "not valid TOML"),
]


@pytest.mark.parametrize(("text", "said"), NASTY)
def test_what_was_typed_is_shown_safe_and_short(text, said, tmp_path, command):
    (tmp_path / "x.toml").write_text(text, encoding="utf-8")
    for verb in ("show", "bench"):
        done = command(verb, "x.toml", cwd=tmp_path)
        assert done.returncode == 2
        (line,) = done.stderr.splitlines()
        assert line.isprintable()
        assert len(line) < 1300
        assert verb == "bench" or said in line
        assert [each.name for each in tmp_path.iterdir()] == ["x.toml"]


def test_the_options_are_shown_safe_and_short_too(tmp_path, command):
    for arguments in (
        ["run", "\x1b[31mred"],
        ["run", "delft/pronav-10", "--set", f"prey.count={'x' * 2000}"],
        ["run", "delft/pronav-10", "--set", "\x1b[31m.x=1"],
        ["film", "x" * 200 + "\x1b.npz"],
        ["film", "delft/pronav-10", "--theme", "\x1b]0;x\x07" + "y" * 2000],
        ["\x1b[31m" + "v" * 2000],
        ["presets", "--\x1b" + "o" * 2000],
    ):
        done = command(*arguments, cwd=tmp_path)
        assert done.returncode == 2, arguments
        (line,) = done.stderr.splitlines()
        assert line.isprintable(), line
        assert len(line) < 1300


WARNING = '''"""Noisy: its states divide by nothing."""

import numpy as np

from tiswarm.strategies import Prey


class Strategy(Prey):
    @staticmethod
    def derived(weights):
        np.array([1.0]) / np.array([0.0])
        return {}
'''


def test_numpys_warnings_reach_the_user_of_a_film(tmp_path):
    (tmp_path / "prey").mkdir()
    (tmp_path / "prey" / "noisy.py").write_text(WARNING)
    arguments = ["film", "delft/avoidance-10", "--set", "prey.strategy=noisy", "--set", "world.ticks=3", "--strategy-path", "."]
    done = subprocess.run(
        [*COMMAND, *arguments, "-o", "a.mp4", "--size", "64x64", "--fps", "10"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=120,
        check=False,
        env=os.environ,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.splitlines() == ["tiswarm: warning: divide by zero encountered in divide"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--poster", "x.xyz"), "unknown format '.xyz'"),
        (("--sheet", "x"), "unknown format ''"),
        (("-o", "x.avi"), "unknown format '.avi'"),
        (("--fps", "fast"), "write a number"),
        (("--fps", "1/0"), "write a number"),
        (("--fps", "1e9999999"), "write a number"),
        (("--fps", "30/1001"), "fps: 30/1001 is not possible"),
        (("--size", "641x360"), "642x360"),
        (("--poster", "file/x.png"), "file"),
    ],
)
def test_what_a_film_cannot_be_is_told_before_the_work(arguments, said, tmp_path, command):
    """A preset that is not there would be told first if anything was done first."""
    (tmp_path / "file").write_text("")
    done = command("film", "no-such-preset", *arguments, cwd=tmp_path)
    assert done.returncode in (1, 2)
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_preset_with_a_byte_order_mark_is_read(tmp_path):
    (tmp_path / "x.toml").write_text('title = "Marked"\r\nbase = "delft/avoidance-10"\r\n', encoding="utf-8-sig")
    done = subprocess.run([*COMMAND, "show", "x.toml"], capture_output=True, text=True, cwd=tmp_path, timeout=60, check=False)
    assert 'title = "Marked"' in done.stdout


def test_rates_of_television_on_the_command_line(tmp_path):
    line = ["film", "delft/avoidance-10", "--set", "world.ticks=2", "--size", "64x64", "--quiet", "-o", "a.mp4"]
    for rate in ("29.97", "30000/1001"):
        done = subprocess.run(
            [*COMMAND, *line, "--fps", rate], capture_output=True, text=True, cwd=tmp_path, timeout=60, check=False
        )
        assert (done.returncode, done.stderr) == (0, "")


def test_titles_of_a_users_file_are_data_on_the_terminal(tmp_path, capsys):
    from rich.console import Console

    from tiswarm import load
    from tiswarm.studies.console import print_summary

    class Titled:
        scenario = load("delft/avoidance-10", {"title": "[red]\x1b[31mloud[/red]"})

        def summary(self):
            return {}

    print_summary(Titled(), Console(width=100))
    told = capsys.readouterr().out
    assert "[red]" in told
    assert "\x1b[31m" not in told
