"""A process has one Taichi: who else starts it, forks, threads, folders and limits end in the same bits or in one line."""

import os
import re
import resource
import subprocess
import sys

import pytest

from tiswarm.simd.runtime import MOST_KEPT

BEGIN = """
import sys, threading
import tiswarm
SCENARIO = tiswarm.load("delft/avoidance-10", {"world.ticks": 60})  # prey alone: kernels that are soon built
def bits():
    found = tiswarm.simulate(SCENARIO, 200, 1)
    return [int(found.alive.sum()), int(found.captured.sum()), int(found.crashed.sum()), int(found.ticks.sum())]
def swarm():
    return tiswarm.Swarm(tiswarm.load("delft/crowd", {"prey.count": 64, "predators.count": 0}))
"""


def run(code, timeout=240, limit=None, **environment):
    """Run code in a process of its own; None takes a variable away. Gives its exit code, output and lines of errors."""
    room = {"TI_OFFLINE_CACHE_MAX_SIZE_OF_FILES": str(MOST_KEPT)}  # else a Taichi of others throws our kernels away
    kept = {name: value for name, value in {**os.environ, **room, **environment}.items() if value is not None}
    done = subprocess.run(
        [sys.executable, "-c", BEGIN + code],
        capture_output=True,
        text=True,
        timeout=timeout,
        env=kept,
        check=False,
        preexec_fn=limit,
    )
    return done.returncode, done.stdout, [line for line in done.stderr.splitlines() if line]


TAKEOVERS = (
    "ti.init(arch=ti.cpu, log_level=ti.ERROR)",
    "ti.init(arch=ti.cpu, default_fp=ti.f64, log_level=ti.ERROR)",
    "ti.reset()",
    "setattr(ti.lang.impl.current_cfg(), 'fast_math', True)",
)


def test_after_another_start_of_taichi_all_goes_on_with_the_same_bits():
    code = """
from tiswarm.engine.trials.trial import Single
first = bits()
crowd, single = swarm(), Single(SCENARIO, 1, 0)
paths = []
for _ in TAKEOVERS:  # undisturbed
    crowd.step(3); single.step(3)
    paths.append((crowd.position(), single.position("prey")))
crowd, single = swarm(), Single(SCENARIO, 1, 0)
import taichi as ti
for takeover, (together, alone) in zip(TAKEOVERS, paths, strict=True):
    eval(takeover)
    crowd.step(3)
    assert (crowd.position() == together).all(), takeover
    eval(takeover)
    single.step(3)
    assert (single.position("prey") == alone).all(), takeover
    eval(takeover)
    assert bits() == first, takeover
"""
    status, _, errors = run(code.replace("TAKEOVERS", repr(TAKEOVERS)), timeout=600)
    assert status == 0, errors
    assert len([line for line in errors if "of which a process has one" in line]) == 6  # a reset leaves nothing to end


def test_pictures_are_the_same_after_another_start_of_taichi():
    code = """
import hashlib, pathlib, tempfile, render
path = tiswarm.record(SCENARIO.replaced({"world.ticks": 3}))
def picture():
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "a.png")
        render.poster(path, file)
        return hashlib.sha256(file.read_bytes()).hexdigest()
first = picture()
import taichi as ti
ti.init(arch=ti.cpu, log_level=ti.ERROR)
assert picture() == first
"""
    status, _, errors = run(code)
    assert status == 0, errors


def test_who_started_taichi_before_is_told_who_wins():
    code = """
import taichi as ti
ti.init(arch=ti.cpu, log_level=ti.ERROR)
field = ti.field(ti.f32, 4)
field.fill(3)
bits()
"""
    status, _, errors = run(code)
    assert status == 0
    assert len(errors) == 1
    assert "of which a process has one" in errors[0]


def test_results_do_not_depend_on_variables_that_taichi_reads(tmp_path):
    kept, none = {"TI_OFFLINE_CACHE_FILE_PATH": str(tmp_path / "kept")}, {"TI_OFFLINE_CACHE_FILE_PATH": str(tmp_path / "none")}
    _, expected, _ = run("print(bits())", **kept)
    odd = {"TI_FAST_MATH": "1", "TI_DEBUG": "1", "TI_DEFAULT_IP": "64", "TI_ARCH": "cuda", "TI_OPT_LEVEL": "1"}
    assert run("print(bits())", **odd, **none, TI_OFFLINE_CACHE="0")[:2] == (0, expected)
    assert [any((tmp_path / each).iterdir()) for each in ("kept", "none")] == [True, False]


