"""Transparent pictures: without a ground, and over their theme's own colour as if they had been drawn there."""

import re
import subprocess

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

import render
from render.composition import Composition
from render.loop import _blended
from render.raster.canvas import Canvas
from render.raster.planar import planar
from render.raster.shapes import encoded
from render.scene import scene
from render.style import Look

SIZE = (160, 90)


def staged(recording, **look) -> Composition:
    return Composition(recording, SIZE, Look(transparent=True, **look), yuv=False)


def drawn(stage: Composition, time: float) -> np.ndarray:
    return stage.frame(time, stage.canvas.blank()).reshape(SIZE[1], SIZE[0], 4).astype(float)


def laid(picture: np.ndarray, under: np.ndarray | list[float]) -> np.ndarray:
    """Lay a picture over a colour as browsers do: encoded values are mixed."""
    share = picture[..., 3:] / 255
    return picture[..., :3] * share + np.asarray(under) * (1 - share)


def on_ground(stage: Composition, time: float) -> np.ndarray:
    """Draw the same shapes by a canvas over the theme's own colour."""
    backdrop = stage.look.colours["backdrop"]
    canvas = Canvas(SIZE, stage._atlas, yuv=False)
    canvas.lay(backdrop, stage.shapes(time), stage.windows)
    return 255 * encoded(np.clip(canvas.light(), 0, 1))


@pytest.mark.parametrize("theme", sorted(render.THEMES))
@pytest.mark.parametrize("camera", ["fit", "follow"])
def test_over_its_own_colour_it_is_what_a_canvas_draws_there(chase, theme, camera):
    stage = staged(chase, theme=theme, camera=camera, overlay=("perception", "links"))
    for time in (0.0, 4.6, 5.3):
        picture, true = drawn(stage, time), on_ground(stage, time)
        own = 255 * encoded(stage.look.colours["backdrop"])
        assert 0.05 < (picture[..., 3] > 0).mean() < 0.9
        assert np.abs(laid(picture, own) - true).max() < 1


def test_it_shows_what_is_behind(chase):
    picture = drawn(staged(chase, trail=0.0), 3.0)
    clear = picture[..., 3] == 0
    assert clear.mean() > 0.3
    assert (laid(picture, [255, 0, 255])[clear] == [255, 0, 255]).all()
    assert (picture[..., 3] == 255).any()


def test_a_cloud_is_as_opaque_as_it_is_crowded(make, monkeypatch):
    monkeypatch.setattr(scene, "CROWDED", 100)
    stage = staged(make(prey=400, predators=0, ticks=2))
    picture, true = drawn(stage, 1.0), on_ground(stage, 1.0)
    assert ((picture[..., 3] > 20) & (picture[..., 3] < 235)).sum() > 200
    assert np.abs(laid(picture, 255 * encoded(stage.look.colours["backdrop"])) - true).max() < 1


def test_a_frame_does_not_depend_on_those_before_it(chase):
    stage = staged(chase)
    plates = stage.canvas.blank(), stage.canvas.blank()
    for n, time in enumerate((0.0, 2.0, 5.5, 0.5, 0.6, 3.5)):
        stage.frame(time, plates[n % 2])
    assert (plates[1].bytes == drawn(staged(chase), 3.5).ravel()).all()


def test_what_shows_nothing_has_the_colour_of_what_is_near(chase):
    stage = staged(chase, trail=0.0)
    picture = drawn(stage, 3.0)
    opaque = np.argwhere(picture[..., 3] == 255)
    y, x = next((y, x) for y, x in opaque if 8 < x < 150 and (picture[max(y - 8, 0) : y + 9, x - 8 : x + 9, 3] == 0).any())
    around = picture[max(y - 8, 0) : y + 9, x - 8 : x + 9]
    hidden = around[around[..., 3] == 0]
    backdrop = np.round(255 * encoded(stage.look.colours["backdrop"]))
    assert (hidden[:, :3] != backdrop).any()


def test_faint_pixels_leave_no_rim_in_planes():
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[:] = (255, 90, 0, 2)
    pixels[0, 0] = (60, 70, 90, 255)
    alone = np.full((2, 2, 4), (60, 70, 90, 255), np.uint8)
    rim, plain = (planar(each.reshape(-1), (2, 2)).astype(int) for each in (pixels, alone))
    assert np.abs(rim[4:6] - plain[4:6]).max() <= 2  # chroma
    assert list(rim[6:]) == [255, 2, 2, 2]
    assert planar(np.full(16, 255, np.uint8), (2, 2)).tolist() == [235] * 4 + [128] * 2 + [255] * 4


