"""Strategies are found by their files: ours, and a user's."""

import numpy as np
import pytest

import tiswarm
from tiswarm.strategies import registry

pytestmark = pytest.mark.quick

RUNNER = '''"""Runner: run along the x axis."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.strategies import Prey


class Strategy(Prey):
    @dataclass(frozen=True)
    class Weights:
        pace: float = 0.25

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        return weights.pace + 0.0 * me.x, 0.0 * me.x
'''


@pytest.fixture
def own_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(registry, "_folders", [])
    (tmp_path / "prey").mkdir()
    yield tmp_path
    registry._files.cache_clear()
    registry.load.cache_clear()


def test_all_strategies_of_the_thesis_are_there():
    assert set(registry.names("prey")) >= {
        "baseline",
        "evasive",
        "explode",
        "explode-evasive",
        "jump",
        "split",
        "split-evasive",
    }
    assert set(registry.names("predators")) >= {"centre", "pronav"}
    six = {"none", "outward", "spiral", "directed-spiral", "steer-away", "kitchen-sink"}
    assert set(registry.names("avoidance")) >= six


@pytest.mark.parametrize("kind", registry.KINDS)
def test_each_has_a_first_line(kind):
    for name, line in registry.described(kind).items():
        assert line.endswith("."), name


def test_combinations_are_made_of_their_parts():
    assert registry.parts("avoidance", "kitchen-sink") == ("directed-spiral", "steer-away")
    assert set(registry.defaults("prey", "split-evasive")) == {"part", "part_ticks", "part_range", "evade"}


def test_a_users_strategy_runs_like_ours(own_folder, f64):
    (own_folder / "prey" / "fast_runner.py").write_text(RUNNER)
    tiswarm.add_path(own_folder)
    assert registry.described("prey")["fast-runner"] == "Runner: run along the x axis."
    still = {f"prey.{name}": 0 for name in ("cohesion", "separation", "alignment", "goal")}
    scenario = tiswarm.load("delft/avoidance-10", {"prey.strategy": "fast-runner", "prey.avoidance": "none", **still})
    assert scenario.prey.weights == {"pace": 0.25}
    start = tiswarm.Start([[80, 20]], [[0, 0]], np.zeros((0, 2)), np.zeros((0, 2)), np.zeros((0, 2)), [])
    path = tiswarm.record(scenario.replaced({"world.ticks": 3}), start=start)
    np.testing.assert_allclose(path.prey.velocity[:, 0, 0], [0, 0.25, 0.5, 0.75])


@pytest.mark.parametrize(
    ("line", "mend"),
    [
        ("return -me.x, 0.0 * me.x", "write 0.0 - x"),
        ("return ti.sin(me.x), 0.0 * me.x", "ti.sin"),
        ("memory.nothing -= me.x\n        return me.x, me.y", "write x = x - y"),
    ],
)
def test_what_would_abort_the_process_is_refused_with_its_line(own_folder, line, mend):
    source = RUNNER.replace("return weights.pace + 0.0 * me.x, 0.0 * me.x", line)
    (own_folder / "prey" / "bad.py").write_text(source)
    tiswarm.add_path(own_folder)
    with pytest.raises(ValueError, match=r"bad\.py:\d+") as caught:
        tiswarm.load("delft/avoidance-10", {"prey.strategy": "bad"})
    assert mend in str(caught.value)


def test_a_file_without_a_strategy_is_named(own_folder):
    (own_folder / "prey" / "empty.py").write_text('"""Empty."""\n')
    tiswarm.add_path(own_folder)
    with pytest.raises(ValueError, match=r"empty\.py: has no class named Strategy"):
        tiswarm.load("delft/avoidance-10", {"prey.strategy": "empty"})


def test_a_folder_without_strategies_is_refused(tmp_path):
    with pytest.raises(ValueError, match="has no folder named prey, predators or avoidance"):
        tiswarm.add_path(tmp_path)


PLAIN = '''"""Plain."""

from dataclasses import dataclass
from typing import Literal

from tiswarm.strategies import Prey


class Strategy(Prey):
    parts = ()

    @dataclass(frozen=True)
    class Weights:
        pace: float = 0.25
'''


@pytest.mark.parametrize(
    ("old", "new", "mend"),
    [
        ("class Strategy(Prey)", "class Strategy", "write class Strategy(Prey)"),
        ("class Strategy(Prey)", "Strategy = Prey()\nclass Other(Prey)", "has no class named Strategy"),
        ("parts = ()", "parts = None", "write a tuple of names"),
        ("parts = ()", 'parts = "explode"', "write a tuple of names"),
        ("parts = ()", "parts = (1,)", "write a tuple of names"),
        ("parts = ()", 'parts = ("bad",)', "bad -> bad are a circle"),
        ("parts = ()", 'parts = ("explod",)', "bad.py: parts: unknown 'explod'; did you mean 'explode'?"),
        ("@dataclass(frozen=True)", "@staticmethod\n    def none(): ...\n", "Weights is no dataclass"),
        ("pace: float = 0.25", "pace: float", "write pace: float = 0.0"),
        ("pace: float = 0.25", 'pace: float = "fast"', "write pace: float = 0.0"),
        ("pace: float = 0.25", "pace: float = None", "write pace: float = 0.0"),
        ("pace: float = 0.25", 'pace: float = float("nan")', "write pace: float = 0.0"),
        ("pace: float = 0.25", 'pace: Literal["a", "b"] = "c"', "must be one of 'a', 'b'"),
        ("pace: float = 0.25", 'pace: Literal["a", "b"]', "must be one of 'a', 'b'"),
    ],
)
def test_a_strategy_that_lacks_something_gets_one_line(own_folder, old, new, mend):
    (own_folder / "prey" / "bad.py").write_text(PLAIN.replace(old, new))
    tiswarm.add_path(own_folder)
    with pytest.raises(ValueError, match=r"bad") as caught:
        tiswarm.load("delft/avoidance-10", {"prey.strategy": "bad"})
    assert mend in str(caught.value)
    assert "\n" not in str(caught.value)
