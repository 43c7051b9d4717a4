"""Charts show what was measured, as far as the film has come, where there is room."""

import dataclasses

import numpy as np
import pytest

import tiswarm
from render.captions.chart import rounded_up
from render.composition import Composition
from render.raster.shapes import PLACE
from render.style import Look

SQUARE, WIDE = (720, 720), (1280, 720)


@pytest.fixture
def pair(make):
    """Two swallows in a square: a preset that is about a distance, and leaves room beside it."""
    recording = make(prey=2, predators=0, ticks=40)
    return dataclasses.replace(
        recording, scenario=tiswarm.load("m20/two-swallows"), obstacle_position=np.zeros((0, 2)), obstacle_radius=np.zeros(0)
    )


def charts(subject, size, **look):
    return Composition(subject, size, Look(**look), yuv=False).caption._charts


@pytest.mark.quick
@pytest.mark.parametrize(
    ("value", "top"), [(0.0, 1.0), (0.7, 0.8), (1.0, 1.0), (1.2, 1.5), (37, 40), (83, 100), (0.012, 0.015)]
)
def test_axes_end_at_round_numbers(value, top):
    assert rounded_up(value) == pytest.approx(top)


def test_a_preset_charts_what_it_is_about_where_there_is_room(pair):
    assert [each.name for each in charts(pair, WIDE)._lines] == ["distance", "polarisation"]
    assert charts(pair, WIDE, chart=())._lines == []
    assert [each.name for each in charts(pair, WIDE, chart=("speed",))._lines] == ["speed"]


def test_charts_that_are_asked_for_get_room(chase):
    assert charts(chase, SQUARE, chart=("alive", "polarisation"))._lines
    with pytest.raises(ValueError, match=r"chart: unknown 'beauty'; use any of alive"):
        Look(chart=("beauty",))


def test_a_line_grows_with_time_and_ends_where_the_film_is(pair):
    shown = charts(pair, WIDE)
    plot, drawn = shown._plots[0], [shown.frame(time) for time in (0.0, 20.0, 40.0)]
    lengths = [sum(len(rows) for rows in each) for each in drawn]
    assert lengths[0] < lengths[1] < lengths[2]
    for time, rows in zip((0.0, 20.0, 40.0), drawn, strict=True):
        assert rows[2][0, PLACE] == pytest.approx(plot.left + plot.width * time / 40)  # the dot at the line's end


def test_ends_of_prey_are_marked_on_the_axis(chase):
    shown = charts(chase, SQUARE, chart=("alive",))
    assert [len(shown.frame(time)[0]) for time in (2.0, 3.5, 4.5, 8.0)] == [0, 1, 2, 3]
