"""A state that is not finite ends a run by one line that says where, and is never averaged."""

import numpy as np
import pytest

import tiswarm
from tiswarm.strategies import registry

DIVIDES = '''"""Divider: divide nothing by nothing some ticks after the start."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.strategies import Prey


class Strategy(Prey):
    """Not a number once the age is `from_tick`, in those right of `right`."""

    memory = ("age",)

    @dataclass(frozen=True)
    class Weights:
        from_tick: float = 5.0  # [tick]
        right: float = 79.0  # [m]

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        zero = ti.select((memory.age >= weights.from_tick) & (me.x > weights.right), 0.0, 1.0)
        return zero / zero - 1.0, 0.0 * me.x

    @staticmethod
    @ti.func
    def remember(memory: ti.template(), me, seen, swarm_seen, weights):
        memory.age = memory.age + 1.0
'''


@pytest.fixture
def divider(tmp_path, monkeypatch, f32):
    monkeypatch.setattr(registry, "_folders", [])
    (tmp_path / "prey").mkdir()
    (tmp_path / "prey" / "divider.py").write_text(DIVIDES)
    tiswarm.add_path(tmp_path)
    yield tiswarm.load("delft/pronav-10", {"prey.strategy": "divider", "world.ticks": 12, "predators.strategy": "pronav"})
    registry._files.cache_clear()
    registry.load.cache_clear()


def test_a_batch_names_trial_tick_agent_and_strategy(divider):
    with pytest.raises(ValueError, match=r"^(\d+ of 40 trials are not finite, )?trial (\d+), tick (\d+): prey \d") as caught:
        tiswarm.simulate(divider, 40, 3)
    line = str(caught.value)
    assert "'divider'" in line
    assert "\n" not in line
    trial, tick = (int(line.split(word)[1].split(",", maxsplit=1)[0].split(":", maxsplit=1)[0]) for word in ("trial ", "tick "))
    assert tick == 6  # the move from tick 5 divides
    with pytest.raises(ValueError, match=f"trial {trial}, tick 6: prey"):
        tiswarm.record(divider, trial=trial, seed=3)
    with pytest.raises(ValueError, match=f"trial {trial}, tick 6: prey"):
        tiswarm.Simulation(divider, 3, trial).step(12)


def test_trials_of_numbers_of_their_own_are_named(divider):
    late = np.where(np.arange(20) == 13, 2.0, 100.0)
    left = np.full(20, -1e5)
    with pytest.raises(ValueError, match=r"^trial 13, tick 3: prey 0"):
        tiswarm.simulate(divider, 20, 3, weights={"prey.weights.from_tick": late, "prey.weights.right": left})


def test_a_large_swarm_is_refused_at_its_end(divider):
    swarm = tiswarm.Swarm(divider.replaced({"world.neighbours": "grid"}), 3, trials=4)
    with pytest.raises(ValueError, match=r"trial \d, tick 12: prey \d"):
        swarm.step(12)


def test_finite_trials_pass(divider):
    assert len(tiswarm.simulate(divider.replaced({"prey.weights.from_tick": 100}), 20, 3).alive) == 20


def test_a_built_in_strategy_under_wild_gains_is_refused(f32):
    wild = {"prey.strategy": "potential", "prey.spacing": 1e6, "prey.separation": 1e6, "prey.goal": -1e3, "prey.max_speed": 1e3}
    scenario = tiswarm.load("sanitation/arena", {**wild, "prey.perception": 5, "world.ticks": 20})
    assert scenario.prey.drive == "unicycle"
    with pytest.raises(ValueError, match=r"trial \d, tick \d+: prey \d+ .* strategy 'potential'"):
        tiswarm.simulate(scenario, 8, 0)
