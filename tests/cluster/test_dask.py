"""Clusters: the bits of one machine, whatever happens to workers, scheduler and client; and what is refused."""

import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import tiswarm


def written(folder):
    """Read what depends on trials: the table, and every cell's outcomes."""
    files = [folder / "cells.csv", *sorted(folder.glob("cells/*.npz"))]
    return {file.name: file.read_bytes() for file in files}


@pytest.fixture
def whole(study, tmp_path, command):
    """Run the study in one process; give what that writes."""

    def run():
        done = command("bench", study, "-o", "whole", "--quiet", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        return written(tmp_path / "whole")

    return run


def kept(folder):
    return len(list(folder.glob("cells/[0-9]*.npz")))


def begun(study, folder, address, **options):
    words = ("bench", study, "-o", folder.name, "--quiet", "--cluster", address)
    return subprocess.Popen(
        [sys.executable, "-m", "tiswarm", *map(str, words)],
        cwd=folder.parent,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


def ended(process):
    _, complaint = process.communicate(timeout=180)
    assert process.returncode == 0, complaint
    assert complaint == ""


@pytest.mark.parametrize("workers", [1, 2])
def test_workers_of_this_machine_write_the_bytes_of_one_process(study, tmp_path, whole, workers):
    ended(begun(study, tmp_path / "o", f"local:{workers}"))
    assert written(tmp_path / "o") == whole()


def test_a_killed_worker_a_new_scheduler_and_a_killed_client_change_nothing(study, tmp_path, whole, machines, wait_until):
    study.write_text(study.read_text().replace("trials = 20", "trials = 30_000"))  # seconds of work
    folder = tmp_path / "o"
    scheduler, first = machines.scheduler(), machines.worker()
    client = begun(study, folder, machines.address)
    wait_until(lambda: kept(folder) >= 1)
    first.send_signal(signal.SIGKILL)  # with slices at hand
    first.wait()
    second = machines.worker()
    wait_until(lambda: kept(folder) >= 2)
    scheduler.send_signal(signal.SIGKILL)
    scheduler.wait()
    second.kill()
    second.wait()
    machines.scheduler()
    machines.worker()
    wait_until(lambda: kept(folder) >= 4 or client.poll() is not None)
    client.send_signal(signal.SIGKILL)
    client.communicate()
    before = kept(folder)
    assert before >= 4
    ended(begun(study, folder, machines.address))
    assert written(folder) == whole()


def test_a_worker_with_other_code_is_named_before_any_work(study, tmp_path, machines, command, wait_until):
    machines.scheduler()
    machines.worker(PYTHONPATH=str(_with_another_comment(tmp_path)))
    wait_until(lambda: "Registered to" in (tmp_path / "log-1").read_text())
    done = command("bench", study, "-o", "o", "--cluster", machines.address, cwd=tmp_path)
    assert done.returncode == 2
    assert re.fullmatch(r"tiswarm: worker tcp://\S+ has other code \(.*\) than this client \(.*\); install .*\n", done.stderr)
    assert kept(tmp_path / "o") == 0


def _with_another_comment(folder):
    """Copy tiswarm with a file changed that outcomes come from."""
    root = Path(tiswarm.__file__).parent
    shutil.copytree(root, folder / "copy" / "tiswarm", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(root.parent / "presets", folder / "copy" / "presets")
    with (folder / "copy" / "tiswarm" / "engine" / "run.py").open("a") as file:
        file.write("# another state\n")
    return folder / "copy"


@pytest.mark.quick
@pytest.mark.parametrize(
    ("address", "told"),
    [
        ("nonsense", "write local, local:N, tcp://HOST:PORT or the path of a scheduler file"),
        ("local:0", "write local:N with N from 1 to 1024"),
        ("local:two", "write local:N with N from 1 to 1024"),
    ],
)
def test_an_address_that_is_none_is_refused_in_one_line(study, tmp_path, command, address, told):
    done = command("bench", study, "-o", "o", "--cluster", address, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, f"tiswarm: --cluster {address}: {told}\n")
    assert not (tmp_path / "o").exists()


@pytest.mark.quick
def test_a_scheduler_that_does_not_answer_is_told_in_one_line(study, tmp_path, command):
    done = command("bench", study, "-o", "o", "--cluster", "tcp://127.0.0.1:9", cwd=tmp_path)
    assert done.returncode == 1
    assert re.fullmatch(r"tiswarm: cluster tcp://127\.0\.0\.1:9: no scheduler answers .*kept\n", done.stderr)


@pytest.mark.quick
def test_without_dask_the_command_that_installs_it_is_named(study, tmp_path, command, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    done = command("bench", study, "-o", "o", "--cluster", "local", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, "tiswarm: distributed is not installed; pip install 'tiswarm[cluster]'\n")
