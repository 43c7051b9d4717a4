"""Networks: the plain strategy's path where they answer its gains, NumPy's forward pass, one network a trial, own frames."""

import numpy as np
import pytest
import taichi as ti

import tiswarm
from tiswarm.dynamics import networks
from tiswarm.engine.run import simulate_many
from tiswarm.engine.trials.candidates import Candidates
from tiswarm.scenario.network import Network, Shape, begun, constant, read
from tiswarm.simd import runtime
from tiswarm.simd.runtime import LANES

THESIS = Shape("thesis", "gains", (8, 16, 12, 5))
OWN = Shape("own", "velocity", (13, 6, 2))
LED = {"prey.strategy": "neural", "prey.avoidance": "kitchen-sink", "world.ticks": 80}


def _random(shape, seed, size=0.3):
    return Network(shape, np.random.default_rng(seed).normal(0, size, shape.size))


def _led(tmp_path, network, **more):
    return tiswarm.load("delft/centre-10", LED | {"prey.weights.network": str(network.save(tmp_path / "n.npz"))} | more)


@pytest.fixture
def tanh(precision):
    types = runtime.types()
    flat = types.lane_array(1)

    @ti.kernel
    def run(values: flat, out: flat, count: ti.i32):
        for i in range(count):
            out[i] = networks.tanh(values[i])

    def of(numbers):
        values = runtime.aligned((len(numbers) // LANES, LANES), types.dtype)
        out = runtime.aligned(values.shape, types.dtype)
        values[:] = numbers.reshape(values.shape)
        run(values, out, len(values))
        return values.ravel().astype(np.float64), out.ravel()

    return of


def test_tanh_is_right_to_a_millionth_odd_and_never_falls(tanh):
    values, found = tanh(np.linspace(-12, 12, 80_000))
    assert np.abs(found - np.tanh(values)).max() < 1e-6
    assert np.abs(found).max() <= 1
    mirrored = tanh(-values)[1]
    np.testing.assert_array_equal(found, -mirrored)
    falls = np.diff(found.astype(np.float64))
    assert falls.min() >= -4 * np.finfo(found.dtype).epsneg  # what rounding of its six operations may do, and no more
    steep = found[np.abs(values) < 6][::200].astype(np.float64)  # where a step is more than rounding
    assert (np.diff(steep) > 0).all()


@pytest.mark.parametrize("shape", [THESIS, Shape("own", "gains", (13, 5)), Shape("own", "velocity", (13, 20, 3, 7, 2))])
def test_a_forward_pass_is_numpy_s(shape, f64):
    types = runtime.types()
    flat = types.lane_array(1)
    wide = shape.layers[0]

    @ti.kernel
    def run(numbers: flat, agents: flat, inputs: flat):
        for _ in range(1):
            told = [inputs[k] for k in ti.static(range(wide))]
            networks.forward(shape, numbers, 0, agents, 0, told)

    rng = np.random.default_rng(1)
    every = [_random(shape, seed) for seed in range(LANES)]  # one a lane
    numbers = runtime.aligned((shape.size, LANES), types.dtype)
    agents = runtime.aligned((shape.scratch, LANES), types.dtype)
    inputs = runtime.aligned((wide, LANES), types.dtype)
    numbers[:] = np.stack([each.weights for each in every], axis=1)
    inputs[:] = rng.normal(size=inputs.shape)
    run(numbers, agents, inputs)
    for lane, each in enumerate(every):
        np.testing.assert_allclose(agents[-shape.layers[-1] :, lane], each.outputs_of(inputs[:, lane]), atol=3e-7)
        hidden = inputs[:, lane]
        place = row = 0
        for number, (before, after) in enumerate(zip(shape.layers, shape.layers[1:], strict=False)):
            rows = each.weights[place : place + (before + 1) * after].reshape(after, before + 1)
            total = rows[:, :-1] @ hidden + rows[:, -1]
            hidden = agents[row : row + after, lane]
            if number == len(shape.layers) - 2:
                np.testing.assert_allclose(hidden, total, atol=1e-12)
            place, row = place + rows.size, row + after


@pytest.mark.parametrize(("kind", "plain"), [("prey", "baseline"), ("predators", "centre")])
def test_a_network_that_answers_the_plain_gains_gives_the_plain_trajectory(kind, plain, tmp_path, f64):
    gains = constant(THESIS, np.array([0.05, 0.05, 0.005, 0.1, 1.0]))
    file = str(gains.save(tmp_path / "n.npz"))
    base = tiswarm.load("delft/centre-10", {"prey.avoidance": "kitchen-sink"})
    led = base.replaced({f"{kind}.strategy": "neural", f"{kind}.weights.network": file})
    for trial in range(2):
        a, b = (tiswarm.record(each, trial) for each in (base.replaced({f"{kind}.strategy": plain}), led))
        np.testing.assert_allclose(a.prey.position, b.prey.position, atol=1e-12)
        np.testing.assert_allclose(a.predators.position, b.predators.position, atol=1e-12)


def test_a_velocity_network_that_answers_nothing_gives_the_plain_trajectory(tmp_path, f64):
    led = _led(tmp_path, constant(OWN, np.zeros(2)))
    a, b = (tiswarm.record(each) for each in (led.replaced({"prey.strategy": "baseline"}), led))
    np.testing.assert_allclose(a.prey.position, b.prey.position, atol=1e-12)


def test_a_thousand_networks_in_one_batch_are_a_thousand_runs(tmp_path, f32):
    every = np.stack([_random(OWN, seed).weights for seed in range(1000)])
    scenario = _led(tmp_path, constant(OWN, np.zeros(2)))
    crowd = Candidates(scenario, {})
    none = np.zeros((1000, 0))
    found = crowd.run(none, np.arange(2), 0, {"prey": every})
    outcome = found.ticks.reshape(1000, 2)
    assert len(np.unique(outcome[:, 0])) > 3
    for k in range(0, 1000, 37):
        alone = crowd.run(none[:1], np.arange(2), 0, {"prey": every[k : k + 1]})
        np.testing.assert_array_equal(alone.ticks, outcome[k])
        np.testing.assert_array_equal(alone.arrived, found.arrived.reshape(1000, 2)[k])
    file = str(Network(OWN, every[74]).save(tmp_path / "one.npz"))
    single = tiswarm.record(scenario.replaced({"prey.weights.network": file}), 1)
    assert single.ticks == outcome[74, 1]


def test_batches_mix_networks_of_one_shape_and_none(tmp_path, f32):
    files = [str(_random(OWN, seed).save(tmp_path / f"{seed}.npz")) for seed in range(2)]
    base = _led(tmp_path, constant(OWN, np.zeros(2)))
    every = [base.replaced({"prey.strategy": "evasive"}), *(base.replaced({"prey.weights.network": file}) for file in files)]
    for scenario, together in zip(every, simulate_many(every, 20), strict=True):
        alone = tiswarm.simulate(scenario, 20)
        np.testing.assert_array_equal(together.ticks, alone.ticks)
        np.testing.assert_array_equal(together.arrived, alone.arrived)
    other = base.replaced({"prey.weights.network": "networks/thesis-gains.npz"})
    with pytest.raises(tiswarm.ScenarioError, match="networks differ in shape"):
        simulate_many([base, other], 5)


@pytest.mark.parametrize("outputs", ["gains", "velocity"])
def test_own_frame_networks_turn_with_the_world(outputs, tmp_path, f64):
    """A quarter turn of everything: the same trial, turned. Cohesion draws lone agents to the origin, about which all turns."""
    network = _random(Shape("own", outputs, (13, 8, 5 if outputs == "gains" else 2)), 5, 0.2)
    scenario = _led(tmp_path, network, **{"prey.avoidance": "outward", "world.ticks": 30, "target.position": [0.0, 0.0]})
    rng = np.random.default_rng(2)
    prey, hunters, stones = rng.uniform(20, 60, (6, 2)), rng.uniform(10, 50, (5, 2)), rng.uniform(10, 60, (4, 2))
    rates, chase = rng.normal(size=(6, 2)), rng.normal(size=(5, 2))
    quarter = np.array([[0.0, 1.0], [-1.0, 0.0]])
    paths = [
        tiswarm.record(
            scenario, start=tiswarm.Start(*(each @ turn for each in (prey, rates, hunters, chase, stones)), np.ones(4))
        )
        for turn in (np.eye(2), quarter)
    ]
    np.testing.assert_allclose(paths[0].prey.position @ quarter, paths[1].prey.position, atol=1e-9)
    order = rng.permutation(6)
    mixed = tiswarm.record(scenario, start=tiswarm.Start(prey[order], rates[order], hunters, chase, stones, np.ones(4)))
    np.testing.assert_allclose(paths[0].prey.position[:, order], mixed.prey.position, atol=1e-9)


def test_a_network_changes_the_scenario_s_hash_and_its_place_does_not(tmp_path):
    a, b = _random(OWN, 1), _random(OWN, 2)
    first = _led(tmp_path, a)
    held = first.hash()
    moved = first.replaced({"prey.weights.network": str(a.save(tmp_path / "moved.npz"))})
    assert moved.hash() == held
    assert first.replaced({"prey.weights.network": str(b.save(tmp_path / "b.npz"))}).hash() != held


def test_a_network_beside_a_preset_is_found_from_anywhere(tmp_path, monkeypatch):
    _random(OWN, 1).save(tmp_path / "nets" / "mine.npz")
    (tmp_path / "own.toml").write_text('base = "delft/neural"\n[prey.weights]\nnetwork = "nets/mine.npz"\n', encoding="utf-8")
    monkeypatch.chdir("/")
    assert tiswarm.load(str(tmp_path / "own.toml")).network("prey").shape == OWN
    assert tiswarm.load("delft/neural").network("prey").shape == THESIS
    assert tiswarm.load("delft/neural").network("predators") is None


def test_networks_are_written_and_read_whole(tmp_path):
    network = begun(THESIS, np.array([1.0, 2.0, 3.0, 4.0, 5.0]), seed=3)
    again = read(str(network.save(tmp_path / "n.npz")))
    assert again.shape == THESIS
    np.testing.assert_array_equal(again.weights, network.weights)
    np.testing.assert_allclose(again.outputs_of(np.ones((7, 8))), np.tile([1.0, 2.0, 3.0, 4.0, 5.0], (7, 1)))


def _broken(path, **changes):
    arrays = {"inputs": "own", "outputs": "velocity", "layers": [13, 6, 2], "weights": np.zeros(OWN.size)}
    np.savez(path, **{key: np.array(value) for key, value in (arrays | changes).items()})


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"weights": np.zeros(3)}, "3 weights for layers of 13-6-2, which have 98"),
        ({"weights": np.full(98, np.nan)}, "not finite"),
        ({"layers": [8, 6, 2]}, "layers of 8-6-2 do not fit; use 13 inputs"),
        ({"layers": [13, 200, 2]}, "use 1 to 64 numbers a layer"),
        ({"inputs": "eyes"}, "'eyes' to 'velocity' is not known"),
    ],
)
def test_wrong_networks_are_refused_in_one_line(changes, told, tmp_path):
    _broken(tmp_path / "n.npz", **changes)
    with pytest.raises(tiswarm.ScenarioError, match=r"prey\.weights\.network") as error:
        tiswarm.load("delft/neural", {"prey.weights.network": str(tmp_path / "n.npz")})
    assert told in str(error.value)
    assert "\n" not in str(error.value)


