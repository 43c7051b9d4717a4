"""Touches on the way: `world.contact_test = "swept"` judges where bodies come closest within a tick, on both engines."""

import numpy as np
import pytest

import tiswarm

ENGINES = ["all-pairs", "grid"]
# Nobody steers: whoever starts with a velocity keeps it.
STRAIGHT = {
    "world.contact_test": "swept",
    "prey.strategy": "baseline",
    "prey.avoidance": "none",
    "prey.goal": 0,
    "prey.cohesion": 0,
    "prey.separation": 0,
    "prey.alignment": 0,
    "predators.strategy": "centre",
    "predators.avoidance": "none",
    "predators.goal": 0,
    "predators.cohesion": 0,
    "predators.separation": 0,
    "predators.alignment": 0,
    "prey.max_speed": 1000,
    "predators.max_speed": 1000,
    "target.present": False,
    "predators.spawn.region": [[60, 25], [75, 35]],
}


RING = {
    "world.boundary": "periodic",
    "prey.avoidance": "none",
    "predators.avoidance": "none",
    "prey.goal": 0,
    "predators.perception": 10,
    "predators.strategy": "hawk",
    "prey.spawn.region": [[80, 20], [99, 40]],
}


def straight(engine: str, **more) -> tiswarm.Scenario:
    return tiswarm.load("delft/pronav-10", STRAIGHT | {"world.neighbours": engine} | more)


def start(prey, predators=(), obstacles=()) -> tiswarm.Start:
    """Build a start from rows of place and velocity, and of centre and radius."""
    dim = len(prey[0]) // 2
    prey, predators = (np.array(each, float).reshape(-1, 2 * dim) for each in (prey, predators))
    obstacles = np.array(obstacles, float).reshape(-1, dim + 1)
    return tiswarm.Start(
        prey[:, :dim], prey[:, dim:], predators[:, :dim], predators[:, dim:], obstacles[:, :dim], obstacles[:, dim]
    )


BYSTANDER = [[70, 40, 0, 0]]  # a predator that meets nobody: kernels of worlds with predators serve those without


def fates(scenario, prey, predators=(), obstacles=(), ticks=1) -> list[str]:
    if scenario.world.dim == 2 and len(predators) == 0:
        predators = BYSTANDER
    simulation = tiswarm.Simulation(scenario, start=start(prey, predators, obstacles))
    simulation.step(ticks)
    return list(simulation.fate())


@pytest.mark.parametrize("engine", ENGINES)
def test_head_on_pairs_are_captured_at_every_gap(engine):
    gaps = np.linspace(1.0, 4.9, 40)
    prey = [[10, 5 * n, 1, 0] for n in range(40)]
    predators = [[10 + gap, 5 * n, -1, 0] for n, gap in enumerate(gaps)]
    assert fates(straight(engine), prey, predators, ticks=3) == ["captured"] * 40
    missed = fates(straight(engine, **{"world.contact_test": "places"}), prey, predators, ticks=3)
    assert missed.count("alive") == 10


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("aside", "fate"), [(0.0, "crashed"), (1.45, "crashed"), (1.55, "alive")])
def test_an_obstacle_crossed_at_ten_metres_a_tick_is_hit(engine, aside, fate):
    who = ([[10, 20, 10, 0]], (), [[15, 20 + aside, 1]])
    assert fates(straight(engine), *who) == [fate]
    assert fates(straight(engine, **{"world.contact_test": "places"}), *who) == ["alive"]


@pytest.mark.parametrize("engine", ENGINES)
def test_spheres_targets_and_counted_hits(engine):
    deep = {"world.size": [100, 100, 100], "predators.count": 0, "prey.spawn.region": [[1, 1, 1], [2, 2, 2]]}
    deep |= {"prey.spawn.velocity": [[0, 0, 0], [1, 1, 1]], "predators.spawn.velocity": [[0, 0, 0], [1, 1, 1]]}
    deep |= {"predators.spawn.region": [[1, 1, 1], [2, 2, 2]], "obstacles.region": [[1, 1, 1], [2, 2, 2]]}
    deep |= {"target.position": [1, 1, 1]}
    prey = [[10, 10, 10, 12, 12, 12], [40, 10, 10, 12, 12, 12]]
    assert fates(straight(engine, **deep), prey, (), [[16, 16, 17, 1]]) == ["crashed", "alive"]
    target = {"target.present": True, "target.position": [50, 20], "target.radius": 2}
    assert fates(straight(engine, **target), [[40, 20, 20, 0], [40, 21.6, 20, 0]]) == ["arrived", "alive"]
    recorded = tiswarm.Simulation(straight(engine, **target), start=start([[9, 9, 0, 0]], [[40, 20, 20, 0]]))
    recorded.step()
    assert list(recorded.fate("predators")) == ["crashed"]
    counted = straight("all-pairs", **{"obstacles.contact": "count", "measures.names": ["hits"], "world.ticks": 1})
    assert fates(counted, [[10, 20, 10, 0]], (), [[15, 20, 1]]) == ["alive"]


@pytest.mark.parametrize("engine", ENGINES)
def test_across_a_periodic_edge(engine):
    ring = {"world.boundary": "periodic", "prey.perception": 3}
    prey, predators = [[95, 25, 12, 0], [95, 5, 12, 0]], [[3, 25, -4, 0]]
    assert fates(straight(engine, **ring), prey, predators) == ["captured", "alive"]
    assert fates(straight(engine, **ring), prey, (), [[0.5, 5, 1]]) == ["alive", "crashed"]
    assert fates(straight(engine, **ring), [[50, 49, 0, 6]], (), [[50, 2, 1]]) == ["crashed"]


