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


WITHOUT = """
import sys
from importlib.machinery import ModuleSpec, PathFinder
class Without(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        if name in {named}:
            return ModuleSpec(name, None)
        return None if name in {gone} else PathFinder.find_spec(name, path, target)
sys.meta_path[sys.meta_path.index(PathFinder)] = Without
"""
"""Python that finds no package of `gone`, and says that it would find those of `named`."""


def run_without(code, gone, named=(), **environment):
    code = WITHOUT.format(gone=gone, named=named) + code
    plain = {name: value for name, value in os.environ.items() if name != backend.VARIABLE}
    return subprocess.run([sys.executable, "-c", code], env=plain | environment, capture_output=True, text=True, check=False)


def test_where_taichi_is_not_to_be_had_quadrants_is_taken():
    code = "from tiswarm.simd import backend; print(backend.name(), type(sys.meta_path[0]).__name__)"
    done = run_without(code, ("taichi",), ("quadrants",))
    assert (done.stdout, done.stderr) == ("quadrants _Alias\n", "")


@pytest.mark.parametrize("words", [["--version"], ["show", "delft/avoidance-10"], ["run", "delft/avoidance-10"]])
@pytest.mark.parametrize("chosen", ["", "taichi", "quadrants"])
def test_without_either_one_line_names_the_command_that_installs_it(words, chosen):
    code = f"sys.argv = ['tiswarm', *{words}]; from tiswarm.__main__ import main; main()"
    done = run_without(code, ("taichi", "quadrants"), **({backend.VARIABLE: chosen} if chosen else {}))
    told = backend._ABSENT[chosen or "taichi"]
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"tiswarm: {told}\n")


@pytest.mark.skipif(importlib.util.find_spec("quadrants") is None, reason="Quadrants is not installed")
def test_quadrants_stands_behind_the_name_of_taichi():
    code = "import tiswarm, taichi, taichi.lang.impl as impl\nprint(taichi.__name__, impl.__name__, taichi.__spec__.name)"
    environment = os.environ | {backend.VARIABLE: "quadrants"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["quadrants", "quadrants.lang.impl", "quadrants"]
