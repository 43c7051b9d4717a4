"""Torus: in a periodic world nothing has an edge: moving everything by half a world changes nothing, for all there is."""

import numpy as np
import pytest

import tiswarm
from render.scene.coverage import Coverage
from render.scene.trajectories import Trajectories
from render.theme import DARK
from tiswarm.engine.run import simulate_many
from tiswarm.measures import ground, recorded
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.measures import MEASURED
from tiswarm.scenario.model import validated
from tiswarm.strategies import registry

SIZE = np.array([40.0, 24.0, 32.0])
TICKS = 15
KEYS = {
    "title": "Torus",
    "world": {"ticks": TICKS, "boundary": "periodic"},
    "target": {"radius": 2},
    "obstacles": {"count": 3, "contact": "count"},
    "prey": {"count": 7, "perception": 9, "radius": 0.3, "goal": 0.05, "avoidance": "outward"},
    "predators": {"count": 3, "perception": 9, "goal": 0.1},
    "measures": {"distance": 4, "window": 4, "within": 1.5, "path": 2},
}


def scenario_of(dim, **changes):
    size = SIZE[:dim].tolist()
    corners = [[0.0] * dim, size]
    keys = {kind: dict(table) if isinstance(table, dict) else table for kind, table in KEYS.items()}
    keys["world"]["size"] = size
    keys["target"]["position"] = [36.0, 21.0, 3.0][:dim]
    keys["obstacles"]["region"] = corners
    for kind in ("prey", "predators"):
        keys[kind]["spawn"] = {"region": corners, "velocity": [[-1.0] * dim, [1.0] * dim]}
    return validated(keys).replaced(changes)


def start_of(scenario, moved):
    """Put prey and predators close together, across a corner of the world unless all is moved. moved: [dim], m."""
    rng, dim = np.random.default_rng(7), scenario.world.dim
    size = SIZE[:dim]
    prey = rng.uniform(-4, 4, (scenario.prey.count, dim))
    hunters = rng.uniform(-3, 3, (scenario.predators.count, dim)) + [5.0, -3.0, 2.0][:dim]
    obstacles = np.array([[6.5, 4.0, 1.0], [-6.0, 5.5, -2.0], [-7.5, -4.0, 3.0]])[:, :dim]
    places = [(each + moved) % size for each in (prey, hunters, obstacles)]
    speeds = [rng.uniform(-0.7, 0.7, each.shape) for each in places[:2]]
    return tiswarm.Start(places[0], speeds[0], places[1], speeds[1], places[2], [1.5, 1.0, 2.0])


def flown(scenario, moved):
    """Give the recording of a scenario in which everything is moved, [dim], m."""
    target = ((np.array(scenario.target.position) + moved) % SIZE[: scenario.world.dim]).tolist()
    own = scenario.replaced({"target.position": target}) if scenario.target.present else scenario
    return tiswarm.record(own, seed=3, start=start_of(own, moved))


def off(one, other, moved):
    """Give how far two recordings are from being one, of which the other is moved [m]; inf if others are there."""
    worst = 0.0
    for kind in ("prey", "predators"):
        a, b = getattr(one, kind), getattr(other, kind)
        if any((getattr(a, name) != getattr(b, name)).any() for name in ("fate", "alive", "state")):
            return np.inf
        way = one.shortest(b.position - a.position - moved)
        worst = max([worst, *(np.nanmax(np.abs(each)) for each in (way, b.velocity - a.velocity) if np.isfinite(each).any())])
    return worst


def moves(dim):
    """Half a world along each axis alone, and along all of them."""
    half = SIZE[:dim] / 2
    return [half * np.eye(dim)[0], half]


def keeps_still(scenario):
    """Give the most that a move by half a world changes [m]."""
    dim = scenario.world.dim
    home = flown(scenario, np.zeros(dim))
    return max(off(home, flown(scenario, moved), moved) for moved in moves(dim))


def _works(kind, name, dim):
    parts = [registry.load(kind, part) for part in registry.parts(kind, name)]
    return dim in registry.dimensions(kind, name) and all(part.periodic for part in parts)


def triples():
    """Join strategies, so that few trials have all of them: prey, predators, avoidance, dimensions."""
    for dim in (2, 3):
        able = [[name for name in registry.names(kind) if _works(kind, name, dim)] for kind in registry.KINDS]
        for k in range(max(map(len, able))):
            yield *(each[k % len(each)] for each in able), dim


def scenario_with(prey, predators, avoidance, dim, **changes):
    names = {"prey.strategy": prey, "predators.strategy": predators}
    for part in registry.parts("prey", prey) if dim == 3 else ():
        for key, flat in registry.load("prey", part).flat_only:
            names[f"prey.weights.{key}"] = next(word for word in registry.choices("prey", part)[key] if word != flat)
    return scenario_of(dim, **names, **{"prey.avoidance": avoidance, "predators.avoidance": avoidance}, **changes)


@pytest.mark.parametrize(("prey", "predators", "avoidance", "dim"), list(triples()))
def test_half_a_world_away_everything_is_the_same(prey, predators, avoidance, dim, f64, share):
    share([scenario_with(*each) for each in triples() if each[-1] == dim])
    assert keeps_still(scenario_with(prey, predators, avoidance, dim)) < 1e-6


LARGE = [
    ("explode", "centre", "directed-spiral", 2),
    ("split", "pronav", "distance-perception", 2),
    ("swallow", "hawk", "steer-away", 2),
    ("lookout", "centre", "outward", 3),
]


