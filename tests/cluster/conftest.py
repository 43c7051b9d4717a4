"""Fixtures: a small study, a scheduler, and workers, each a process of its own that a test may kill."""

import os
import socket
import subprocess
import sys
import time

import pytest

pytest.importorskip("distributed")

STUDY = """
title = "Goals and numbers"
base = "delft/avoidance-10"
trials = 20
figures = []
set = { "world.ticks" = 60 }
[[axes]]
key = "prey.goal"
values = [0.05, 0.1, 0.2]
[[axes]]
key = "prey.count"
values = [2, 6]
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "s.toml").write_text(STUDY)
    return tmp_path / "s.toml"


class Machines:
    """A scheduler and its workers, started and ended by process id."""

    def __init__(self, folder):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        self._folder = folder
        self._begun = []

    def begin(self, *words, **environment):
        log = (self._folder / f"log-{len(self._begun)}").open("wb")
        process = subprocess.Popen(
            [sys.executable, "-m", *words],
            stdout=log,
            stderr=log,
            cwd=self._folder,
            env=os.environ | environment,
        )
        self._begun.append(process)
        return process

    def scheduler(self):
        words = ("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", self.port, "--no-dashboard")
        return self.begin(*map(str, words))

    def worker(self, **environment):
        words = ("--no-nanny", "--no-dashboard", "--nthreads", "1", "--memory-limit", "0", "--death-timeout", "60")
        return self.begin("distributed.cli.dask_worker", self.address, *words, **environment)

    def close(self):
        for process in self._begun:
            if process.poll() is None:
                process.kill()
            process.wait()


@pytest.fixture
def machines(tmp_path):
    there = Machines(tmp_path)
    yield there
    there.close()


@pytest.fixture
def wait_until():
    return _wait_until


def _wait_until(happens, seconds=90.0):
    end = time.monotonic() + seconds
    while not happens():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)
