"""Batches: the same bits wherever a trial runs, counts that add up, worlds that rotate."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.run import simulate_many
from tiswarm.engine.trials import batch
from tiswarm.engine.trials.kernel import OUTCOMES
from tiswarm.simd import runtime
from tiswarm.strategies import registry

# Each strategy once, in a kernel of its own, which two tests share; all pairs, mixed in one kernel, are test_properties.py's.
PAIRS = [(prey, "pronav") for prey in registry.names("prey")]
PAIRS += [("evasive", predator) for predator in registry.names("predators") if predator != "pronav"]


def _same(a, b, count=None):
    for name in OUTCOMES:
        np.testing.assert_array_equal(getattr(a, name)[:count], getattr(b, name)[:count], err_msg=name)


@pytest.mark.parametrize("strategy", registry.names("prey"))
def test_a_trial_alone_is_the_trial_in_the_batch(strategy):
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": strategy})
    seed = (1 << 64) - 3  # both of whose words have their highest bit set
    batch_of_many = tiswarm.simulate(scenario, 100, seed=seed)
    for trial in (0, 37, 99):
        path = tiswarm.record(scenario, trial, seed=seed)
        assert path.ticks == batch_of_many.ticks[trial]
        assert (path.prey.fate == "arrived").sum() == batch_of_many.arrived[trial]
        assert (path.prey.fate == "captured").sum() == batch_of_many.captured[trial]
        assert (path.prey.fate == "crashed").sum() == batch_of_many.crashed[trial]


@pytest.mark.parametrize(("prey", "predator"), PAIRS)
def test_counts_add_up_and_paths_are_finite(prey, predator):
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": prey, "predators.strategy": predator})
    results = tiswarm.simulate(scenario, 64)
    np.testing.assert_array_equal(results.alive + results.captured + results.crashed + results.arrived, results.spawned)
    path = tiswarm.record(scenario)
    path.check()
    assert np.isfinite(path.prey.position[path.prey.alive]).all()


def test_a_larger_batch_begins_with_the_smaller_one():
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "jump"})
    _same(tiswarm.simulate(scenario, 500), tiswarm.simulate(scenario, 133), 133)


def test_chunks_change_no_bit(monkeypatch):
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive"})
    whole = tiswarm.simulate(scenario, 300)
    monkeypatch.setattr(batch, "CHUNK", 37)
    _same(whole, tiswarm.simulate(scenario, 300))


@pytest.mark.anew
def test_threads_change_no_bit():
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "explode-evasive"})
    results = []
    for threads in (1, 2, 3):
        tiswarm.init("f32", threads)
        results.append(tiswarm.simulate(scenario, 200))
    tiswarm.init("f32")
    _same(results[0], results[1])
    _same(results[0], results[2])


def test_many_scenarios_in_one_kernel_give_the_bits_that_each_gives_alone():
    presets = [
        ("delft/pronav-10", {"prey.strategy": "split-evasive"}),
        ("delft/centre-0", {"prey.strategy": "jump"}),
        ("delft/centre-10", {"prey.strategy": "explode", "prey.avoidance": "outward", "prey.count": 9}),
        ("delft/pronav-0", {"predators.count": 4}),
    ]
    scenarios = [tiswarm.load(preset, overrides) for preset, overrides in presets]
    for scenario, together in zip(scenarios, simulate_many(scenarios, 60, seed=11), strict=True):
        _same(tiswarm.simulate(scenario, 60, seed=11), together)


def test_strategies_under_one_seed_meet_the_same_starts_and_obstacles():
    paths = [tiswarm.record(tiswarm.load("delft/pronav-10", {"prey.strategy": name}), 5, 9) for name in ("baseline", "jump")]
    np.testing.assert_array_equal(paths[0].prey.position[0], paths[1].prey.position[0])
    np.testing.assert_array_equal(paths[0].predators.velocity[0], paths[1].predators.velocity[0])
    np.testing.assert_array_equal(paths[0].obstacle_position, paths[1].obstacle_position)


def test_seeds_and_trials_differ():
    scenario = tiswarm.load("delft/pronav-10")
    starts = [tiswarm.record(scenario, trial, seed).prey.position[0] for trial, seed in ((0, 0), (1, 0), (0, 1))]
    assert not np.array_equal(starts[0], starts[1])
    assert not np.array_equal(starts[0], starts[2])


def test_starts_are_where_the_scenario_says():
    scenario = tiswarm.load("delft/pronav-10")
    for trial in range(20):
        path = tiswarm.record(scenario.replaced({"world.ticks": 1}), trial)
        assert ((path.prey.position[0] >= [80, 30]) & (path.prey.position[0] < [88, 38])).all()
        assert ((path.predators.position[0] >= [10, -7.5]) & (path.predators.position[0] < [18, 0.5])).all()
        assert ((path.prey.velocity[0] >= 0) & (path.prey.velocity[0] < 1)).all()
        assert ((path.obstacle_position >= [17.5, 0]) & (path.obstacle_position < [70, 50])).all()
        assert ((path.obstacle_radius >= 1) & (path.obstacle_radius < 2)).all()


class TestWeightsOfSingleTrials:
    def test_a_trial_runs_with_its_own_number(self):
        scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive"})
        evade = np.linspace(0, 0.05, 40)
        results = tiswarm.simulate(scenario, 40, seed=2, weights={"prey.weights.evade": evade})
        for trial in (0, 13, 39):
            alone = tiswarm.record(scenario.replaced({"prey.weights.evade": float(evade[trial])}), trial, seed=2)
            assert alone.ticks == results.ticks[trial]

    def test_every_numeric_key_may_differ(self):
        scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "split-evasive"})
        rng = np.random.default_rng(1)
        weights = {}
        for path, value in scenario.numbers().items():
            if path.endswith("count") or path == "world.ticks":
                weights[path] = np.maximum(rng.integers(max(1, int(value) - 2), int(value) + 1, 16), 1)
            elif (
                path != "measures.after"
                and path in batch.differing(scenario)
                and not path.startswith(("obstacles.", "prey.spawn", "predators.spawn"))
            ):
                weights[path] = value * rng.uniform(0.9, 1.1, 16)
        results = tiswarm.simulate(scenario, 16, weights=weights)
        for trial in range(16):
            numbers = {path: values[trial].item() for path, values in weights.items()}
            alone = tiswarm.simulate(scenario.replaced(numbers), trial + 1)
            assert alone.ticks[trial] == results.ticks[trial]
            assert alone.arrived[trial] == results.arrived[trial]
        np.testing.assert_array_equal(results.spawned, weights["prey.count"])

    def test_predators_may_come_from_the_numbers_alone(self):
        scenario = tiswarm.load("delft/pronav-10", {"predators.count": 0})
        counts = {"predators.count": np.array([0, 15] * 8)}
        results = tiswarm.simulate(scenario, 16, weights=counts)
        _same(tiswarm.simulate(scenario, 1), results, 1)
        alone = tiswarm.simulate(scenario.replaced({"predators.count": 15}), 2)
        assert (alone.ticks[1], alone.captured[1]) == (results.ticks[1], results.captured[1])

    def test_both_ends_of_a_range_may_move_together(self):
        scenario = tiswarm.load("delft/avoidance-10")
        ends = {"prey.spawn.region.0.0": np.full(4, 90.0), "prey.spawn.region.1.0": np.full(4, 95.0)}
        alone = tiswarm.simulate(scenario.replaced({"prey.spawn.region": [[90, 30], [95, 38]]}), 4)
        _same(alone, tiswarm.simulate(scenario, 4, weights=ends))

    @pytest.mark.parametrize(
        ("weights", "message"),
        [
            ({"prey.weights.evad": np.zeros(8)}, "did you mean 'prey.weights.evade'"),
            ({"prey.weights.evade": np.zeros(7)}, "each of the 8 trials"),
            ({"prey.radius": np.full(8, -1.0)}, "prey.radius: -1.0 is not allowed"),
            ({"prey.radius": np.full(8, np.nan)}, "finite"),
            ({"prey.count": np.full(8, 2.5)}, "whole number"),
            ({"prey.count": np.array([2, 2.7, 3, 3, 3, 3, 3, 3])}, "prey.count holds 2.7; use a whole number"),
            ({"prey.count": np.full(8, np.inf)}, "not finite"),
            ({"prey.spawn.region.0.0": np.linspace(80, 89, 8)}, "prey.spawn.region.0.0 is above prey.spawn.region.1.0"),
            ({"obstacles.radius.0": np.full(8, -1.0)}, "negative radius"),
        ],
    )
    def test_numbers_that_cannot_be_are_refused(self, weights, message):
        scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive"})
        with pytest.raises(tiswarm.ScenarioError, match=message):
            tiswarm.simulate(scenario, 8, weights=weights)


@pytest.mark.parametrize("avoidance", registry.names("avoidance"))
def test_prey_and_predators_may_use_every_avoidance(avoidance, share):
    keys = ("prey.avoidance", "predators.avoidance")
    share([tiswarm.load("delft/pronav-10", dict.fromkeys(keys, name)) for name in registry.names("avoidance")])
    scenario = tiswarm.load("delft/pronav-10", dict.fromkeys(keys, avoidance))
    results = tiswarm.simulate(scenario, 64)
    np.testing.assert_array_equal(results.alive + results.captured + results.crashed + results.arrived, 6)


TURNED = [name for name in registry.names("prey") if name != "jump"]


@pytest.mark.parametrize("strategy", TURNED)
def test_a_world_turned_by_a_right_angle_about_the_origin_gives_the_path_turned(strategy, f64, share):
    """Jump is left out: its kicks go into the first quadrant only, as the simulator's do."""
    share([tiswarm.load("delft/pronav-10", {"prey.strategy": name}) for name in TURNED])
    # Steps of a second are far too long for forces that grow without bound: any rounding would.
    dt = 0.01 if strategy == "potential" else 1.0
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": strategy, "world.ticks": 40, "world.dt": dt})
    path = tiswarm.record(scenario, 4)
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])  # rows times this: (x, y) -> (-y, x)
    start = tiswarm.Start(
        path.prey.position[0] @ turn,
        path.prey.velocity[0] @ turn,
        path.predators.position[0] @ turn,
        path.predators.velocity[0] @ turn,
        path.obstacle_position @ turn,
        path.obstacle_radius,
    )
    turned = tiswarm.record(scenario.replaced({"target.position": [-25, 10]}), 4, start=start)  # its luck is the trial's
    assert turned.ticks == path.ticks
    np.testing.assert_allclose(turned.prey.position, path.prey.position @ turn, atol=1e-7)
    np.testing.assert_allclose(turned.predators.position, path.predators.position @ turn, atol=1e-7)


def test_no_agent_is_faster_than_its_cap():
    path = tiswarm.record(tiswarm.load("delft/pronav-10", {"prey.strategy": "explode-evasive"}))
    for swarm in (path.prey, path.predators):
        assert np.nanmax(np.linalg.norm(swarm.velocity[1:], axis=2)) <= 1 + 1e-6


def test_a_million_trials_need_no_more_memory_in_flight_than_a_chunk():
    blocks = batch.Blocks([tiswarm.load("delft/pronav-10")], runtime.start().threads)
    lanes = blocks.blocks * runtime.LANES
    arrays = ("prey", "predators", "obstacles", "numbers", "clock", "integer", "sums", "ground")
    assert sum(getattr(blocks, name).nbytes for name in arrays) / lanes <= 4096


@pytest.mark.parametrize("trials", [0, -5])
def test_fewer_than_one_trial_is_refused(trials):
    with pytest.raises(ValueError, match="trials"):
        tiswarm.simulate(tiswarm.load("delft/pronav-10"), trials)


def test_progress_is_told_up_to_the_end():
    told = []
    tiswarm.simulate(tiswarm.load("delft/avoidance-10"), 50, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (50, 50)
