"""Large swarms do what trials of few agents do, at any number of threads, alone or among others."""

import numpy as np
import pytest

import render
import tiswarm
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.choice import by_grid
from tiswarm.engine.swarms import compiled
from tiswarm.engine.swarms.population import space_of
from tiswarm.engine.swarms.simulation import Swarm
from tiswarm.engine.swarms.transfer import kept_rows
from tiswarm.engine.trials.trial import Single
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import validated
from tiswarm.simd import runtime
from tiswarm.space.cell_list import Grid
from tiswarm.strategies import registry


def world(side, dim=2, boundary="periodic", count=60, **prey):
    return validated(
        {
            "world": {"size": [side] * dim, "boundary": boundary, "contact": "none", "ticks": 1000},
            "target": {"present": False},
            "prey": {
                "count": count,
                "perception": 1.0,
                "spacing": 0.3,
                "max_speed": 0.1,
                "cohesion": 0.005,
                "separation": 0.05,
                "alignment": 0.05,
                "spawn": {"region": [[0] * dim, [side] * dim], "velocity": [[-0.1] * dim, [0.1] * dim]},
                **prey,
            },
        }
    )


@pytest.mark.parametrize(
    ("boundary", "dim", "side"),
    [(edge, *room) for edge in ("periodic", "walls", "open") for room in ((2, 5.0), (3, 3.2))] + [("periodic", 2, 1.3)],
)
def test_a_large_swarm_does_what_a_trial_does(dim, side, boundary, f64):
    scenario = world(side, dim, boundary)
    swarm = Swarm(scenario, seed=7, trials=3)
    singles = [Single(scenario, 7, trial) for trial in range(3)]
    for tick in range(51):
        for trial, single in enumerate(singles):
            for ours, its in ((swarm.position(), single.position), (swarm.velocity(), single.velocity)):
                away = ours[trial] - its("prey")
                if boundary == "periodic":
                    away -= side * np.round(away / side)
                assert np.abs(away).max() <= (0 if tick == 0 else 1e-9)
        swarm.step()
        for single in singles:
            single.step()


@pytest.mark.anew
def test_threads_change_no_bit():
    states = []
    for threads in (1, 2, 2):
        tiswarm.init("f32", threads)
        swarm = Swarm(world(70.0, count=10_000), seed=1, trials=2)
        for _ in range(10):
            swarm.step()
        states.append((swarm.position(), swarm.velocity()))
    for other in states[1:]:
        assert np.array_equal(states[0][0], other[0])
        assert np.array_equal(states[0][1], other[1])


@pytest.mark.parametrize("boundary", ["periodic", "open"])
def test_a_trial_among_others_is_the_trial_alone(boundary, f32):
    scenario = world(12.0, boundary=boundary, count=501)
    every = Swarm(scenario, seed=3, trials=4)
    alone = Swarm(scenario, start=(every.position()[2:3], every.velocity()[2:3]))
    for _ in range(20):
        every.step()
        alone.step()
    assert np.array_equal(every.position()[2], alone.position()[0])


@pytest.mark.parametrize("dim", [2, 3])
def test_boids_without_memory_keep_no_rows_by_number(dim, f32):
    layout = ParameterTable(Specialisation.of([world(4.0, dim)], 0, mortal=False), runtime.types().lanes)
    assert kept_rows(layout, "prey") == []


def test_terms_between_pairs_conserve_momentum(f64):
    swarm = Swarm(world(8.0, count=800, cohesion=0.0, alignment=0.0, max_speed=100.0), seed=2)
    before = swarm.velocity().sum(axis=1)
    for _ in range(20):
        swarm.step()
    assert np.abs(swarm.velocity().sum(axis=1) - before).max() < 1e-9


def test_those_who_are_gone_stay_gone(f32):
    scenario = world(6.0, count=40)
    swarm = Swarm(scenario, seed=4)
    position, velocity = swarm.position(), swarm.velocity()
    position[0, ::3], velocity[0, ::3] = np.nan, np.nan
    swarm = Swarm(scenario, start=(position, velocity))
    rest = Swarm(scenario, start=(position[:, ~np.isnan(position[0, :, 0])], velocity[:, ~np.isnan(position[0, :, 0])]))
    for _ in range(5):
        swarm.step()
        rest.step()
    assert np.array_equal(np.isnan(swarm.position()), np.isnan(position))
    assert np.array_equal(swarm.position()[~np.isnan(position)], rest.position().ravel())


