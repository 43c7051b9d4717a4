"""Schools that leave an open space for good: the camera that goes with them, and what shows that it moves."""

from dataclasses import replace

import numpy as np
import pytest
from handmade import path, picture, world

from render.composition import Composition
from render.scene.camera import Orbit
from render.scene.depths import depths
from render.style import Look
from tiswarm.records.recording import Recording


def school(apart: float = 1.0) -> Recording:
    """Let twenty fish swim out of an open world of 40 m x 20 m x 12 m for good, upwards, too."""
    offsets = np.random.default_rng(2).uniform(-apart, apart, (20, 3))
    way = np.array([20.0, 10.0, 6.0]) + np.arange(60.0)[:, None] * (3.0, 1.0, 2.0)
    return world(path(way[:, None] + offsets, np.array([3.0, 1.0, 2.0])))


@pytest.mark.parametrize("size", [(400, 240), (240, 240), (180, 320)])
def test_a_camera_goes_with_a_school_that_leaves_an_open_space_for_good(size):
    stage = Composition(school(), size, Look(), yuv=False)
    edges = stage.boxes[0]
    for time in (0.0, 13.0, 30.5, 59.0):
        spots = stage.rigs[0].at(time).place(stage.scene.paths.spots(time))
        inside = (spots > (edges.left, edges.top)) & (spots < (edges.right, edges.bottom))
        assert inside.all(axis=1).mean() > 0.9, "most are seen"
        assert np.ptp(spots, axis=0).max() > 0.3 * min(edges.width, edges.height), "and not from afar"
    still = world(path(np.full((9, 20, 3), 6.0), np.zeros(3)), **{"target.present": True})
    assert (Composition(still, size, Look(), yuv=False).rigs[0].at(0.0).centre == (20, 10, 6)).all()


def test_motes_stand_still_in_a_space_without_ground():
    stage, image = picture(school(), 20.0)
    camera = stage.rigs[0].at(20.0)
    assert isinstance(camera, Orbit)
    window = np.array([150.0, 0.0, 400.0, 240.0])
    there = depths(stage.scene.theme, 1.0, camera, window)
    further = depths(stage.scene.theme, 1.0, replace(camera, centre=camera.centre + 0.1), window)
    assert len(there) > 50
    assert 0 < len(further) - 0.5 * len(there) < len(there), "most are the same ones, seen from elsewhere"
    moved = picture(school(), 20.5)[1]
    assert (np.abs(image - moved).max(axis=2) > 8).any()


def test_several_schools_are_each_followed_at_one_scale():
    other = school(apart=3.0)
    stage = Composition([school(), other], (480, 240), Look(), yuv=False)
    cameras = [held.at(40.0) for held in stage.rigs]
    assert cameras[0].scale == cameras[1].scale
    joint = stage._camera(40.0)
    spots = joint.place(stage.scene.paths.spots(40.0))
    for n, edges in enumerate(stage.boxes):
        mine = spots[stage.scene.paths.scene == n]
        assert edges.left < mine[:, 0].mean() < edges.right
        assert edges.top < mine[:, 1].mean() < edges.bottom
    assert len(np.unique(stage.frame(40.0, stage.canvas.blank()))) > 30
