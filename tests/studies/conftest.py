"""Fixtures: a small study, and the command line that runs it."""

import pytest

STUDY = """
title = "Goals and numbers"
base = "delft/avoidance-10"
trials = 20
figures = ["pairs"]
set = { "world.ticks" = 120 }
[[axes]]
key = "prey.goal"
low = 0.05
high = 0.2
steps = 4
[[axes]]
key = "prey.count"
values = [2, 6]
[correlate]
x = "prey.goal"
y = "time"
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "s.toml").write_text(STUDY)
    return tmp_path / "s.toml"


@pytest.fixture
def bench(command):
    """Run `tiswarm bench`, within this process."""

    def run(*arguments, cwd):
        return command("bench", *arguments, cwd=cwd)

    return run