def test_agents_far_outside_an_open_world_keep_working(f64):
    scenario = world(6.0, boundary="open", count=50, cohesion=0.0)  # lone agents are drawn to the origin
    near = Swarm(scenario, seed=5)
    far = Swarm(scenario, start=(near.position() + 1e6, near.velocity()))
    for _ in range(10):
        near.step()
        far.step()
    apart = np.ptp(near.position() - far.position(), axis=1)
    assert np.abs(apart).max() < 1e-6


def test_what_cannot_be_is_refused(f32):
    scenario = world(6.0, count=5)
    swarm = Swarm(scenario)
    position = swarm.position()
    position[0, 2, 0] = np.nan
    with pytest.raises(ValueError, match="not finite"):
        Swarm(scenario, start=(position, swarm.velocity()))
    with pytest.raises(ValueError, match="need"):
        Swarm(scenario, start=(position[0], swarm.velocity()))
    with pytest.raises(ScenarioError, match=r"world\.contact.*all-pairs"):
        Swarm(scenario.replaced({"world.contact": "bounce"}))


@pytest.mark.parametrize("boundary", ["periodic", "open"])
def test_ticks_in_one_go_are_ticks_one_by_one(boundary, f32, monkeypatch):
    scenario = world(8.0, boundary=boundary, count=300)
    at_once = Swarm(scenario, seed=6, trials=2)
    at_once.step(12)
    monkeypatch.setattr("tiswarm.engine.swarms.state.SMALL", 0)
    single = Swarm(scenario, seed=6, trials=2)
    for _ in range(12):
        single.step()
    assert at_once.age == single.age == 12
    assert np.array_equal(at_once.position(), single.position())


NOISE = '''"""Tumble: angular noise."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.strategies import Prey, cosine, sine


class Strategy(Prey):
    """A kick of a fixed size in any direction."""

    dimensions = (2, 3)
    dice = True

    @dataclass(frozen=True)
    class Weights:
        noise: float = 0.05  # size of the kick [m/s]

    @staticmethod
    @ti.func
    def kick(threat, dice, memory, weights):
        angle = 6.283185307179586 * dice.a
        return weights.noise * cosine(angle), weights.noise * sine(angle)
'''


@pytest.fixture
def tumbling(tmp_path, monkeypatch):
    """Give lone prey that tumble: a tick's change of velocity is what they were kicked by."""
    monkeypatch.setattr(registry, "_folders", [])
    (tmp_path / "prey").mkdir()
    (tmp_path / "prey" / "tumble.py").write_text(NOISE)
    tiswarm.add_path(tmp_path)
    still = dict.fromkeys(("cohesion", "separation", "alignment"), 0.0)
    yield world(8.0, strategy="tumble", **still | {"max_speed": 100.0})
    registry._files.cache_clear()
    registry.load.cache_clear()


@pytest.mark.parametrize("small", [0, 2_048])
def test_random_kicks_without_memory_are_those_of_trials(tumbling, small, f64, monkeypatch):
    monkeypatch.setattr("tiswarm.engine.swarms.state.SMALL", small)
    swarm, single = Swarm(tumbling, seed=6, trials=2, trial=3), Single(tumbling, 6, 4)
    before, kicks = swarm.velocity(), []
    for ticks in (1, 1, 3):
        swarm.step(ticks)
        single.step(ticks)
        assert np.abs(swarm.velocity()[1] - single.velocity("prey")).max() < 1e-12
        kicks.append(swarm.velocity() - before)
        before = swarm.velocity()
    assert np.abs(kicks[0] - kicks[1]).max() > 0.05, "two ticks kick alike"
    assert np.abs(kicks[0][0] - kicks[0][1]).max() > 0.05, "two trials kick alike"
    other = Swarm(tumbling, seed=7, start=(swarm.position()[:1], before[:1]), trial=3)
    same = Swarm(tumbling, seed=6, start=(swarm.position()[:1], before[:1]), trial=3)
    other.step()
    same.step()
    assert np.abs(same.velocity()[0] - before[0] - kicks[0][0]).max() < 1e-12
    assert np.abs(other.velocity()[0] - before[0] - kicks[0][0]).max() > 0.05, "two seeds kick alike"


