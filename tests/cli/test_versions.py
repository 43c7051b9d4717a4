"""What a report of a fault needs, and what a shell completes."""

import os
import subprocess
import sys
from importlib.metadata import version

import pytest

import tiswarm

pytestmark = pytest.mark.quick


def _told(*arguments, **environment):
    code = "import sys; sys.argv[0] = 'tiswarm'; from tiswarm.__main__ import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        capture_output=True,
        text=True,
        env={**os.environ, **environment},
        check=False,
        timeout=60,
    )


def test_versions_of_ours_and_of_what_does_the_work():
    ours, python, taichi, ffmpeg = _told("--version").stdout.splitlines()
    assert ours == f"tiswarm {tiswarm.__version__}"
    assert python.startswith("Python 3.")
    assert taichi == f"Taichi {version('taichi')}"
    assert any(sign.isdigit() for sign in ffmpeg)


def test_a_missing_ffmpeg_is_told_and_no_fault(tmp_path):
    done = _told("--version", IMAGEIO_FFMPEG_EXE=str(tmp_path / "nothing"))
    assert done.returncode == 0
    assert "pip install imageio-ffmpeg" in done.stdout.splitlines()[3]


@pytest.mark.parametrize(
    ("typed", "offered"),
    [("fi", {"film"}), ("run delft/cen", {"delft/centre-0", "delft/centre-10"}), ("bench --fig", {"--figures"})],
)
def test_a_shell_completes_verbs_presets_and_options(typed, offered):
    words = ["tiswarm", *typed.split()]
    done = _told(_TISWARM_COMPLETE="complete_bash", COMP_WORDS=" ".join(words), COMP_CWORD=str(len(words) - 1))
    assert set(done.stdout.split()) == offered


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_can_be_printed_for_a_shell(shell):
    done = _told("--show-completion", shell, _TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION="1")
    assert "_TISWARM_COMPLETE" in done.stdout