def test_a_swarm_begun_in_another_precision_is_refused_in_one_line():
    code = """
from tiswarm.engine.trials.trial import Single
crowd, single = swarm(), Single(SCENARIO, 1, 0)
tiswarm.init("f64")
for each in (crowd, single):
    try:
        each.step()
    except RuntimeError as error:
        print(error)
tiswarm.init("f32")
crowd.step(); single.step()
print("goes on")
"""
    status, told, errors = run(code)
    lines = told.splitlines()
    assert status == 0, errors
    assert len(lines) == 3
    assert all("begun in f32, and Taichi runs in f64 now" in line for line in lines[:2])


def test_threads_may_begin_and_share_the_work():
    code = """
found = []
threads = [threading.Thread(target=lambda: found.append((bits(), swarm().step(2)))) for _ in range(4)]
for each in threads: each.start()
for each in threads: each.join()
assert len(found) == 4
assert [each[0] for each in found] == [bits()] * 4
"""
    status, _, errors = run(code)
    assert (status, errors) == (0, [])


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_forked_process_says_to_use_spawn_and_ends():
    code = """
import os
bits()
for ending in (sys.exit, os._exit):
    child = os.fork()
    if child == 0:
        try:
            bits()
        except RuntimeError as error:
            print(error, flush=True)
        ending(7)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
bits()
"""
    status, told, errors = run(code, timeout=120)
    assert (status, errors) == (0, [])
    assert len(told.splitlines()) == 2
    assert all("multiprocessing.get_context('spawn')" in line for line in told.splitlines())


BROKEN = {
    "a file": {"TI_OFFLINE_CACHE_FILE_PATH": "/dev/null"},
    "a file, nothing kept": {"TI_OFFLINE_CACHE_FILE_PATH": "/dev/null", "TI_OFFLINE_CACHE": "0"},
    "a home that cannot be": {"TI_OFFLINE_CACHE_FILE_PATH": None, "HOME": "/dev/null/nobody"},
    "no temporary folder": {"TI_OFFLINE_CACHE_FILE_PATH": "/dev/null/x"},
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_cache_that_cannot_be_written_is_told_in_one_line(case, tmp_path):
    code = "import tempfile; tempfile.tempdir = '/dev/null/t'\n" if case == "no temporary folder" else ""
    status, told, errors = run(code + "print(bits())", **{"TMPDIR": str(tmp_path), **BROKEN[case]})
    assert status == 0, errors
    assert told.startswith("[")
    assert len(errors) == 1
    assert "cannot be written into" in errors[0]
    assert any(tmp_path.iterdir()) == (case != "no temporary folder")


def test_without_a_home_nothing_ends(tmp_path):
    assert run("bits()", HOME=None, TI_OFFLINE_CACHE_FILE_PATH=str(tmp_path))[0] == 0


def test_threads_that_do_not_fit_into_memory_are_refused():
    limits = (8 << 30, 8 << 30)
    status, _, errors = run(
        "tiswarm.init('f32', 1024); bits()", timeout=60, limit=lambda: resource.setrlimit(resource.RLIMIT_AS, limits)
    )
    assert status == 1
    assert re.search(r"threads: 1024 do not fit .*8\.0 GiB.*use fewer", errors[-1])


def test_past_a_bound_kernels_are_forgotten_and_results_are_the_same():
    code = """
from tiswarm.engine.trials.trial import Single
from tiswarm.simd import runtime
runtime.MOST_COMPILED = 2
single = Single(SCENARIO, 1, 0)
single.step(3)
calm = [SCENARIO.replaced({"prey.avoidance": name, "predators.count": 0}) for name in ("none", "outward", "spiral", "repel")]
def outcomes():
    return [int(tiswarm.simulate(each, 40, 1).crashed.sum()) for each in calm]
first, before = outcomes(), runtime.generation()
assert outcomes() == first
assert runtime.generation() > before
from taichi.lang import impl
kernels = len(impl.get_runtime().kernels)
outcomes()
assert len(impl.get_runtime().kernels) <= kernels
whole = Single(SCENARIO, 1, 0)
whole.step(9); single.step(6)
assert (single.position("prey") == whole.position("prey")).all()
"""
    status, _, errors = run(code)
    assert (status, errors) == (0, [])
