"""A process has one Taichi: who else starts it, forks, threads, folders and limits end in the same bits or in one line."""

import os
import re
import resource
import subprocess
import sys

import pytest

BEGIN = """
import sys, threading
import tiswarm
SCENARIO = tiswarm.load("delft/pronav-10", {"world.ticks": 60})
def bits():
    found = tiswarm.simulate(SCENARIO, 200, 1)
    return [int(found.alive.sum()), int(found.captured.sum()), int(found.crashed.sum()), int(found.ticks.sum())]
def swarm():
    return tiswarm.Swarm(tiswarm.load("delft/crowd", {"prey.count": 64, "predators.count": 4}))
"""


def run(code, timeout=240, limit=None, **environment):
    """Run code in a process of its own; None takes a variable away. Gives its exit code, output and lines of errors."""
    kept = {name: value for name, value in {**os.environ, **environment}.items() if value is not None}
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


TAKEOVERS = {
    "init": "import taichi as ti; ti.init(arch=ti.cpu, log_level=ti.ERROR)",
    "f64": "import taichi as ti; ti.init(arch=ti.cpu, default_fp=ti.f64, log_level=ti.ERROR)",
    "reset": "import taichi as ti; ti.reset()",
    "settings": "import taichi as ti; ti.lang.impl.current_cfg().fast_math = True",
}


@pytest.mark.parametrize("takeover", TAKEOVERS)
def test_after_another_start_of_taichi_all_goes_on_with_the_same_bits(takeover):
    code = """
first = bits()
one, two = swarm(), swarm()
one.step(6); two.step(3)
from tiswarm.engine.trials.trial import Single
single, other = Single(SCENARIO, 1, 0), Single(SCENARIO, 1, 0)
single.step(8); other.step(3)
TAKEOVER
two.step(3)
TAKEOVER
assert bits() == first, (bits(), first)
assert (one.position() == two.position()).all()
other.step(5)
assert (single.position("prey") == other.position("prey")).all()
two.step(); one.step()
assert (one.position() == two.position()).all()
print("the same")
"""
    status, told, errors = run(code.replace("TAKEOVER", TAKEOVERS[takeover]))
    assert (status, told.splitlines()[-1:]) == (0, ["the same"]), errors
    said = [line for line in errors if "Taichi" in line]
    assert len(said) == (2 if takeover in ("init", "f64") else 0), errors


def test_pictures_are_the_same_after_another_start_of_taichi():
    code = """
import hashlib, pathlib, tempfile, render
path = tiswarm.record(SCENARIO.replaced({"world.ticks": 3}))
def picture():
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "a.png")
        render.still(path, file) if hasattr(render, "still") else render.poster(path, file)
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


def test_results_do_not_depend_on_variables_that_taichi_reads():
    _, expected, _ = run("print(bits())")
    odd = {"TI_FAST_MATH": "1", "TI_DEBUG": "1", "TI_DEFAULT_IP": "64", "TI_ARCH": "cuda", "TI_OPT_LEVEL": "1"}
    assert run("print(bits())", **odd)[:2] == (0, expected)


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