@pytest.mark.parametrize("engine", ENGINES)
def test_half_steps_count_as_one_way(engine):
    verlet = {"world.scheme": "verlet"}
    assert fates(straight(engine, **verlet), [[10, 20, 10, 0]], (), [[12, 20, 1]]) == ["crashed"]
    assert fates(straight(engine, **verlet), [[10, 20, 10, 0]], (), [[18, 20, 1]]) == ["crashed"]
    assert fates(straight(engine, **verlet), [[10, 20, 10, 0]], (), [[22, 20, 1]]) == ["alive"]
    assert fates(straight(engine, **verlet), [[10, 20, 10, 0]], [[20, 20, -10, 0]]) == ["captured"]


@pytest.mark.parametrize("engine", ENGINES)
def test_a_start_touches_nothing_and_walls_stop_the_way(engine):
    walls = {"world.boundary": "walls"}
    touching = ([[10, 20, 0, 0]], (), [[10, 20, 1]])
    assert fates(straight(engine, **walls), *touching, ticks=0) == ["alive"]
    assert fates(straight(engine, **walls), *touching) == ["crashed"]
    assert fates(straight(engine, **walls), [[90, 20, 30, 0]], (), [[85, 20, 3]]) == ["alive"]
    assert fates(straight(engine, **walls), [[90, 20, 30, 0]], (), [[95, 20, 1]]) == ["crashed"]


def closest(place, velocity, other, other_velocity):
    """Sample how near two bodies come in a tick of one second: distances [one, other]."""
    times = np.linspace(0, 1, 4001)[:, None, None, None]
    way = place[:, None] - other[None] + times * (velocity[:, None] - other_velocity[None])
    return np.sqrt(np.einsum("tijk,tijk->tij", way, way).min(axis=0))


def test_both_engines_find_what_sampling_finds():
    rng = np.random.default_rng(3)
    prey, predators = (rng.uniform([0, 0, -6, -6], [60, 40, 6, 6], (count, 4)) for count in (300, 25))
    obstacles = rng.uniform([0, 0, 0.2], [60, 40, 0.9], (20, 3))
    near = closest(prey[:, :2], prey[:, 2:], predators[:, :2], predators[:, 2:]).min(axis=1) - 0.75
    still = np.zeros((20, 2))
    hit = (closest(prey[:, :2], prey[:, 2:], obstacles[:, :2], still) - obstacles[:, 2]).min(axis=1) - 0.5
    lost = (closest(predators[:, :2], predators[:, 2:], obstacles[:, :2], still) - obstacles[:, 2]).min(axis=1) - 0.25
    free = lost > 0
    near = closest(prey[:, :2], prey[:, 2:], predators[free, :2], predators[free, 2:]).min(axis=1) - 0.75
    clear = (np.abs(near) > 1e-3) & (np.abs(hit) > 1e-3)
    expected = np.where(hit < 0, "crashed", np.where(near < 0, "captured", "alive"))
    assert np.abs(lost).min() > 1e-3
    assert min((expected == fate).sum() for fate in ("crashed", "captured", "alive")) > 20
    for engine in ENGINES:
        found = np.array(fates(straight(engine, **{"prey.radius": 0.5, "predators.radius": 0.25}), prey, predators, obstacles))
        np.testing.assert_array_equal(found[clear], expected[clear])


IN_THE_OPEN = [{"prey.strategy": "evasive", "prey.max_speed": 3, "predators.max_speed": 5}, {"prey.strategy": "jump"}]
CHASES = [
    *IN_THE_OPEN,
    RING | {"world.scheme": "verlet", "predators.max_speed": 4, "predators.goal": 1},
    {"world.contact": "eaten", "world.boundary": "walls", "predators.strategy": "hawk"},
]


def chase(changes):
    close = {"predators.spawn.region": [[60, 25], [75, 35]], "prey.perception": 12, "obstacles.region": [[40, 10], [80, 45]]}
    few = {"prey.count": 21, "world.ticks": 40, "world.contact_test": "swept"}
    return tiswarm.load("delft/pronav-10", few | close | changes)


@pytest.mark.parametrize("changes", CHASES)
def test_chases_end_alike_on_both_engines(changes, f64, share):
    if changes in IN_THE_OPEN:
        share([chase(each) for each in IN_THE_OPEN])
    scenario = chase(changes)
    ends = set()
    for trial in range(2):
        one, other = (
            tiswarm.record(scenario.replaced({"world.neighbours": engine}), trial, seed=7) for engine in ("all-pairs", "grid")
        )
        for kind in ("prey", "predators"):
            np.testing.assert_array_equal(getattr(one, kind).fate, getattr(other, kind).fate)
            np.testing.assert_allclose(getattr(one, kind).position, getattr(other, kind).position, atol=1e-8, rtol=0)
        ends |= set(one.prey.fate)
    assert "captured" in ends


def test_presets_of_the_thesis_judge_places_and_all_others_the_way():
    from tiswarm.scenario.presets import presets

    for name in presets():
        rule = "places" if name.startswith("delft/") or name == "demo/chase" else "swept"
        assert tiswarm.load(name).world.contact_test == rule, name
    assert tiswarm.Scenario().world.contact_test == "swept"