@pytest.mark.parametrize("avoidance", ["steer-away", "distance-perception"])
def test_looking_for_obstacles_where_there_are_none(avoidance, f32):
    swarm, plain = (Swarm(world(8.0, avoidance=name), seed=6) for name in (avoidance, "none"))
    swarm.step(3)
    plain.step(3)
    assert np.array_equal(swarm.position(), plain.position())


CROWD = {"prey.count": 203, "predators.count": 50, "obstacles.count": 30, "world.ticks": 40, "prey.strategy": "jump"}


@pytest.fixture
def crowd():
    place = {"prey.spawn.region": [[40, 10], [90, 40]], "predators.spawn.region": [[20, 5], [60, 45]]}
    return tiswarm.load(
        "delft/pronav-10", CROWD | place | {"prey.perception": 6, "prey.avoidance": "spiral", "world.neighbours": "grid"}
    )


@pytest.mark.anew
def test_a_hunted_crowd_has_the_same_bits_at_any_number_of_threads_and_alone(crowd):
    states = []
    for threads in (1, *[2] * 30):  # two threads meet in many ways
        tiswarm.init("f32", threads)
        swarm = Swarm(crowd, seed=5, trials=3)
        swarm.step(30)
        states.append((swarm.position(), swarm.velocity("predators"), swarm.counts))
    alone = Swarm(crowd, seed=5, trial=2)
    alone.step(30)
    for other in states[1:]:
        for one, again in zip(states[0], other, strict=True):
            assert np.array_equal(one, again, equal_nan=True)
    assert np.array_equal(states[0][0][2], alone.position()[0], equal_nan=True)
    assert (states[0][2][:, 2:].sum(axis=0) > 0).all()  # some were captured, some crashed


def test_a_batch_a_recording_and_a_swarm_agree(crowd, f32):
    results = tiswarm.simulate(crowd, trials=3, seed=5)
    recording = tiswarm.record(crowd, trial=1, seed=5)
    swarm = Swarm(crowd, seed=5, trials=3)
    swarm.step(40)
    assert swarm.ended.all()
    assert np.array_equal(results.captured, swarm.counts[:, 2])
    assert np.array_equal(results.alive + results.arrived + results.captured + results.crashed, [203] * 3)
    assert np.array_equal(recording.prey.position[-1], swarm.position()[1], equal_nan=True)
    recording.check()
    assert "jumped" in recording.prey.state


def test_who_uses_a_grid():
    few, flock = tiswarm.load("delft/pronav-10"), world(50.0, count=5000)
    assert not by_grid(few)
    assert by_grid(flock)
    assert not by_grid(flock.replaced({"world.neighbours": "all-pairs"}))
    assert by_grid(flock.replaced({"measures.names": ["polarisation"]}))  # measuring never changes who runs it
    with pytest.raises(ScenarioError, match=r"world\.neighbours: all pairs of 20,000"):
        by_grid(flock.replaced({"prey.count": 20_000, "world.neighbours": "all-pairs"}))


def test_swarms_of_one_kind_of_world_share_the_kernels_of_contact():
    def kernels(changes):
        scenario = tiswarm.load("delft/pronav-10", changes)
        layout = ParameterTable(Specialisation.of([scenario], 1), runtime.types().lanes)
        grids = {kind: Grid(space_of(scenario, kind), 5.0, 20) for kind in ("prey", "predators", "obstacles")}
        return compiled.of(layout, grids).contacts

    plain = kernels({})
    assert kernels({"prey.strategy": "split-evasive", "predators.strategy": "centre", "prey.nearest": 4}) is plain
    assert kernels({"prey.avoidance": "outward"}) is not plain
    assert kernels({"world.contact_test": "swept"}) is not plain


def test_a_swarm_can_be_filmed_while_it_runs(crowd, f32, tmp_path):
    film = render.film(
        Swarm(crowd.replaced({"world.ticks": 3}), seed=5), tmp_path / "crowd.mp4", size=(320, 180), quality="draft"
    )
    assert film.path.stat().st_size > 1000
    assert film.frames == (0.3 + 1) * 60
