"""A simulation is stepped, looked at and changed between ticks, the same on both engines."""

import numpy as np
import pytest
import taichi as ti
from taichi.lang.kernel_impl import Kernel

import tiswarm
from tiswarm.engine.trials.batch import differing

CHASE = {
    "world.ticks": 30,
    "prey.strategy": "evasive",
    "predators.spawn.region": [[60, 25], [75, 35]],
    "obstacles.region": [[40, 10], [80, 45]],
    "prey.perception": 12,
}
ENGINES = ["all-pairs", "grid"]
NEW = {
    "prey.weights.evade": 0.7,
    "prey.cohesion": 0.4,
    "predators.radius": 2.0,
    "target.position": [90.0, 20.0],
    "prey.weights.push": 0.9,
}


def chase(engine: str, **more) -> tiswarm.Scenario:
    return tiswarm.load("delft/pronav-10", {**CHASE, "world.neighbours": engine, **more})


def assert_same(one: tiswarm.Recording, other: tiswarm.Recording) -> None:
    for kind in ("prey", "predators"):
        for name in ("position", "velocity", "fate", "state", "group"):
            np.testing.assert_array_equal(getattr(getattr(one, kind), name), getattr(getattr(other, kind), name))
    np.testing.assert_array_equal(one.obstacle_position, other.obstacle_position)
    np.testing.assert_array_equal(one.obstacle_radius, other.obstacle_radius)


@pytest.fixture
def compiled(monkeypatch) -> list[str]:
    """List the kernels that Taichi builds from now on."""
    built: list[str] = []
    materialize = Kernel.materialize

    def noted(self, key=None, **rest):
        if key not in self.compiled_kernels:
            built.append(self.func.__name__)
        return materialize(self, key, **rest)

    monkeypatch.setattr(Kernel, "materialize", noted)
    tiswarm.init()

    @ti.kernel
    def probe():
        pass

    probe()
    assert built == ["probe"], "a kernel is built that this list does not see"
    built.clear()
    return built


@pytest.mark.parametrize("engine", ENGINES)
def test_stepping_gives_the_bits_of_a_recording(engine):
    scenario = chase(engine)
    recording = tiswarm.record(scenario, trial=4, seed=9)
    simulation = tiswarm.Simulation(scenario, seed=9, trial=4)
    assert simulation.engine == engine
    assert (simulation.age, simulation.max_ticks, simulation.ended) == (0, 30, False)
    for steps in (0, 1, 1, 3, 7, 0, 9):
        simulation.step(steps)
        for kind, path in (("prey", recording.prey), ("predators", recording.predators)):
            moment = simulation.moment(kind)
            np.testing.assert_array_equal(simulation.position(kind), path.position[simulation.age])
            np.testing.assert_array_equal(simulation.velocity(kind), path.velocity[simulation.age])
            np.testing.assert_array_equal(moment.position, path.position[simulation.age])
            np.testing.assert_array_equal(moment.state, path.state[simulation.age])
            np.testing.assert_array_equal(moment.group, path.group[simulation.age])
    assert simulation.age == 21
    simulation.step(1000)
    assert simulation.ended
    assert simulation.age == recording.ticks
    np.testing.assert_array_equal(simulation.fate("prey"), recording.prey.fate)
    assert set(simulation.fate("prey")) > {"alive"}
    np.testing.assert_array_equal(simulation.obstacles[0], recording.obstacle_position)
    np.testing.assert_array_equal(simulation.obstacles[1], recording.obstacle_radius)


@pytest.mark.parametrize("engine", ENGINES)
def test_many_ticks_at_once_give_the_bits_of_one_after_the_other(engine):
    for ticks in (30, 300):  # cut off by its last tick, and over before it
        scenario = chase(engine, **{"world.ticks": ticks, "predators.radius": 4.0})
        step, leap = tiswarm.Simulation(scenario, 3), tiswarm.Simulation(scenario, 3)
        while not step.ended:
            step.step()
        leap.step(7)
        leap.step(ticks)
        assert leap.ended
        assert leap.age == step.age
        for kind in ("prey", "predators"):
            np.testing.assert_array_equal(leap.position(kind), step.position(kind))
            np.testing.assert_array_equal(leap.velocity(kind), step.velocity(kind))
            np.testing.assert_array_equal(leap.fate(kind), step.fate(kind))
    assert leap.age < 300, "the trial was to end on the way"


@pytest.mark.parametrize("engine", ENGINES)
def test_a_start_of_ones_own_gives_the_counts(engine):
    none = np.zeros((0, 2))
    start = tiswarm.Start(np.array([[50.0, 30.0], [52.0, 31.0]]), np.ones((2, 2)), none, none, none, np.zeros(0))
    simulation = tiswarm.Simulation(chase(engine), start=start)
    assert simulation.scenario.prey.count == 2
    np.testing.assert_array_equal(simulation.position(), start.prey_position)
    assert simulation.position("predators").shape == (0, 2)
    deep = tiswarm.Start(np.ones((2, 3)), np.ones((2, 3)), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))
    with pytest.raises(ValueError, match="use as many"):
        tiswarm.Simulation(chase(engine), start=deep)


@pytest.mark.parametrize("engine", ENGINES)
def test_numbers_set_at_the_start_are_those_of_a_scenario(engine):
    simulation = tiswarm.Simulation(chase(engine), seed=2)
    simulation.set(NEW)
    assert simulation.scenario.target.position == (90.0, 20.0)
    assert_same(simulation.record(), tiswarm.record(chase(engine, **NEW), seed=2))


