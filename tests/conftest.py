"""Fixtures: the precision that a test runs in. Starting Taichi anew drops its kernels, so switches are few.

`pytest -n 0 --kernels` reports, after the tests, which file of tests compiled how many kernels in how many seconds: what a
suite that is too slow should share.
"""

import gc
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections import defaultdict
from functools import cached_property
from pathlib import Path

import pytest

import tiswarm
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.simd import runtime

_compiled: dict[str, list[float]] = defaultdict(list)
_file = [""]
_GROUPS = pytest.StashKey[tempfile.TemporaryDirectory]()


def pytest_addoption(parser):
    parser.addoption("--kernels", action="store_true", help="report the kernels that each file of tests compiles")


def pytest_configure(config):
    for number, usual in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
        if signal.getsignal(number) is signal.SIG_IGN:  # by `nohup pytest &`, for commands that tests interrupt too
            signal.signal(number, usual)
    runtime.MOST_COMPILED = 150  # that tests share; they take 1.4 GB of memory then, more than a user should give
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # else each command that tests start compiles a hundred modules of ours
    if config.getoption("--kernels"):
        _watch_compiler()


def pytest_collection_modifyitems(config, items):
    """Let tests of one precision follow each other, whatever file they are in, so that all of them share what was compiled.

    What begins Taichi anew comes between the two. End with files that take little: whose last one is short does not wait long
    for the other worker.
    """
    order, light = ("f64", "anew", "f32"), ("render", "scenario", "space", "system")
    items.sort(key=lambda item: (order.index(_runtime_of(item)), item.path.parent.name in light))
    told = getattr(config, "workerinput", {})
    if told.get("workerid") == "gw0":
        groups = {item.nodeid: f"{item.location[0]} {_runtime_of(item)}" for item in items}
        Path(told["groups"]).write_text(json.dumps(groups), encoding="utf-8")


def _runtime_of(item):
    """Tell which precision a test runs in, or that it begins Taichi anew, on other threads for one."""
    if item.get_closest_marker("anew"):
        return "anew"
    varied = item.callspec.params.get("precision", "") if hasattr(item, "callspec") else ""
    return "f64" if "f64" in (varied, *item.fixturenames) else "f32"


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node):
    """Tell a worker where to write what of a file belongs together: only workers know the tests."""
    if _GROUPS not in node.config.stash:
        node.config.stash[_GROUPS] = tempfile.TemporaryDirectory()
    node.workerinput["groups"] = str(Path(node.config.stash[_GROUPS].name) / "groups.json")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Give a worker the tests of a file that run in one precision, all at once."""
    from xdist.scheduler import LoadFileScheduling

    class ByRuntime(LoadFileScheduling):
        @cached_property
        def _groups(self):
            return json.loads((Path(config.stash[_GROUPS].name) / "groups.json").read_text(encoding="utf-8"))

        def _split_scope(self, nodeid):
            return self._groups[nodeid]

    return ByRuntime(config, log) if config.option.dist == "loadfile" else None


def pytest_collection_finish():
    """Look for garbage less often, and no more among tests and modules, which stay: Taichi makes much of it."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, *gc.get_threshold()[1:])


def _watch_compiler():
    """Time Taichi's compiler: from Python to its own code, and from there to the processor's (or from the cache on disk)."""
    from taichi._lib import core
    from taichi.lang.kernel_impl import Kernel

    def timed(owner, name, counts):
        whole = getattr(owner, name)

        def run(*arguments, **named):
            begin = time.perf_counter()
            try:
                return whole(*arguments, **named)
            finally:
                spent = time.perf_counter() - begin
                if spent > 0.005:  # else it was there already
                    _compiled[_file[0]].append(spent if counts else 0.0)
                    _compiled[f"{_file[0]} "].append(0.0 if counts else spent)

        setattr(owner, name, run)

    timed(Kernel, "materialize", counts=False)
    timed(core.Program, "compile_kernel", counts=True)


def pytest_runtest_setup(item):
    _file[0] = item.location[0]
    if runtime._settings is not None and _runtime_of(item) != "f64":  # a test that names no precision gets the usual one
        tiswarm.init("f32")


def pytest_terminal_summary(terminalreporter):
    if not _compiled:
        return
    terminalreporter.section("kernels")
    rows = []
    for name in {name.strip() for name in _compiled}:
        machine, python = (sum(_compiled.get(key, [])) for key in (name, f"{name} "))
        rows.append((machine + python, len([1 for each in _compiled.get(name, []) if each]), python, machine, name))
    for total, count, python, machine, name in sorted(rows, reverse=True):
        terminalreporter.line(f"{total:7.1f} s  {count:4d} kernels  (Python {python:.1f} s, LLVM {machine:.1f} s)  {name}")


@pytest.fixture
def f32():
    tiswarm.init("f32")


@pytest.fixture
def f64():
    tiswarm.init("f64")


@pytest.fixture(params=["f32", "f64"], scope="module")
def precision(request):
    tiswarm.init(request.param)
    return request.param


@pytest.fixture
def share(monkeypatch):
    """Let one kernel hold the code of some scenarios, for them all: it takes as long to compile as four that hold one each."""

    def one_kernel(scenarios, **how):
        joint = Specialisation.of(scenarios, 1, **how)
        monkeypatch.setattr(Specialisation, "of", classmethod(lambda *_, **__: joint))

    return one_kernel


@pytest.fixture
def small_films(monkeypatch):
    """Let commands that ask for no size film few pixels: most of what they take goes into the encoder, which others test."""
    import render

    film = render.film
    monkeypatch.setattr(render, "film", lambda *given, **look: film(*given, **{"size": (320, 180), "quality": "draft", **look}))


@pytest.fixture
def command(capsys, monkeypatch):
    """Run the command line within this process, for the many cases that a process each would spend on imports."""

    def run(*words, cwd):
        from tiswarm.cli import main

        line = ["tiswarm", *map(str, words)]
        heeded = signal.getsignal(signal.SIGINT)
        with monkeypatch.context() as here:
            here.chdir(cwd)
            here.setattr(sys, "argv", line)
            here.setattr(warnings, "showwarning", warnings.showwarning)
            try:
                with pytest.raises(SystemExit) as ended:
                    main()
            finally:
                signal.signal(signal.SIGINT, heeded)
        said, complained = capsys.readouterr()
        return subprocess.CompletedProcess(line, ended.value.code, said, complained)

    return run