def test_what_is_no_network_is_refused(tmp_path):
    (tmp_path / "n.npz").write_bytes(b"PK nothing")
    for name, told in (("nowhere.npz", "no file"), (str(tmp_path / "n.npz"), "is no network"), (4.0, "name a file")):
        with pytest.raises(tiswarm.ScenarioError, match=told):
            tiswarm.load("delft/neural", {"prey.weights.network": name})
    with pytest.raises(tiswarm.ScenarioError, match=r"prey\.strategy: a grid of neighbours cannot do 'neural'"):
        tiswarm.simulate(tiswarm.load("delft/neural", {"world.neighbours": "grid"}), 2)


def test_training_a_network_helps_and_is_written_beside_its_preset(tmp_path, f32):
    begun(Shape("own", "velocity", (13, 4, 2)), np.array([-0.5, 0.5])).save(tmp_path / "start.npz")  # which runs in circles
    scenario = tiswarm.load("delft/centre-10", LED | {"prey.weights.network": str(tmp_path / "start.npz"), "world.ticks": 120})
    small = {"budget": 16 * 24 * 12, "candidates": 16, "trials": 24, "checks": 200, "validation": 400}
    tuned = tiswarm.tune(scenario, network="prey", folder=tmp_path / "out", **small)
    assert tuned.improved
    assert tuned.validations[0].difference.low > 0.02
    (tmp_path / "out").rename(tmp_path / "moved")
    again = tiswarm.load(str(tmp_path / "moved" / "best.toml"))
    assert again.hash() == tuned_hash(tmp_path / "moved")
    np.testing.assert_allclose(tiswarm.simulate(again, 400).success.mean(), tuned.validations[0].tuned.mean, rtol=1e-12)


def tuned_hash(folder):
    import json

    return json.loads((folder / "manifest.json").read_text())["tuned_hash"][0]


def test_training_without_a_network_or_a_folder_is_refused(tmp_path):
    plain, led = tiswarm.load("delft/centre-10"), tiswarm.load("delft/neural")
    with pytest.raises(tiswarm.ScenarioError, match=r"--set prey\.strategy=neural"):
        tiswarm.tune(plain, network="prey", folder=tmp_path)
    with pytest.raises(tiswarm.ScenarioError, match="name a folder"):
        tiswarm.tune(led, network="prey")
    with pytest.raises(tiswarm.ScenarioError, match="use prey or predators"):
        tiswarm.tune(led, network="wolves", folder=tmp_path)
