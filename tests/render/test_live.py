"""A simulation filmed while it runs gives the film of its recording, and is not kept."""

import tracemalloc
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest

import render
from render.composition import Composition
from render.scene.trajectories import Trajectories
from render.style import Look
from tiswarm.records.recording import Recording, Swarm

SIZE = (320, 180)


@dataclass
class Played:
    """A recording that passes for a simulation, whose arrays are written over from tick to tick."""

    recording: Recording
    ticks: int

    def __post_init__(self) -> None:
        first = self.recording
        self.scenario, self.seed, self.trial = first.scenario, first.seed, first.trial
        self.obstacle_position, self.obstacle_radius = first.obstacle_position, first.obstacle_radius
        self.runs = 0

    def __iter__(self) -> Iterator[tuple[Swarm, Swarm]]:
        self.runs += 1
        both = [self._moment(swarm, 0) for swarm in (self.recording.prey, self.recording.predators)]
        for tick in range(self.recording.ticks + 1):
            for moment, swarm in zip(both, (self.recording.prey, self.recording.predators), strict=True):
                moment.position[:], moment.velocity[:] = swarm.position[tick], swarm.velocity[tick]
                moment.state[:], moment.group[:] = swarm.state[tick], swarm.group[tick]
                moment.fate[:] = np.where(np.isnan(swarm.position[tick, :, 0]), swarm.fate, "alive")
            yield both[0], both[1]

    @staticmethod
    def _moment(swarm: Swarm, tick: int) -> Swarm:
        return Swarm(
            *(np.copy(getattr(swarm, name)[tick]) for name in ("position", "velocity")),
            swarm.fate.copy(),
            swarm.state[tick].copy(),
            swarm.group[tick].copy(),
        )


@pytest.fixture(scope="module")
def tame(make) -> Recording:
    """A trial whose agents all stay in the world: a live film cannot know beforehand who will leave it."""
    recording = make(
        ticks=30, predators=4, prey_ends={0: (3, "captured"), 1: (9, "arrived")}, predator_ends={2: (6, "crashed")}
    )
    recording.predators.position[..., 1] += 20
    for swarm in (recording.prey, recording.predators):
        assert np.nanmin(swarm.position) > 1
    return recording


@pytest.mark.parametrize("look", [{}, {"overlay": render.OVERLAYS}, {"camera": "orbit"}, {"speed": 100.0}])
def test_a_live_film_is_the_film_of_its_recording(tame, look):
    live = Played(tame, tame.ticks)
    recorded = list(render.frames(tame, SIZE, 12, **look))
    filmed = list(render.frames(live, SIZE, 12, **look))
    assert len(filmed) == len(recorded)
    assert all((one == other).all() for one, other in zip(filmed, recorded, strict=True))


def test_a_live_film_in_company(tame, make):
    short = make(ticks=12)
    recorded = list(render.frames([tame, short], SIZE, 6))
    filmed = list(render.frames([Played(tame, tame.ticks), short], SIZE, 6))
    assert all((one == other).all() for one, other in zip(filmed, recorded, strict=True))


def test_a_simulation_that_ends_early_ends_its_film(tame, tmp_path):
    made = render.film(Played(tame, 10 * tame.ticks), tmp_path / "a.mp4", (160, 90), 10)
    assert made.frames == tame.ticks + 10
    assert tuple(tmp_path.iterdir()) == (made.path,)


def test_memory_does_not_grow_with_time(make):
    class Endless(Played):
        def __iter__(self):
            prey, predators = next(super().__iter__())
            for _ in range(self.ticks):
                yield prey, predators

    paths = Trajectories([Endless(make(prey=2000, predators=0), 4000)], behind=25)
    paths.reach(200)
    tracemalloc.start()
    paths.reach(210)
    before = tracemalloc.get_traced_memory()[0]
    paths.reach(2000)
    assert tracemalloc.get_traced_memory()[0] - before < 100_000
    tracemalloc.stop()


def test_what_needs_the_future_is_refused(tame, tmp_path):
    for look in ({"camera": "follow"}, {"slow": True}):
        with pytest.raises(ValueError, match="record it first"):
            Composition(Played(tame, tame.ticks), SIZE, Look(**look), yuv=False)
    with pytest.raises(ValueError, match="say at which tick"):
        render.poster(Played(tame, tame.ticks), tmp_path / "a.png", SIZE)
    render.poster(Played(tame, tame.ticks), tmp_path / "a.png", SIZE, time=7)
    stage = Composition(Played(tame, tame.ticks), SIZE, Look(), yuv=False)
    stage.frame(9.0, stage.canvas.blank())
    with pytest.raises(ValueError, match="cannot go back"):
        stage.frame(2.0, stage.canvas.blank())


def test_a_simulation_runs_once(tame):
    live = Played(tame, tame.ticks)
    list(render.frames(live, (64, 64), 4))
    assert live.runs == 1
