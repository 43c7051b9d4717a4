"""Small recordings made by hand: no simulator is needed to test pictures."""

from collections.abc import Callable
from dataclasses import replace

import browser as browsers
import numpy as np
import pytest

import render
import tiswarm
from tiswarm.records.recording import Recording, Swarm

Maker = Callable[..., Recording]


def swarm(
    start: np.ndarray, step: np.ndarray, ticks: int, ends: dict[int, tuple[int, str]], state: str = "calm", groups: int = 0
) -> Swarm:
    """Move agents along slightly curved lines; ends: agent -> (tick at which it is gone, fate); groups: 0 for none."""
    count, dim = start.shape
    time = np.arange(ticks + 1.0)
    sway = np.zeros((ticks + 1, 1, dim))
    sway[:, 0, 1] = 0.5 * np.sin(time)
    position = start + time[:, None, None] * step + sway
    velocity = np.concatenate([np.broadcast_to(step, (1, count, dim)), np.diff(position, axis=0)])
    fate = np.full(count, "alive", dtype="<U8")
    for agent, (tick, name) in ends.items():
        position[tick:, agent] = velocity[tick:, agent] = np.nan
        fate[agent] = name
    group = np.tile(np.arange(count, dtype=np.int32) % groups if groups else np.full(count, -1, np.int32), (ticks + 1, 1))
    return Swarm(position, velocity, fate, np.full((ticks + 1, count), state, dtype="<U12"), group)


@pytest.fixture(scope="session")
def make() -> Maker:
    def recording(
        prey=6, predators=5, ticks=8, prey_ends=None, predator_ends=None, dim=2, state="alarmed", trial=4, chased=0
    ) -> Recording:
        at = np.arange(max(prey, predators, 1))[:, None]
        home = np.concatenate([60 - 2.0 * at, 20 + 3.0 * at, 5 + 1.0 * at], axis=1)[:prey, :dim]
        den = np.concatenate([15 + 2.0 * at, -5 + 3.0 * at, 2 + 1.0 * at], axis=1)[:predators, :dim]
        way = np.array([-1.0, 0.3, 0.1])[:dim]
        return Recording(
            tiswarm.load("delft/pronav-10"),
            seed=7,
            trial=trial,
            prey=swarm(home, way, ticks, prey_ends or {}, state, groups=2),
            predators=swarm(den, -way, ticks, predator_ends or {}, groups=chased),
            obstacle_position=np.array([[30.0, 20.0], [45.0, 40.0]]),
            obstacle_radius=np.array([1.0, 2.0]),
        )

    return recording


@pytest.fixture(scope="session")
def chase(make: Maker) -> Recording:
    """A trial in which everything happens: a capture, a crash, an arrival, and a predator's crash."""
    return make(
        prey_ends={0: (3, "captured"), 1: (4, "crashed"), 2: (5, "arrived")},
        predator_ends={0: (3, "captured"), 1: (6, "crashed")},
    )


@pytest.fixture(scope="module")
def window(tmp_path_factory):
    opened = browsers.started(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.driver.quit()


@pytest.fixture
def browser(window):
    """A window whose pages start still; whatever a test does, they have nothing to complain of."""
    window.look()
    yield window
    assert window.complaints() == []


@pytest.fixture(scope="module")
def calm(make):
    """Agents that keep their colours: nobody is alarmed."""
    return make(state="calm", ticks=20)


@pytest.fixture(scope="module")
def page(calm, tmp_path_factory):
    return render.replay(calm, tmp_path_factory.mktemp("page") / "calm.html")


@pytest.fixture(scope="module")
def deep(make):
    """Make recordings of a 3-D world."""

    def recording(**how):
        scenario, where = tiswarm.load("lookout/aquarium"), np.array([[30.0, 20.0, 5.0], [45.0, 40.0, 9.0]])
        return replace(make(dim=3, **how), scenario=scenario, obstacle_position=where)

    return recording
