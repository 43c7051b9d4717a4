"""What is written on the stage: the scale tells the truth in a round length, and stays inside."""

import numpy as np
import pytest

import render
from render.composition import Composition
from render.language import language_named
from render.raster.glyphs import Atlas
from render.raster.shapes import KIND, PLACE, SPRITE
from render.scene.camera import Camera
from render.scene.lettering import rounded, scale_bar
from render.style import Look

pytestmark = pytest.mark.quick

DARK, ENGLISH = render.THEMES["dark"], language_named("en")


@pytest.mark.parametrize(("most", "bar"), [(1, 1), (1.99, 1), (2, 2), (49, 20), (50, 50), (0.3, 0.2), (0.05, 0.05), (7e3, 5e3)])
def test_bars_are_of_round_lengths(most, bar):
    assert rounded(most) == pytest.approx(bar)


@pytest.mark.parametrize(("metres", "words"), [(1, "1 m"), (0.5, "0.5 m"), (0.05, "5 cm"), (200, "200 m"), (5000, "5 km")])
def test_lengths_have_units(metres, words):
    assert ENGLISH.length(metres) == words


@pytest.mark.parametrize("scale", [0.013, 3.7, 60.0, 900.0])
def test_a_scale_bar_is_as_long_as_it_says_and_inside(scale):
    edges = np.array([100.0, 0.0, 900.0, 500.0])
    rows = scale_bar(edges, DARK, Atlas(), 1.0, Camera(np.zeros(2), np.array([500.0, 250.0]), scale), ENGLISH)
    lines = rows[rows[:, KIND] != SPRITE][:, PLACE : PLACE + 4]
    long = np.hypot(*(lines[1, 2:] - lines[1, :2]))
    assert long / scale == pytest.approx(rounded(0.18 * 800 / scale), rel=1e-5)
    assert (lines[:, ::2] > 100).all()
    assert (lines[:, ::2] < 900).all()
    assert (lines[:, 1::2] < 500).all()


def test_every_film_with_room_for_words_has_a_scale(chase):
    for subject, size, there in ((chase, (640, 360), True), ([chase, chase], (640, 360), True), (chase, (240, 136), False)):
        stage = Composition(subject, size, Look(), yuv=False)
        letters = stage._lettered(0.0)
        assert bool((letters[:, KIND] != SPRITE).any()) == there
