from dataclasses import replace

import numpy as np
import pytest

from render.scene.trajectories import Trajectories
from render.timeline import HOLD, times
from tiswarm.records.recording import Recording


def along(paths: Trajectories, times) -> np.ndarray:
    """Give places at several times: [time, agent, dim]."""
    return np.stack([paths.spots(time) for time in times])


def test_paths_go_through_the_recorded_positions(chase):
    paths = Trajectories([chase])
    both = np.concatenate([chase.prey.position, chase.predators.position], axis=1)
    there = np.isfinite(both)
    assert np.allclose(along(paths, np.arange(9.0))[there], both[there])


def test_paths_and_their_speeds_are_continuous(chase):
    paths = Trajectories([chase])
    everybody = np.arange(paths.count)
    for tick in range(1, 8):
        (before, slow), (after, fast) = (
            (paths.spots(time), paths.speeds(time, everybody)) for time in (tick - 1e-7, tick + 1e-7)
        )
        alive = paths.end > tick
        assert np.allclose(before[alive], after[alive], atol=1e-5)
        assert np.allclose(slow[alive], fast[alive], atol=1e-5)


def test_the_speed_is_the_slope_of_the_path(chase):
    paths = Trajectories([chase])
    everybody = np.arange(paths.count)
    moment, step = np.arange(0.3, 2.9, 0.37), 1e-6
    rise = (along(paths, moment + step) - along(paths, moment - step)) / (2 * step)
    assert np.allclose(rise, [paths.speeds(time, everybody) for time in moment], atol=1e-5)


def test_whoever_is_gone_stays_where_it_went(chase):
    paths = Trajectories([chase])
    spots = along(paths, [3.0, 5.0, 8.0, 99.0])[:, 0]
    assert np.isfinite(spots).all()
    assert np.allclose(spots, spots[0])


def test_captor_and_captive_meet(make):
    recording = make(prey_ends={0: (3, "captured")}, predator_ends={2: (3, "captured")})
    spots = Trajectories([recording]).spots(3.0)
    assert np.linalg.norm(spots[0] - spots[6 + 2]) > 5, "they died far from each other"
    beside, along = recording.predators.position.copy(), recording.predators.velocity.copy()
    beside[:, 2], along[:, 2] = recording.prey.position[:, 0] + (1.0, 0.5), recording.prey.velocity[:, 0]
    predators = replace(recording.predators, position=beside, velocity=along)
    spots = Trajectories([replace(recording, predators=predators)]).spots(3.0)
    assert np.allclose(spots[0], spots[6 + 2])


def test_a_periodic_world_is_crossed_at_its_edge_not_through_its_middle(make):
    recording = make(prey=1, predators=0, ticks=4)
    position = np.array([[[98.0, 25]], [[99.5, 25]], [[1.0, 25]], [[2.5, 25]], [[4.0, 25]]])
    prey = replace(recording.prey, position=position, velocity=np.full_like(position, (1.5, 0.0)))
    world = recording.scenario.world.model_copy(update={"boundary": "periodic"})
    scenario = recording.scenario.model_copy(update={"world": world})
    paths = Trajectories([Recording(scenario, 0, 0, prey, recording.predators, np.zeros((0, 2)), np.zeros(0))])
    x = along(paths, np.linspace(0, 4, 41))[:, 0, 0]
    assert np.allclose(np.mod(x - x[0], 100), np.linspace(0, 6, 41))


def test_films_last_as_long_as_their_speed_says(make):
    paths = Trajectories([make(ticks=20)])
    moments = list(times(paths, 10, 30))
    assert len(moments) == 2 * 30 + HOLD * 30
    assert np.allclose(np.diff(moments), 10 / 30)


def test_slow_motion_lasts_longer_and_reaches_the_same_end(make):
    paths = Trajectories([make(ticks=60, prey_ends={0: (30, "captured")})])
    fast, slow = (np.array(list(times(paths, 10, 60, slow=slow))) for slow in (False, True))
    assert len(slow) > len(fast) * 1.1
    assert (np.diff(slow) > 0).all()
    at_capture = np.abs(slow - 30).argmin()
    assert np.diff(slow)[at_capture] == pytest.approx(0.25 * 10 / 60, rel=0.05)
    assert np.diff(slow)[0] == pytest.approx(10 / 60, rel=0.05)


def test_no_frames_per_second_is_refused(chase):
    with pytest.raises(ValueError, match="fps"):
        times(Trajectories([chase]), 10, 0)