def test_a_loop_fades_colours_by_how_much_there_is_of_them():
    red, nothing = np.array([200, 0, 0, 255], np.uint8), np.array([0, 0, 0, 0], np.uint8)
    assert np.abs(_blended(red, nothing, 0.5) - [200, 0, 0, 127.5]).max() <= 1
    assert (_blended(red, red, 0.3) == red).all()


def test_video_keeps_opacity(chase, tmp_path):
    made = render.film(chase, tmp_path / "a.webm", SIZE, 10, quality="best", transparent=True)
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-c:v", "libvpx-vp9", "-i", str(made.path)]
    raw = subprocess.run([*command, "-f", "rawvideo", "-pix_fmt", "yuva420p", "-"], capture_output=True, check=True).stdout
    planes = np.frombuffer(raw, np.uint8).reshape(made.frames, -1).astype(int)
    pixels = SIZE[0] * SIZE[1]
    for got, frame in zip(planes, render.frames(chase, SIZE, 10, transparent=True), strict=True):
        wanted = planar(frame.reshape(-1), SIZE).astype(int)
        assert np.abs(got[pixels * 3 // 2 :] - wanted[pixels * 3 // 2 :]).mean() < 2
        opaque = frame[..., 3].reshape(-1) > 250
        assert np.abs(got[:pixels] - wanted[:pixels])[opaque].mean() < 8


def test_images_keep_every_pixel(chase, tmp_path):
    made = render.film(chase, tmp_path / "frames", SIZE, 5, transparent=True)
    frames = list(render.frames(chase, SIZE, 5, transparent=True))
    files = sorted((tmp_path / "frames").iterdir())
    assert made.frames == len(frames) == len(files)
    for file, frame in zip(files, frames, strict=True):
        with Image.open(file) as image:
            assert image.mode == "RGBA"
            assert (np.asarray(image) == frame).all()
    still = render.still(chase, SIZE, time=3.0, transparent=True)
    with Image.open(render.poster(chase, tmp_path / "a.png", SIZE, time=3.0, transparent=True)) as image:
        assert (np.asarray(image) == still).all()
    with Image.open(render.sheet(chase, tmp_path / "s.webp", SIZE, shape=(2, 1), transparent=True)) as image:
        assert image.mode == "RGBA"
        assert image.getpixel((0, 0))[3] == 0


def test_animated_images_and_loops_keep_opacity(chase, tmp_path):
    render.film(chase, tmp_path / "a.webp", SIZE, 10, transparent=True, loop=True)
    with Image.open(tmp_path / "a.webp") as image:
        image.seek(3)
        alpha = np.asarray(image.convert("RGBA"))[..., 3]
    frame = list(render.frames(chase, SIZE, 10, transparent=True, loop=True))[3]
    assert np.abs(alpha.astype(int) - frame[..., 3]).mean() < 2


def test_a_transparent_moment_has_no_paper(chase, tmp_path):
    pages = {
        name: render.moment(chase, tmp_path / f"{name}.svg", 4.0, SIZE, transparent=name == "clear").read_text("utf-8")
        for name in ("clear", "white")
    }
    grounds = {
        name: re.search(r'id="patch_1">\s*<path[^>]*style="fill: ([^;"]*)', page).group(1) for name, page in pages.items()
    }
    assert grounds == {"clear": "none", "white": "#ffffff"}


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("a.mp4", r"a\.mp4: \.mp4 keeps no opacity; use \.webm, \.webp, or no suffix for PNG images$"),
        ("a.gif", r"a\.gif: \.gif knows no pixel that is opaque in part; use \.webm"),
    ],
)
def test_formats_without_opacity_are_refused(chase, tmp_path, name, words):
    with pytest.raises(ValueError, match=words):
        render.film(chase, tmp_path / name, SIZE, transparent=True)
    with pytest.raises(ValueError, match=r"a\.jpg: no transparent picture is written as \.jpg; use \.png or \.webp$"):
        render.poster(chase, tmp_path / "a.jpg", SIZE, transparent=True)
    with pytest.raises(ValueError, match="leave out the cards"):
        Look(transparent=True, cards=True)
    assert not list(tmp_path.iterdir())


def test_the_command_line_says_what_to_use_instead(tmp_path, command):
    for options in (("-o", "a.mp4"), ("--poster", "a.jpg")):
        refused = command("film", "delft/pronav-10", "--transparent", *options, cwd=tmp_path)
        assert refused.returncode == 2
        assert refused.stderr.count("\n") == 1
        assert "use .webm" in refused.stderr or "use .png" in refused.stderr
    done = command(
        "film", "delft/pronav-10", "--set", "world.ticks=3", "--transparent", "--size", "64x36", "--fps", "5", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert [each.suffix for each in (tmp_path / "out").iterdir()] == [".webm"]
