"""A moment as vectors: shapes where the film has them, words that can be read, the same bytes every time."""

import re
import unicodedata

import numpy as np
import pytest
from handmade import path, world
from matplotlib.path import Path

import render
import tiswarm
from render.composition import Composition
from render.drawing.manuscript import Line, Manuscript
from render.drawing.outlines import outlined
from render.drawing.page import Page, _pieces
from render.raster.shapes import boxes, capsules, darts, discs
from render.style import Look


@pytest.fixture(scope="module")
def recording():
    tiswarm.init("f32")
    return tiswarm.record("delft/pronav-10", seed=2)


@pytest.fixture(scope="module")
def drawn(recording, tmp_path_factory):
    return render.moment(recording, tmp_path_factory.mktemp("moment") / "a.svg", 30.0)


def _words(svg):
    return re.findall(r"<text[^>]*>([^<]*)</text>", svg.read_text(encoding="utf-8"))


def test_words_are_text(drawn, recording):
    said = " ".join(_words(drawn))
    for word in ("predators through ten obstacles", "30.0", "20 m", "captured", "DANGER AREA"):
        assert word in said
    assert "<image" not in drawn.read_text(encoding="utf-8")


def test_the_same_moment_has_the_same_bytes(drawn, recording, tmp_path):
    assert render.moment(recording, tmp_path / "b.svg", 30.0).read_bytes() == drawn.read_bytes()
    one, other = (render.moment(recording, tmp_path / name, 30.0).read_bytes() for name in ("c.pdf", "d.pdf"))
    assert one == other
    assert one.startswith(b"%PDF")


def test_agents_are_where_the_film_has_them(tmp_path):
    """Of a prey that stands 20 m further east, what differs on the page has moved as far as on the film's frame."""
    one, other = (world(path(np.full((3, 1, 2), (x, 5.0)), np.array([1.0, 0.0]))) for x in (10.0, 30.0))
    pages = [render.moment(each, tmp_path / "lone.svg", 1.0, (800, 450)).read_text(encoding="utf-8") for each in (one, other)]
    svg = pages[0]
    ones, others = (set(re.findall(r'<path d="([^"]*)"', page)) for page in pages)
    middles = [
        np.mean([np.array(re.findall(r"-?\d+\.?\d*", each), float).reshape(-1, 2).mean(axis=0) for each in some], axis=0)
        for some in (ones - others, others - ones)
    ]
    width = float(re.search(r'viewBox="0 0 ([\d.]+)', svg).group(1))
    stage = Composition(one, (800, 450), Look(theme="print"), yuv=False)
    assert middles[1] - middles[0] == pytest.approx((20 * stage.rigs[0].at(1.0).scale * width / 800, 0.0), abs=0.5)


@pytest.mark.parametrize(
    ("rows", "low", "high"),
    [
        (discs(np.array([[50.0, 40.0]]), 10.0, (1, 0, 0)), (40, 30), (60, 50)),
        (capsules(np.array([[50.0, 40.0]]), np.array([[90.0, 40.0]]), 10.0, 4.0, (1, 0, 0)), (40, 30), (94, 50)),
        (darts(np.array([[50.0, 40.0]]), np.array([[1.0, 0.0]]), 20.0, 8.0, 10.0, (1, 0, 0)), (30, 32), (70, 48)),
        (boxes((10, 20), (30, 60), (1, 0, 0), 1.0, corner=3), (10, 20), (30, 60)),
    ],
    ids=["disc", "capsule", "dart", "box"],
)
def test_an_outline_reaches_as_far_as_its_shape(rows, low, high):
    (mark,) = outlined(rows, np.ones(3))
    around = Path(mark.points, mark.codes).get_extents()
    assert around.min == pytest.approx(low, abs=0.15)
    assert around.max == pytest.approx(high, abs=0.15)
    assert mark.alpha == pytest.approx(1.0)
    assert mark.paint == pytest.approx((1, 0, 0))


@pytest.mark.parametrize("count", [1, 2])
def test_a_page_has_no_line_that_fills_with_time(recording, tmp_path, monkeypatch, count):
    subject, drawn = recording if count == 1 else [recording, recording], []
    monkeypatch.setattr(Page, "draw", lambda page, rows, *_: drawn.append(rows))
    render.moment(subject, tmp_path / "a.svg", 30.0, (800, 450))
    film = Composition(subject, (800, 450), Look(theme="print"), yuv=False, atlas=Manuscript())
    assert len(film.shapes(30.0)) == len(drawn[0]) + 2  # what fills, and its track


def test_what_is_no_moment_gets_one_line(recording, tmp_path, command):
    last = recording.ticks
    with pytest.raises(ValueError, match=rf"^time: 4000 is outside the trial; use 0 to {last}$"):
        render.moment(recording, tmp_path / "a.pdf", 4000)
    with pytest.raises(ValueError, match=r"unknown format '\.png'; use \.pdf or \.svg$"):
        render.moment(recording, tmp_path / "a.png", 3)
    assert not list(tmp_path.iterdir())
    done = command("film", "delft/pronav-10", "--moment", "20", "a.svg", "--quiet", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert [each.name for each in tmp_path.iterdir()] == ["a.svg"]
    refused = command("film", "delft/pronav-10", "--moment", "20", "a.gif", cwd=tmp_path)
    assert refused.returncode == 2
    assert refused.stderr.count("\n") == 1


def test_marks_stand_on_their_letters():
    """Found by looking: a mark that is drawn by itself comes with a dotted ring."""
    pieces = [words for _, words, _ in _pieces(Line("مفترسًا", 20, "left"))]
    assert sum("ً" in words for words in pieces) == 1
    assert all(unicodedata.category(words[0]) != "Mn" for words in pieces)
