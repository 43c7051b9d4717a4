"""Measures of large swarms: what NumPy finds in recordings of the same trials, at any number of threads, and no bit changed."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.swarms.measures import Measures
from tiswarm.engine.swarms.simulation import Swarm
from tiswarm.measures import recorded
from tiswarm.scenario.measures import COVERED, MEASURED, SWEPT

BODIES = [name for name in MEASURED if name not in SWEPT]
DEEP = [name for name in BODIES if name != "trapped-milling"]
TRAPS = {"measures.window": 8, "measures.within": 2.0, "measures.path": 1.0}
FLAT = TRAPS | {
    "world.size": [30, 24],
    "world.ticks": 25,
    "world.neighbours": "grid",
    "prey.count": 123,
    "prey.perception": 1.5,
    "prey.max_speed": 0.4,
    "prey.radius": 0.05,
    "prey.strategy": "baseline",
    "prey.avoidance": "none",
    "prey.spawn.region": [[2, 2], [28, 22]],
    "prey.spawn.velocity": [[-0.4, -0.4], [0.4, 0.4]],
    "predators.count": 0,
    "target.present": False,
    "obstacles.count": 6,
    "obstacles.region": [[5, 5], [25, 20]],
    "obstacles.radius": [0.5, 1.5],
    "obstacles.contact": "count",
    "coverage.cell": 0.5,
    "coverage.tool": 0.9,
    "measures.names": list(MEASURED),
}
DEEP_WORLD = {
    "world.size": [12, 10, 9],
    "prey.spawn.region": [[1, 1, 1], [11, 9, 8]],
    "prey.spawn.velocity": [[-0.4] * 3, [0.4] * 3],
    "obstacles.region": [[3, 3, 3], [9, 7, 6]],
    "coverage.cell": 0,
    "measures.names": DEEP,
}


def compared(scenario, trials=3, seed=4):
    """Hold all measures of trials against recordings of the same trials; give them."""
    results = tiswarm.simulate(scenario, trials, seed)
    assert results.engine == "grid"
    for trial in range(trials):
        recording = tiswarm.record(scenario, trial, seed)
        for name in scenario.measures.names:
            found, told = results.measures[name][trial], recorded.measured(recording, name)
            assert found == pytest.approx(told, rel=1e-9, abs=1e-9, nan_ok=True), (name, trial)
    return results.measures


@pytest.mark.parametrize("boundary", ["open", "periodic", "walls"])
@pytest.mark.parametrize("distance", [0.7, 4.0])  # within what prey see, and beyond
def test_measures_of_a_plane(boundary, distance, f64):
    base = tiswarm.load("delft/avoidance-10", FLAT)
    found = compared(base.replaced({"world.boundary": boundary, "measures.distance": distance, "measures.after": 5}))
    for name in MEASURED:
        if name not in COVERED:
            assert np.isfinite(found[name]).all(), name
    assert np.isfinite(found["time-to-50"]).all()
    assert (found["hits"] > 0).any()
    assert (found["trapped"] > 0).all()
    assert (found["groups"] < 123).all()


@pytest.mark.parametrize("boundary", ["open", "periodic", "walls"])
def test_measures_of_space(boundary, f64):
    base = tiswarm.load("delft/avoidance-10", FLAT).replaced({"prey.strategy": "lookout"} | DEEP_WORLD)
    found = compared(base.replaced({"world.boundary": boundary, "measures.distance": 1.7}))
    assert all(np.isfinite(found[name]).all() for name in DEEP)


@pytest.mark.parametrize("boundary", ["open", "periodic", "walls"])
@pytest.mark.parametrize("dim", [2, 3])
def test_the_nearest_is_found_however_far_away(boundary, dim, f64):
    """Of three far apart, of two clusters at the ends of a large world with one agent between, and of many at random."""
    random = np.random.default_rng(dim)
    side = 2000.0 if dim == 2 else 300.0
    clusters = np.concatenate([random.uniform(0, 2, (30, dim)), side - random.uniform(0, 2, (30, dim)), [[0.4 * side] * dim]])
    loose = {
        "world.size": [side] * dim,
        "world.boundary": boundary,
        "prey.spawn.region": [[0] * dim, [side] * dim],
        "prey.spawn.velocity": [[0] * dim, [0] * dim],
        "obstacles.count": 0,
        "coverage.cell": 0,
        "measures.names": ["nearest", "groups"],
        "measures.distance": 0.45 * side,
        "prey.strategy": "baseline" if dim == 2 else "lookout",
    }
    scenario = tiswarm.load("delft/avoidance-10", FLAT).replaced(loose)
    for places in (random.uniform(0, side, (3, dim)), clusters, random.uniform(0, side, (200, dim)), clusters[:1]):
        start = tiswarm.Start(places, np.zeros_like(places), np.zeros((0, dim)), np.zeros((0, dim)), np.zeros((0, dim)), [])
        recording = tiswarm.record(scenario.replaced({"world.ticks": 1}), start=start)
        found = Measures(Swarm(scenario, start=start)).values()
        for name in ("nearest", "groups"):
            told = getattr(recorded, name)(recording)[0]
            assert found[name][0] == pytest.approx(told, rel=1e-9, nan_ok=True), (name, len(places))


def test_groups_of_a_winding_chain_are_one(f64):
    """Labels have a long way to go along a spiral of agents, numbered at random; a gap makes two of it."""
    turn = np.sqrt(np.arange(900)) * 1.9
    spiral = 15 + 0.13 * (turn * [np.cos(turn), np.sin(turn)]).T
    gaps = np.linalg.norm(np.diff(spiral, axis=0), axis=1)
    spiral = np.random.default_rng(1).permutation(spiral)
    base = tiswarm.load("delft/avoidance-10", FLAT | {"world.size": [30, 30], "measures.names": ["groups"], "coverage.cell": 0})
    still = np.zeros_like(spiral)
    none = np.zeros((0, 2))
    for distance in (gaps.max() * 1.0001, 0.5 * gaps.max()):
        start = tiswarm.Start(spiral, still, none, none, none, [])
        scenario = base.replaced({"measures.distance": float(distance), "obstacles.count": 0})
        found = Measures(Swarm(scenario, start=start)).values()["groups"][0]
        recording = tiswarm.record(scenario.replaced({"world.ticks": 1}), start=start)
        assert found == recorded.groups(recording)[0]


HUNT = {
    "world.ticks": 40,
    "world.neighbours": "grid",
    "prey.count": 203,
    "predators.count": 50,
    "obstacles.count": 30,
    "prey.perception": 6,
    "prey.avoidance": "spiral",
    "prey.strategy": "jump",
    "prey.spawn.region": [[40, 10], [90, 40]],
    "predators.spawn.region": [[20, 5], [60, 45]],
    "coverage.cell": 1.0,
    "measures.names": [name for name in MEASURED if name != "hits"],  # nobody hits an obstacle and lives
} | TRAPS


@pytest.fixture
def hunted():
    return tiswarm.load("delft/pronav-10", HUNT)


def test_those_who_are_gone_are_not_measured(hunted, f64):
    compared(hunted.replaced({"measures.distance": 3.0, "measures.after": 2}))
    assert (tiswarm.simulate(hunted, 3, 4).captured > 0).all()
    brief = compared(hunted.replaced({"measures.after": 1000, "measures.names": ["speed", "groups", "nearest"]}))
    assert np.isfinite(brief["speed"]).all()  # the last state counts, however late measuring begins


@pytest.mark.anew
def test_measuring_changes_no_bit_and_threads_change_no_measure(hunted):
    plain = hunted.replaced({"measures.names": [], "coverage.cell": 0})
    found = []
    for threads in (1, 2, 2):
        tiswarm.init("f32", threads)
        results = tiswarm.simulate(hunted, 3, 5)
        found.append(results.measures)
        bare = tiswarm.simulate(plain, 3, 5)
        assert np.array_equal(results.captured, bare.captured)
        assert np.array_equal(results.crashed, bare.crashed)
    for other in found[1:]:
        for name in hunted.measures.names:
            assert np.array_equal(found[0][name], other[name], equal_nan=True), name
    watched, alone = Swarm(hunted, 5, 3), Swarm(plain, 5, 3)
    measures = Measures(watched)
    for _ in range(40):
        watched.step()
        measures.take()
        alone.step()
    for kind in ("prey", "predators"):
        assert np.array_equal(watched.position(kind), alone.position(kind), equal_nan=True)
        assert np.array_equal(watched.velocity(kind), alone.velocity(kind), equal_nan=True)


def test_a_trial_among_others_measures_what_it_does_alone(hunted, f32, monkeypatch):
    together = tiswarm.simulate(hunted, 3, 5).measures
    monkeypatch.setattr("tiswarm.engine.swarms.batch.AT_ONCE", 1)
    for name, values in tiswarm.simulate(hunted, 3, 5).measures.items():
        assert np.array_equal(values, together[name], equal_nan=True), name