@pytest.mark.parametrize("engine", ENGINES)
def test_wider_perception_needs_other_cells_only(engine):
    simulation = tiswarm.Simulation(chase(engine, **{"prey.strategy": "explode-evasive"}), seed=2)
    simulation.set({"prey.perception": 17.0, "predators.perception": 29.0})
    wide = {"prey.strategy": "explode-evasive", "prey.perception": 17.0, "predators.perception": 29.0}
    assert_same(simulation.record(), tiswarm.record(chase(engine, **wide), seed=2))


@pytest.mark.parametrize("engine", ENGINES)
def test_numbers_set_between_ticks_act_from_then_on_without_a_new_kernel(engine, compiled):
    simulation = tiswarm.Simulation(chase(engine), seed=2)
    simulation.step(9)
    same = tiswarm.Simulation(chase(engine), seed=2)
    same.step(9)
    compiled.clear()
    same.set({"prey.weights.evade": same.scenario.prey.weights["evade"]})
    before = simulation.position()
    simulation.set(NEW | {"predators.radius": 0.25, "prey.perception": 12.0})
    np.testing.assert_array_equal(simulation.position(), before)
    simulation.step(3)
    same.step(3)
    assert compiled == []
    plain = tiswarm.record(chase(engine), seed=2)
    np.testing.assert_array_equal(same.position(), plain.prey.position[12])
    assert not np.array_equal(simulation.position(), plain.prey.position[12])


def test_both_engines_agree_on_a_change(f64):
    both = [tiswarm.Simulation(chase(engine), seed=2) for engine in ENGINES]
    for simulation in both:
        simulation.step(8)
        simulation.set(NEW | {"prey.perception": 15.0, "predators.max_speed": 3.0})
        simulation.step(10)
    one, other = both
    for kind in ("prey", "predators"):
        np.testing.assert_allclose(one.position(kind), other.position(kind), atol=1e-9, rtol=0)
        np.testing.assert_array_equal(one.fate(kind), other.fate(kind))
    assert "captured" in one.fate()


@pytest.mark.parametrize("engine", ENGINES)
def test_more_ticks_may_be_set_before_the_end_and_nothing_behind_it(engine):
    simulation = tiswarm.Simulation(chase(engine, **{"world.ticks": 5}), seed=2)
    simulation.step(4)
    simulation.set({"world.ticks": 8})
    simulation.step(100)
    assert (simulation.age, simulation.ended) == (8, True)
    with pytest.raises(ValueError, match="the trial is over"):
        simulation.set({"world.ticks": 10})


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"prey.strategy": "explode"}, "prey.strategy is no number that may change"),
        ({"prey.count": 7}, "prey.count acts at the start only"),
        ({"prey.spawn.region": [[0, 0], [1, 1]]}, "prey.spawn.region acts at the start only"),
        ({"obstacles.radius": [1, 2]}, "obstacles.radius acts at the start only"),
        ({"world.boundary": "periodic"}, "world.boundary is no number"),
        ({"prey.weights.evda": 1}, "evda"),
        ({"prey.max_speed": -1}, "prey.max_speed"),
    ],
)
def test_what_may_not_change_is_refused_and_changes_nothing(changes, told):
    simulation = tiswarm.Simulation(chase("all-pairs"), seed=2)
    with pytest.raises(tiswarm.ScenarioError, match=told):
        simulation.set({"prey.cohesion": 0.9} | changes)
    assert simulation.scenario == chase("all-pairs")


def test_all_numbers_that_may_differ_between_trials_can_be_set_but_those_of_the_start():
    simulation = tiswarm.Simulation(chase("all-pairs"), seed=2)
    numbers = simulation.scenario.numbers()
    for path in sorted(differing(simulation.scenario)):
        if path.endswith(".count") or ".spawn." in path or path.startswith("obstacles.") or ":" in path:
            continue
        whole = path in ("world.ticks", "measures.after", "measures.window")
        simulation.set({path: int(numbers[path]) if whole else numbers[path]})
    assert simulation.scenario == chase("all-pairs")


def test_wrong_arguments_are_told():
    simulation = tiswarm.Simulation(chase("all-pairs"))
    with pytest.raises(ValueError, match="use 'prey' or 'predators'"):
        simulation.position("hawks")
    with pytest.raises(ValueError, match="use 0 or more"):
        simulation.step(-1)


def test_results_say_which_engine_ran_them(tmp_path):
    import json

    for engine in ENGINES:
        results = tiswarm.simulate(chase(engine), trials=4)
        assert results.engine == engine
        assert json.loads((results.save(tmp_path / engine) / "manifest.json").read_text())["engine"] == engine


def test_a_scenario_may_be_named(f32):
    named, loaded = (tiswarm.simulate(each, 8) for each in ("delft/avoidance-10", tiswarm.load("delft/avoidance-10")))
    assert named.success.tolist() == loaded.success.tolist()
    assert tiswarm.Simulation("delft/avoidance-10").scenario == tiswarm.load("delft/avoidance-10")
    with pytest.raises(tiswarm.ScenarioError, match="did you mean 'delft/avoidance-10'"):
        tiswarm.record("delft/avoidence-10")
