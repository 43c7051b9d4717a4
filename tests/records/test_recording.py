"""Recordings: what they hold, and that a file is whole or not there."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.trials.trial import field

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def path():
    return tiswarm.record(tiswarm.load("delft/pronav-10", {"prey.strategy": "split"}), trial=3, seed=7)


def test_shapes_and_the_start_row(path):
    assert path.prey.position.shape == (path.ticks + 1, 6, 2)
    assert path.predators.velocity.shape == (path.ticks + 1, 15, 2)
    assert path.prey.position.dtype == np.float64
    assert path.prey.alive[0].all()
    assert path.obstacle_position.shape == (10, 2)
    assert path.obstacle_radius.shape == (10,)


def test_those_who_are_gone_have_a_fate_and_no_place(path):
    last = path.prey.alive[-1]
    np.testing.assert_array_equal(path.prey.fate == "alive", last)
    assert np.isnan(path.prey.position[-1][~last]).all()


def test_split_names_its_two_groups(path):
    np.testing.assert_array_equal(path.prey.group[0], [1, 0, 1, 0, 1, 0])
    assert (path.predators.group == -1).all()


def test_states_say_who_is_alarmed_exploding_or_jumped():
    explode = tiswarm.record(tiswarm.load("delft/pronav-10", {"prey.strategy": "explode"}))
    assert set(np.unique(explode.prey.state)) == {"calm", "alarmed", "exploding"}
    assert (explode.prey.state == "exploding").sum(axis=0).max() == 50
    assert explode.prey.state[0].tolist() == ["calm"] * 6
    jump = tiswarm.record(tiswarm.load("delft/pronav-10", {"prey.strategy": "jump"}))
    assert "jumped" in jump.prey.state


def test_saved_and_loaded_it_is_the_same(path, tmp_path):
    again = tiswarm.Recording.load(path.save(tmp_path / "a" / "path.npz"))
    assert (again.scenario, again.seed, again.trial) == (path.scenario, 7, 3)
    for kind in ("prey", "predators"):
        for name in ("position", "velocity", "fate", "state", "group"):
            np.testing.assert_array_equal(getattr(getattr(again, kind), name), getattr(getattr(path, kind), name))
    assert sorted(file.name for file in (tmp_path / "a").iterdir()) == ["path.npz"]


def test_the_same_trial_is_recorded_with_the_same_bits(path):
    again = tiswarm.record(path.scenario, trial=3, seed=7)
    np.testing.assert_array_equal(again.prey.position, path.prey.position)


def test_an_explicit_start_is_row_0_and_sets_the_counts(f64):
    start = tiswarm.Start([[60, 20], [62, 21]], [[0, 0], [0.5, 0]], np.zeros((0, 2)), np.zeros((0, 2)), [[40, 20]], [1.5])
    path = tiswarm.record(tiswarm.load("delft/avoidance-10"), start=start)
    np.testing.assert_array_equal(path.prey.position[0], [[60, 20], [62, 21]])
    assert (path.scenario.prey.count, path.scenario.predators.count, path.scenario.obstacles.count) == (2, 0, 1)
    np.testing.assert_array_equal(path.obstacle_radius, [1.5])


NONE = np.zeros((0, 2))


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (([[0, 0, 0, 0]], [[0, 0, 0, 0]], NONE, NONE, NONE, []), "prey_position has shape"),
        (([[0, 0]], [[0, 0], [1, 1]], NONE, NONE, NONE, []), "prey_velocity"),
        (([[0, np.nan]], [[0, 0]], NONE, NONE, NONE, []), "not finite"),
        ((NONE, NONE, NONE, NONE, NONE, []), "1 prey or more"),
        (([[0, 0]], [[0, 0]], NONE, NONE, [[1, 1]], [1, 2]), "one radius an obstacle"),
    ],
)
def test_a_start_that_cannot_be_is_refused(arrays, message):
    with pytest.raises(ValueError, match=message):
        tiswarm.Start(*arrays)


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x03\x04 broken"])
def test_a_file_that_is_no_recording_is_named(content, tmp_path):
    file = tmp_path / "x.npz"
    file.write_bytes(content)
    with pytest.raises(ValueError, match=r"x\.npz: not a recording"):
        tiswarm.Recording.load(file)


@pytest.mark.parametrize("name", ["seed", "prey_position", "prey_velocity", "prey_fate", "obstacle_position"])
def test_an_archive_with_one_wrong_array_is_no_recording(name, path, tmp_path):
    stored = dict(np.load(path.save(tmp_path / "x.npz")))
    np.savez(tmp_path / "x.npz", **{**stored, name: np.array(["a", "b"])})
    with pytest.raises(ValueError, match="not a recording"):
        tiswarm.Recording.load(tmp_path / "x.npz")


def test_a_single_array_is_no_recording(tmp_path):
    with (tmp_path / "x.npz").open("wb") as file:
        np.save(file, np.zeros(3))
    with pytest.raises(ValueError, match="not a recording"):
        tiswarm.Recording.load(tmp_path / "x.npz")


def test_an_archive_of_something_else_is_no_recording(tmp_path):
    np.savez(tmp_path / "x.npz", a=np.zeros(3))
    with pytest.raises(ValueError, match="not a recording"):
        tiswarm.Recording.load(tmp_path / "x.npz")


@pytest.mark.parametrize("trial", [-1, 1 << 31])
def test_a_trial_number_out_of_range_is_refused(trial):
    with pytest.raises(ValueError, match="trial"):
        tiswarm.record(tiswarm.load("delft/avoidance-10"), trial)


def test_the_sampled_field_is_the_avoidances_own(f64):
    recording = tiswarm.record(tiswarm.load("delft/avoidance-10", {"prey.avoidance": "outward", "world.ticks": 1}), 3)
    points, arrows = field(recording, across=50)
    assert points.shape == arrows.shape == (50 * 25, 2)
    away = points[:, None] - recording.obstacle_position
    distance2 = (away**2).sum(axis=2)
    near = (distance2 <= (recording.obstacle_radius + 3.0) ** 2) & (distance2 >= recording.obstacle_radius**2)
    free = (distance2 >= recording.obstacle_radius**2).all(axis=1)
    expected = (np.where(near, 10.0 / distance2, 0.0)[..., None] * away).sum(axis=1) * free[:, None]
    np.testing.assert_allclose(arrows, expected, atol=1e-12)


def test_a_deep_world_has_no_field_to_draw():
    recording = tiswarm.record(tiswarm.load("lookout/aquarium", {"world.ticks": 1, "prey.count": 2}))
    with pytest.raises(ValueError, match="flat world"):
        field(recording)
