"""Tuning on a cluster: the generations of one machine, also where a worker is lost in mid-generation; what is refused."""

import signal
import subprocess
import sys

import numpy as np
import pytest

from tiswarm.cluster.candidates import cut

WORDS = ("tune", "delft/avoidance-10", "--set", "world.ticks=60", "--over", "prey.goal=0.05:0.2", "--checks", "50")
SIZE = ("--candidates", "6", "--validation", "100", "--quiet")


def tuning(folder, *more):
    return [sys.executable, "-m", "tiswarm", *WORDS, *SIZE, "-o", folder.name, *more]


def written(folder):
    files = [folder / "best.toml", folder / "generations.csv", *sorted(folder.glob("generations/*.npz"))]
    return {file.name: file.read_bytes() for file in files}


def generations(folder):
    return len(list(folder.glob("generations/[0-9][0-9][0-9][0-9][0-9].npz")))


def test_a_tuning_shared_by_workers_writes_the_bytes_of_one_process(tmp_path, command):
    small = ("--trials", "20", "--budget", "480", "--halve")
    for name, more in (("one", ()), ("two", ("--cluster", "local:2"))):
        done = command(*WORDS, *SIZE, *small, "-o", name, *more, cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
    assert written(tmp_path / "one") == written(tmp_path / "two")
    assert generations(tmp_path / "two") >= 4


def test_a_worker_killed_in_mid_generation_changes_nothing(tmp_path, command, machines, wait_until):
    large = ("--trials", "40000", "--budget", "480000")  # two generations, of seconds each
    machines.scheduler()
    first, _ = machines.worker(), machines.worker()
    client = subprocess.Popen(tuning(tmp_path / "two", *large, "--cluster", machines.address), cwd=tmp_path)
    wait_until(lambda: generations(tmp_path / "two") >= 1 or client.poll() is not None)
    first.send_signal(signal.SIGKILL)
    assert client.wait(timeout=180) == 0
    assert command(*WORDS, *SIZE, *large, "-o", "one", cwd=tmp_path).returncode == 0
    assert written(tmp_path / "one") == written(tmp_path / "two")


@pytest.mark.quick
@pytest.mark.parametrize(("candidates", "trials"), [(1, 3), (1, 2000), (3, 200), (32, 200), (5, 7), (64, 1)])
@pytest.mark.parametrize("parts", [2, 4, 40])
def test_each_trial_of_each_candidate_is_in_one_part(candidates, trials, parts):
    met = np.zeros((candidates, trials), int)
    for part in cut(candidates, trials, parts):
        met[part] += 1
        assert met[part].size
    assert (met == 1).all()


@pytest.mark.quick
def test_an_address_that_is_none_is_refused_in_one_line(tmp_path, command):
    done = command(*WORDS, *SIZE, "-o", "o", "--cluster", "nonsense", cwd=tmp_path)
    told = "tiswarm: --cluster nonsense: write local, local:N, tcp://HOST:PORT or the path of a scheduler file\n"
    assert (done.returncode, done.stderr) == (2, told)
    assert not (tmp_path / "o").exists()
