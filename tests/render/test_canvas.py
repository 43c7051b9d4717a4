import numpy as np
import pytest
from taichi.lang import impl

from render.raster import shapes
from render.raster.canvas import Canvas
from render.raster.glyphs import Atlas
from render.raster.tiles import entries_from

OFFSETS = [(0.0, 0.0), (0.25, 0.6), (0.5, 0.5), (0.77, 0.31)]
WHITE = (1.0, 1.0, 1.0)


@pytest.fixture(scope="module")
def canvas() -> Canvas:
    return Canvas((200, 120), Atlas(), yuv=False)


def light(canvas: Canvas, rows: np.ndarray) -> np.ndarray:
    """Draw on black and give the light that arrives: [y, x]."""
    canvas.lay((0.0, 0.0, 0.0), rows)
    return canvas.light()[..., 0].astype(float)


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("radius", [2.5, 5.0, 17.3, 40.0])
def test_a_disc_covers_its_area(canvas, radius, offset):
    area = light(canvas, shapes.discs([np.add((60, 60), offset)], radius, WHITE)).sum()
    assert area == pytest.approx(np.pi * radius**2, rel=0.01)


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("radius", [0.3, 0.5, 1.5, 4.0])
def test_a_trail_is_as_long_and_wide_as_its_line(canvas, radius, offset):
    angle = np.linspace(0, 1.2, 9)[:, None]
    line = np.concatenate([20 + 130 * np.sin(angle), 110 - 130 * (1 - np.cos(angle))], axis=1) + offset
    drawn = light(canvas, shapes.capsules(line[:-1], line[1:], radius, radius, WHITE, group=1)).sum()
    length = np.hypot(*np.diff(line, axis=0).T).sum()
    caps = np.pi * radius**2 if radius >= 0.5 else np.pi * radius * 0.5
    assert (drawn - caps) / (2 * radius) == pytest.approx(length, rel=0.01)


def test_joined_capsules_have_no_beads(canvas):
    line = np.array([[20.0, 60], [60, 60], [100, 60], [140, 60]])
    picture = light(canvas, shapes.capsules(line[:-1], line[1:], 3, 3, WHITE, 0.5, group=1))
    assert np.allclose(picture[60, 30:130], 0.5, atol=1e-6)


def test_trails_of_different_agents_are_blended_apart(canvas):
    across = shapes.capsules([[20.0, 60]], [[140.0, 60]], 3, 3, WHITE, 0.5, group=1)
    along = shapes.capsules([[80.0, 10]], [[80.0, 110]], 3, 3, WHITE, 0.5, group=2)
    assert light(canvas, np.concatenate([across, along]))[60, 80] == pytest.approx(0.75, abs=1e-6)


def test_what_is_hidden_leaves_no_trace(canvas):
    rng = np.random.default_rng(3)
    below = shapes.discs(rng.uniform((0, 0), (200, 120), (400, 2)), 9, WHITE, 0.7)
    lid = shapes.boxes((16, 16), (144, 96), (0.1, 0.2, 0.3))
    over = shapes.discs(rng.uniform((30, 30), (130, 80), (12, 2)), 5, WHITE, 0.5)
    whole, upper = (light(canvas, np.concatenate(rows))[16:96, 16:144] for rows in ([below, lid, over], [lid, over]))
    assert (whole == upper).all()


def test_one_thread_draws_what_all_draw(canvas):
    rows = shapes.discs(np.random.default_rng(4).uniform((0, 0), (200, 120), (300, 2)), 7, WHITE, 0.4)
    canvas.lay((0.1, 0.2, 0.3), shapes.NONE)
    plates = canvas.blank(), canvas.blank()
    plates[1].calm = True
    one, other = (canvas.draw(rows, None, plate) for plate in plates)
    assert (one == other).all()


@pytest.mark.parametrize("offset", OFFSETS)
def test_a_dart_covers_its_polygon(canvas, offset):
    length, width, notch = 30.0, 20.0, 25.0
    turn = np.array([np.cos(0.4), np.sin(0.4)])
    area = light(canvas, shapes.darts([np.add((80, 60), offset)], turn, length, width, notch, WHITE)).sum()
    assert area == pytest.approx(width * (2 * length - notch), rel=0.01)


