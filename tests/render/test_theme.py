"""Every theme can be read: by those who see fewer colours, on every ground, in small type."""

from itertools import combinations

import numpy as np
import pytest
from colour_vision import DEUTERANOPIA, contrast, difference, over, seen_apart

import render
from render.raster.shapes import colour
from render.scene.events import MARKED
from render.scene.signs import sign_paint
from tiswarm.records.recording import FATES

pytestmark = pytest.mark.quick
themes = pytest.mark.parametrize("theme", render.THEMES.values(), ids=render.THEMES.keys())

DIED = (FATES.index("captured"), FATES.index("crashed"))


def test_differences_are_those_of_the_published_pairs():
    """Sharma, Wu and Dalal 2005, table 1, pairs 1, 7, 19, 25 and 34."""
    for one, other, apart in (
        ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
        ((50.0, 0.0, 0.0), (50.0, -1.0, 2.0), 2.3669),
        ((50.0, 2.5, 0.0), (61.0, -5.0, 29.0), 22.8977),
        ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
        ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
    ):
        assert difference(np.array(one), np.array(other)) == pytest.approx(apart, abs=1e-4)


@themes
def test_fates_are_told_apart_without_green_cones(theme):
    paints = {"alive": theme.prey[0], "arrived": theme.arrived, "captured": theme.captured, "crashed": theme.crashed}
    for one, other in combinations(paints, 2):
        assert seen_apart(paints[one], paints[other], DEUTERANOPIA) >= 20, (one, other)


@themes
def test_words_stand_off_their_ground(theme):
    for words in ("ink", "quiet"):
        assert contrast(theme[words], theme["backdrop"]) >= 4.5, words
    for hue in ("danger", "safe", "line"):
        for ground in theme.grounds:
            assert contrast(theme.label(hue), over(theme[hue], theme.tint_alpha, ground)) >= 4.5, hue


@themes
def test_marks_stand_off_their_ground(theme):
    for ground in theme.grounds:
        for code in (*theme.prey, theme.predator, theme.target, theme.arrived):
            assert contrast(colour(code), ground) >= 3, code
        for fate in DIED:
            assert contrast(over(sign_paint(fate, theme), MARKED, ground), ground) >= 3, FATES[fate]
    for ground in theme.grounds[:2]:  # obstacles stand on a floor, never in the sky
        assert contrast(theme["obstacle_edge"], ground) >= 3


@themes
def test_marks_of_captions_stand_off_the_backdrop(theme):
    for fate in range(len(FATES)):
        assert contrast(sign_paint(fate, theme), theme["backdrop"]) >= 3
