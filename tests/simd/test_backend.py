"""Backend: what stands behind `import taichi`, and how a wrong choice is told."""

import importlib.util
import os
import subprocess
import sys

import pytest

from tiswarm.simd import backend

pytestmark = pytest.mark.quick


def test_taichi_is_what_it_is_by_default(monkeypatch):
    monkeypatch.delenv(backend.VARIABLE, raising=False)
    assert backend.name() == "taichi"
    assert backend.version() == "1.7.4"


def test_an_unknown_backend_is_told_in_one_line(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "tiswarm", "run", "delft/avoidance-10", "--trials", "1", "--quiet"],
        env=os.environ | {backend.VARIABLE: "tachyon"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (2, "tiswarm: TISWARM_BACKEND=tachyon: not known; use taichi or quadrants\n")


@pytest.mark.skipif(importlib.util.find_spec("quadrants") is None, reason="Quadrants is not installed")
def test_quadrants_stands_behind_the_name_of_taichi():
    code = "import tiswarm, taichi, taichi.lang.impl as impl\nprint(taichi.__name__, impl.__name__, taichi.__spec__.name)"
    environment = os.environ | {backend.VARIABLE: "quadrants"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["quadrants", "quadrants.lang.impl", "quadrants"]