def test_a_dart_points_along_its_heading(canvas):
    picture = light(canvas, shapes.darts([[80.0, 60]], [[0.0, 1.0]], 20, 12, 10, WHITE))
    rows = np.flatnonzero(picture.sum(axis=1) > 0.5)
    assert picture[rows[0] + 4].sum() > picture[rows[-1] - 4].sum(), "the tip lies below, the wings above"


@pytest.mark.parametrize("offset", OFFSETS)
def test_a_box_and_its_outline_cover_their_areas(canvas, offset):
    low, high = np.add((30, 20), offset), np.add((110, 75), offset)
    assert light(canvas, shapes.boxes(low, high, WHITE)).sum() == pytest.approx(80 * 55, rel=0.01)
    outline = light(canvas, shapes.boxes(low, high, WHITE, stroke=1.0)).sum()
    assert outline == pytest.approx(2 * 2 * (80 + 55), rel=0.01)


def test_a_ring_covers_its_circumference(canvas):
    assert light(canvas, shapes.rings([[80.3, 60.6]], 40, 3, WHITE)).sum() == pytest.approx(2 * np.pi * 40 * 3, rel=0.01)


def test_shapes_outside_the_frame_and_broken_ones_draw_nothing(canvas):
    rows = shapes.discs(np.array([[-50.0, 10], [500, 60], [80, 900], [np.nan, 10], [80, np.inf]]), 5, WHITE)
    assert not light(canvas, rows).any()


def test_light_is_blended_linearly(canvas):
    grey = light(canvas, shapes.boxes((10, 10), (50, 50), WHITE, 0.5))
    assert grey[30, 30] == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize(
    "code", ["#000000", "#ffffff", "#56b4e9", "#d55e00", "#0a0e15", "#808080", "#ff0000", "#00ff00", "#0000ff"]
)
def test_colours_survive_the_way_through_yuv(code):
    canvas = Canvas((64, 48), Atlas(), yuv=True)
    canvas.lay(shapes.colour(code), shapes.NONE)
    flat = canvas.draw(shapes.NONE, None, canvas.blank()).astype(float)
    luma = flat[: 64 * 48].mean()
    blue, red = flat[64 * 48 : 64 * 60].mean() - 128, flat[64 * 60 :].mean() - 128
    y, b, r = (luma - 16) / 219, blue / 224 * 1.8556, red / 224 * 1.5748
    back = np.array([y + r, y - (0.2126 * r + 0.0722 * b) / 0.7152, y + b]) * 255
    wanted = [int(code[n : n + 2], 16) for n in (1, 3, 5)]
    assert np.abs(back - wanted).max() <= 2


def test_colours_survive_the_way_through_rgb(canvas):
    levels = np.arange(0, 256, 5)
    for level in levels:
        canvas.lay(shapes.colour(f"#{level:02x}{255 - level:02x}40"), shapes.NONE)
        mean = canvas.draw(shapes.NONE, None, canvas.blank()).reshape(-1, 3).mean(axis=0)
        assert np.abs(mean - (level, 255 - level, 0x40)).max() <= 0.6


def test_a_frame_is_the_ground_and_its_shapes_and_nothing_of_the_frame_before(canvas):
    canvas.lay(shapes.colour("#203040"), shapes.discs([[60.0, 60]], 30, WHITE, 0.3))
    empty = canvas.draw(shapes.NONE, None, canvas.blank())
    canvas.draw(shapes.discs([[90.0, 60]], 20, WHITE), None, canvas.blank())
    assert (canvas.draw(shapes.NONE, None, canvas.blank()) == empty).all()


def test_text_has_the_ink_of_its_letters(canvas):
    atlas = Atlas()
    canvas = Canvas((200, 120), atlas, yuv=False)
    picture = light(canvas, atlas.line("Hi", (40, 80), 40, WHITE))
    assert picture.max() == pytest.approx(1, abs=0.01)
    rows, columns = picture.any(axis=1).nonzero()[0], picture.any(axis=0).nonzero()[0]
    assert 75 <= rows[-1] <= 80
    assert 40 <= columns[0] <= 46


def test_room_is_reckoned_while_another_thread_builds_a_kernel(canvas, monkeypatch):
    """The feeder of an encoder builds one for frames with opacity; Taichi notes it for all threads."""
    monkeypatch.setattr(impl.get_runtime(), "inside_kernel", True)
    assert isinstance(entries_from(3), int)
