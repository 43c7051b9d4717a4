"""Charts show what was measured, as far as the film has come, where there is room."""

import dataclasses

import numpy as np
import pytest

import tiswarm
from render.captions.among import Among
from render.composition import Composition
from render.raster.shapes import BOX, KIND, PLACE, SIZE
from render.scene.lettering import rounded_up
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


@pytest.mark.parametrize("size", [SQUARE, WIDE])
def test_this_trial_is_marked_among_others(chase, size):
    counts = np.array([0, 1, 1, 1, 2, 2, 6])
    shown = charts(chase, size, chart=(), among=Among("captured", counts)).among
    ground = np.concatenate(shown.ground())
    bars = ground[(ground[:, KIND] == BOX) & (ground[:, SIZE + 1] > 2)]
    heights = {round(float(x)): float(high) for x, high in zip(bars[:, PLACE], bars[:, SIZE + 1], strict=True)}
    assert list(heights) == [round(shown.place(count)) for count in (0, 1, 2, 6)], "a bar for each count that there was"
    assert heights[round(shown.place(1))] == pytest.approx(3 * heights[round(shown.place(0))])
    assert [shown.count(time) for time in (0.0, 8.0)] == [0, (chase.prey.fate == "captured").sum()]
    assert shown.frame(8.0)[0][0, PLACE] == pytest.approx(shown.place(shown.count(8.0)))


def test_others_that_find_no_room_are_refused(chase):
    with pytest.raises(ValueError, match="among: there is no room for it in this caption; choose another --size"):
        charts(chase, (400, 150), chart=(), among=Among("captured", np.array([0, 1, 2])))


def test_many_counts_share_a_bar(make):
    recording = make(prey=200, predators=1)
    shown = charts(recording, SQUARE, chart=("alive",), among=Among("crashed", np.arange(201))).among
    ground = np.concatenate(shown.ground())
    assert (ground[:, KIND] == BOX).sum() <= 42
    assert shown.place(0) < shown.place(199) <= shown._plot.right


@pytest.mark.quick
def test_others_must_be_there_and_their_fate_known():
    with pytest.raises(ValueError, match="use one of arrived, captured, crashed"):
        Among("alive", np.zeros(3))
    with pytest.raises(ValueError, match="give one or more"):
        Among("captured", np.zeros(0))
