"""Fixtures: the precision that a test runs in. Starting Taichi anew drops its kernels, so switches are few.

`pytest -n 0 --kernels` reports, after the tests, which file of tests compiled how many kernels in how many seconds: what a
suite that is too slow should share.
"""

import gc
import signal
import subprocess
import sys
import time
import warnings
from collections import defaultdict

import pytest

import tiswarm
from tiswarm.dynamics.specialisation import Specialisation

_compiled: dict[str, list[float]] = defaultdict(list)
_file = [""]


def pytest_addoption(parser):
    parser.addoption("--kernels", action="store_true", help="report the kernels that each file of tests compiles")


def pytest_configure(config):
    for number, usual in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
        if signal.getsignal(number) is signal.SIG_IGN:  # by `nohup pytest &`, for commands that tests interrupt too
            signal.signal(number, usual)
    if config.getoption("--kernels"):
        _watch_compiler()


def pytest_collection_modifyitems(items):
    """End with files that take little: whose last one is short does not wait long for the other worker."""
    items.sort(key=lambda item: item.path.parent.name in ("render", "scenario", "space", "system"))


def pytest_collection_finish():
    """Look for garbage no more among tests and modules, which stay: Taichi makes much for which all is looked through."""
    gc.collect()
    gc.freeze()


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
