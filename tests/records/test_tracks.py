"""Tracks: paths under the names of other libraries, and recordings made of tables of tracked animals."""

import numpy as np
import pandas as pd
import pytest

import render
import tiswarm
from render.scene.trajectories import Trajectories
from tiswarm.measures.recorded import polarisation

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def path():
    changes = {"world.dt": 0.5, "world.gains": "per-second", "prey.avoidance": "none"}
    return tiswarm.record(tiswarm.load("delft/pronav-10", changes), trial=3, seed=7)


@pytest.fixture
def tracks():
    """Three animals: one all the time, one that comes late and leaves early, one with a gap."""
    rows = [(frame, 1, 0.5 * frame, 2.0) for frame in range(10, 20)]
    rows += [(frame, 5, 4.0, 0.25 * frame) for frame in range(13, 17)]
    rows += [(frame, 9, frame - 10.0, frame - 10.0) for frame in range(10, 20) if frame not in (14, 15)]
    return pd.DataFrame(rows, columns=["frame", "particle", "x", "y"])


def test_tracks_have_the_columns_of_trackpy_and_a_time(path):
    tracks = path.to_tracks()
    assert list(tracks)[:6] == ["frame", "particle", "t", "kind", "x", "y"]
    assert len(tracks) == path.prey.alive.sum() + path.predators.alive.sum()
    seconds = (tracks["t"] - pd.Timestamp(0)).dt.total_seconds()
    np.testing.assert_allclose(seconds, 0.5 * tracks["frame"])
    third = tracks[tracks["particle"] == 3]
    np.testing.assert_array_equal(third[["x", "y"]], path.prey.position[: len(third), 3])


def test_a_path_comes_back_from_its_tracks(path):
    world = path.scenario.world
    again = tiswarm.Recording.from_tracks(path.to_tracks(), size=world.size, dt=world.dt)
    for kind in ("prey", "predators"):
        np.testing.assert_array_equal(getattr(again, kind).position, getattr(path, kind).position)
        there = np.isfinite(getattr(again, kind).velocity)
        ours, theirs = (getattr(each, kind).velocity[there] for each in (again, path))
        assert np.median(np.abs(ours - theirs)) < 0.02  # differences of places: not the velocity of a tick, but near it
    assert again.scenario.predators.count == 15


def test_animals_come_and_go_and_gaps_are_filled_by_straight_ways(tracks):
    recording = tiswarm.Recording.from_tracks(tracks, size=(10, 10), dt=0.1, title="Three")
    position = recording.prey.position
    np.testing.assert_array_equal(recording.prey.alive.sum(axis=0), [10, 4, 10])
    np.testing.assert_array_equal(np.flatnonzero(recording.prey.alive[:, 1]), [3, 4, 5, 6])
    np.testing.assert_allclose(position[:, 2, 0], np.arange(10))
    np.testing.assert_allclose(recording.prey.velocity[:, 2], 10.0)
    assert recording.prey.fate.tolist() == ["alive"] * 3
    assert (recording.scenario.title, recording.scenario.world.dt) == ("Three", 0.1)


def test_a_periodic_world_is_crossed_the_short_way():
    frames = np.arange(8)
    tracks = {"frame": frames, "particle": np.zeros(8, int), "x": (8.0 + frames) % 10, "y": np.full(8, 5.0)}
    tracks = {name: np.delete(values, 3) for name, values in tracks.items()}  # lost just behind the edge
    recording = tiswarm.Recording.from_tracks(tracks, size=(10, 10), boundary="periodic")
    np.testing.assert_allclose(recording.prey.velocity[:, 0], np.tile([1.0, 0.0], (8, 1)))
    np.testing.assert_allclose(recording.prey.position[:, 0, 0], (8.0 + frames) % 10)


def test_without_a_size_the_world_is_as_large_as_the_tracks(tracks):
    tracks["x"] -= 100
    recording = tiswarm.Recording.from_tracks(tracks)
    lows = np.nanmin(recording.prey.position, axis=(0, 1))
    np.testing.assert_allclose(lows, 0, atol=1e-12)
    np.testing.assert_allclose(recording.scenario.world.size, np.nanmax(recording.prey.position, axis=(0, 1)))


def test_latecomers_enter_a_film_as_they_move(tracks):
    recording = tiswarm.Recording.from_tracks(tracks, size=(10, 10))
    paths = Trajectories([recording], behind=4)
    there = []
    for time in (1.5, 2.5, 3.0, 6.5, 7.5):
        paths.reach(time)
        there.append(bool(time < paths.end[1]))
    assert there == [False, True, True, True, False]
    np.testing.assert_allclose(paths.spots(2.5)[1], [4.0, 0.25 * 12.5])  # back in time, and before it came
    images = list(render.frames(recording, size=(160, 160), fps=10, speed=10, trail=3))
    assert len(images) > 5
    with pytest.raises(ValueError, match="comes after the start"):
        render.replay(recording, "page.html")


def test_a_recording_of_tracks_is_saved_loaded_and_measured(tracks, tmp_path):
    recording = tiswarm.Recording.from_tracks(tracks, size=(10, 10))
    again = tiswarm.Recording.load(recording.save(tmp_path / "tracks.npz"))
    np.testing.assert_array_equal(again.prey.position, recording.prey.position)
    assert polarisation(again).shape == (10,)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda t: t.drop(columns="x"), "no column x"),
        (lambda t: t.drop(columns=["frame", "particle"]), "no column frame, particle"),
        (lambda t: t.assign(y=np.nan), "missing or infinite"),
        (lambda t: t.assign(frame=t["frame"] + 0.5), "whole numbers"),
        (lambda t: t.assign(x="far"), "must hold numbers alone"),
        (lambda t: t.assign(kind="bird"), "kind 'bird' is unknown"),
        (lambda t: t.assign(kind="predators"), "all are predators"),
        (lambda t: t.assign(kind=["prey", *["predators"] * (len(t) - 1)]), "one kind"),
        (lambda t: pd.concat([t, t]), "one frame twice"),
        (lambda t: t.iloc[:0], "no rows"),
        (lambda t: t.assign(particle=np.arange(len(t)), frame=10_000_000 * np.arange(len(t))), "too many"),
    ],
)
def test_what_is_no_table_of_tracks_gets_one_line(tracks, change, told):
    with pytest.raises(ValueError, match=told) as caught:
        tiswarm.Recording.from_tracks(change(tracks))
    assert "\n" not in str(caught.value)


def test_a_periodic_world_needs_its_size(tracks):
    with pytest.raises(ValueError, match="say how large"):
        tiswarm.Recording.from_tracks(tracks, boundary="periodic")
