"""The disc: a world whose circle, or sphere, reflects whoever comes to it."""

import numpy as np
import pytest

import render
import tiswarm
from tiswarm.measures import ground
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import validated

ALONE = {"cohesion": 0.0, "separation": 0.0, "alignment": 0.0, "goal": 0.0}


def scenario(dim=2, side=20.0, **changes):
    middle = [side / 2] * dim
    spawn = {"region": [[side / 4] * dim, [side * 3 / 4] * dim], "shape": "ball", "velocity": [[-1.0] * dim, [1.0] * dim]}
    world = {"size": [side] * dim, "boundary": "disc", "contact": "none", "ticks": 400}
    prey = {"count": 24, "spawn": spawn, "max_speed": 2.0, "perception": 4.0, **ALONE}
    return validated({"world": world, "target": {"present": False, "position": middle}, "prey": prey}).replaced(changes)


def far(path, side=20.0):
    """Give how far from the middle of the world prey are: [tick, agent], m."""
    return np.linalg.norm(path.prey.position - side / 2, axis=-1)


@pytest.mark.parametrize("neighbours", ["all-pairs", "grid"])
@pytest.mark.parametrize("dim", [2, 3])
def test_nobody_is_outside_and_no_speed_is_lost(dim, neighbours, f64):
    path = tiswarm.record(scenario(dim, **{"world.neighbours": neighbours, "world.ticks": 3000}))
    assert far(path).max() <= 10.0 + 1e-9
    assert (np.diff(np.sign(np.diff(far(path), axis=0)), axis=0) < 0).sum() > 1000  # so often somebody turned inward
    speed = np.linalg.norm(path.prey.velocity, axis=-1)
    np.testing.assert_allclose(speed, np.broadcast_to(speed[0], speed.shape), rtol=1e-9)


def test_the_place_is_mirrored_and_the_velocity_with_it(f64):
    """From 9.5 m at 1 m/s outward one would be at 10.5 m: it is at 9.5 m again, on its way in."""
    none = np.zeros((0, 2))
    start = tiswarm.Start([[19.5, 10.0], [10.0, 0.2]], [[1.0, 0.0], [0.3, -0.6]], none, none, none, [])
    path = tiswarm.record(scenario(), start=start).prey
    np.testing.assert_allclose(path.position[1, 0], [19.5, 10.0])
    np.testing.assert_allclose(path.velocity[1, 0], [-1.0, 0.0], atol=1e-12)
    off = np.array([0.3, -10.4])
    distance, line = np.linalg.norm(off), off / np.linalg.norm(off)
    np.testing.assert_allclose(path.position[1, 1], 10 + (20 - distance) * line)
    np.testing.assert_allclose(path.velocity[1, 1], [0.3, -0.6] - 2 * (np.array([0.3, -0.6]) @ line) * line)


def test_a_step_across_the_whole_world_ends_inside(f32):
    path = tiswarm.record(scenario(**{"prey.max_speed": 1000.0, "prey.spawn.velocity": [[-900, -900], [900, 900]]}))
    assert far(path)[1:].max() <= 10.0 * (1 + 1e-6)


@pytest.mark.parametrize("drive", ["point", "unicycle"])
def test_a_turned_world_gives_the_turned_path(drive, f64):
    flock = {"prey.cohesion": 0.01, "prey.separation": 0.05, "prey.alignment": 0.02, "world.ticks": 150}
    flock |= {"prey.drive": drive, "prey.ahead": 1.5}  # an axle nearer to its point than a tick's way overshoots every turn
    rng, none = np.random.default_rng(4), np.zeros((0, 2))
    place, speed = rng.uniform(-6, 6, (8, 2)), rng.uniform(-1.2, 1.2, (8, 2))
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    own = scenario(**flock, **{"prey.strategy": "sweeper"})
    paths = [
        tiswarm.record(own, start=tiswarm.Start(place @ r.T + 10, speed @ r.T, none, none, none, [])) for r in (np.eye(2), turn)
    ]
    np.testing.assert_allclose((paths[0].prey.position - 10) @ turn.T + 10, paths[1].prey.position, atol=1e-6)
    assert far(paths[0]).max() > 9.5  # the circle mattered


@pytest.mark.parametrize("dim", [2, 3])
def test_both_engines_reflect_alike(dim, f64):
    """Differences in the last digit grow by a third a tick, so that 30 ticks leave a hundred-thousandth of a micrometre."""
    flock = {"prey.cohesion": 0.005, "prey.separation": 0.05, "prey.alignment": 0.01, "world.ticks": 30}
    own = scenario(dim, **flock, **{"prey.spawn.velocity": [[-2.0] * dim, [2.0] * dim]})
    one, other = (tiswarm.record(own.replaced({"world.neighbours": way}), seed=2) for way in ("all-pairs", "grid"))
    np.testing.assert_allclose(one.prey.position, other.prey.position, atol=1e-11)
    assert (far(one)[1:-1] > np.maximum(far(one)[:-2], far(one)[2:])).sum() > 20  # turned back at the edge, or near it


def test_only_ground_inside_the_circle_counts(f64):
    keys = {"coverage.cell": 0.5, "coverage.tool": 30.0, "measures.names": ["coverage"], "world.ticks": 3}
    own = scenario(**keys)
    swept = ground.ground(tiswarm.record(own))
    assert (swept.visits >= 0).sum() * 0.25 == pytest.approx(np.pi * 100, rel=0.02)
    assert tiswarm.simulate(own, 1).measures["coverage"][0] == 1.0


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"prey.spawn.shape": "box", "prey.spawn.region": [[1, 1], [19, 19]]}, "prey.spawn.region: reaches out of the disc"),
        ({"prey.spawn.region": [[0, 0], [20, 21]]}, "prey.spawn.region: reaches out of the disc"),
        ({"target.present": True, "target.position": [1, 1]}, "target.position: .* is outside the disc"),
        ({"world.margin": 1.0}, "only with boundary = 'walls'"),
    ],
)
def test_what_lies_outside_is_refused(changes, told):
    with pytest.raises(ScenarioError, match=told):
        scenario(**changes)
    assert scenario(**{"prey.spawn.region": [[0, 0], [20, 20]]}).world.boundary == "disc"


@pytest.mark.parametrize("dim", [2, 3])
def test_a_recording_and_a_film_of_it(dim, tmp_path, f32):
    recording = tiswarm.record(scenario(dim, **{"world.ticks": 8}))
    again = tiswarm.Recording.load(recording.save(tmp_path / "disc.npz"))
    assert again.scenario.world.boundary == "disc"
    assert render.poster(again, tmp_path / "disc.png", size=(320, 200)).exists()