@pytest.mark.parametrize(("prey", "predators", "avoidance", "dim"), LARGE)
def test_large_swarms_have_no_edge_either(prey, predators, avoidance, dim, f64, share):
    share([scenario_with(*each) for each in LARGE if each[-1] == dim])
    scenario = scenario_with(prey, predators, avoidance, dim, **{"world.neighbours": "all-pairs"})
    grid = scenario.replaced({"world.neighbours": "grid"})
    still = np.zeros(dim)
    home = flown(scenario, still)
    assert off(home, flown(grid, still), still) < 1e-9
    assert off(home, flown(grid, SIZE[:dim] / 2), SIZE[:dim] / 2) < 1e-6


def test_means_ignore_the_edge(f64):
    """Prey beyond the edge, 4 m away, are chased there and not through the whole world."""
    keys = {"prey.goal": 0.0, "prey.cohesion": 0.0, "prey.alignment": 0.0, "target.present": False, "prey.avoidance": "none"}
    scenario = scenario_of(2, **keys, **{"predators.avoidance": "none", "predators.strategy": "centre", "predators.goal": 1.0})
    prey = [[38.0, 4.0], [39.0, 5.0], [0.5, 4.5]]
    start = tiswarm.Start(prey, np.zeros((3, 2)), [[3.0, 4.5]], [[0.0, 0.0]], np.zeros((0, 2)), [])
    path = tiswarm.record(scenario, start=start).predators.position[:, 0]
    assert path[1, 0] == pytest.approx(2.0)  # at 1 m/s towards the mean at x = 39.17
    assert path[1, 1] == pytest.approx(4.5, abs=1e-9)


def test_every_measure_ignores_the_edge(f64):
    scenario = scenario_of(2, **{"coverage.cell": 0.5, "coverage.tool": 0.8, "target.present": False, "predators.count": 0})
    scenario = scenario.replaced({"measures.names": list(MEASURED), "prey.cohesion": 0.02})
    half = SIZE[:2] / 2
    home, away = flown(scenario, np.zeros(2)), flown(scenario, half)
    assert recorded.measured(home, "coverage") > 0.02
    for name in MEASURED:
        assert recorded.measured(home, name) == pytest.approx(recorded.measured(away, name), abs=1e-6, nan_ok=True), name
    for neighbours in ("all-pairs", "grid"):
        _measures_are_those_of_recordings(scenario.replaced({"world.neighbours": neighbours}))


def _measures_are_those_of_recordings(scenario):
    results = tiswarm.simulate(scenario, 3, seed=2)
    for trial in range(3):
        path = tiswarm.record(scenario, trial=trial, seed=2)
        for name in MEASURED:
            told = results.measures[name][trial]
            assert told == pytest.approx(recorded.measured(path, name), rel=1e-6, abs=1e-6, nan_ok=True), name


def test_a_tool_wider_than_the_world_sweeps_a_cell_but_once(f64):
    keys = {"coverage.cell": 2.0, "coverage.tool": 45.0, "measures.names": ["coverage", "visit-variation"], "prey.count": 1}
    scenario = scenario_of(2, **keys, **{"predators.count": 0, "obstacles.count": 0, "target.present": False})
    results, path = tiswarm.simulate(scenario, 1), tiswarm.record(scenario)
    assert results.measures["coverage"][0] == ground.ground(path).share[-1] == 1.0
    assert (ground.ground(path).visits == TICKS + 1).all()
    assert results.measures["visit-variation"][0] == 0.0


def test_ground_is_cleaned_across_the_edge(f64):
    keys = {"coverage.cell": 0.5, "coverage.tool": 0.8, "predators.count": 0, "target.present": False}
    scenario = scenario_of(2, **keys, **{"measures.names": ["coverage"]})
    for moved in (np.zeros(2), SIZE[:2] / 2):
        recording = flown(scenario, moved)
        paths = Trajectories([recording])
        shown = Coverage(paths, DARK)
        paths.reach(TICKS)
        assert shown.share(TICKS) == pytest.approx(recorded.measured(recording, "coverage"), abs=1e-12)


def test_obstacles_that_a_trial_lacks_are_nowhere_in_a_periodic_world(f64):
    base = scenario_of(2, **{"prey.count": 40, "obstacles.contact": "crash", "obstacles.count": 0, "predators.count": 0})
    many = base.replaced({"obstacles.count": 20})
    alone, among = tiswarm.simulate(base, 20, seed=1), simulate_many([base, many], 20, seed=1)[0]
    assert alone.crashed.sum() == 0
    assert (among.crashed == alone.crashed).all()


def test_a_sight_that_does_not_wrap_keeps_its_edges(f64):
    scenario = scenario_of(2, **{"prey.strategy": "explode", "predators.strategy": "centre", "world.wrap_sight": False})
    assert keeps_still(scenario) > 0.1


COMPASS = '''"""Compass: fly to the origin of the map."""

import taichi as ti

from tiswarm.strategies import Prey, place, scaled


class Strategy(Prey):
    periodic = {periodic}

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        return scaled(place(me), -0.05)
'''


@pytest.mark.parametrize("periodic", [True, False])
def test_a_users_strategy_is_held_to_it(periodic, tmp_path, monkeypatch, f64):
    monkeypatch.setattr(registry, "_folders", [])
    (tmp_path / "prey").mkdir()
    (tmp_path / "prey" / "compass.py").write_text(COMPASS.format(periodic=periodic))
    registry.add_path(tmp_path)
    try:
        assert ("compass" in {prey for prey, *_ in triples()}) == periodic
        if periodic:
            assert keeps_still(scenario_with("compass", "centre", "none", 2)) > 0.1
        else:
            with pytest.raises(ScenarioError, match=r"prey.strategy: 'compass' has no meaning in a world without edges; use"):
                scenario_with("compass", "centre", "none", 2)
    finally:
        monkeypatch.undo()
        for cached in (registry._files, registry.load, registry.parts):
            cached.cache_clear()
