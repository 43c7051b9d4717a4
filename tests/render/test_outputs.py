"""Where films go: names that mean something to ffmpeg, links, long names; rates that are no whole numbers; what is refused."""

import re
import subprocess
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import render
from render.encoder import find_ffmpeg

NAMES = ("%05d", "a:b", "file:x", "50%", "%%", "-x", "é\n", "n" * 245)


@pytest.mark.parametrize("parent", ["", "%d", "http:x"])
@pytest.mark.parametrize("name", NAMES)
def test_a_folder_of_frames_may_have_any_name(make, name, parent, tmp_path):
    film = render.film(make(ticks=2), tmp_path / parent / name, (64, 64), fps=5, speed=10)
    frames = sorted(each.name for each in (tmp_path / parent / name).iterdir())
    assert frames == [f"frame-{n:05d}.png" for n in range(1, film.frames + 1)]
    assert [each.name for each in (tmp_path / parent).iterdir()] == [name]


@pytest.mark.parametrize("name", NAMES)
def test_a_film_may_have_any_name(make, name, tmp_path):
    render.film(make(ticks=1), tmp_path / "a:%d" / f"{name}.mp4", (64, 64), fps=2)
    assert [each.name for each in (tmp_path / "a:%d").iterdir()] == [f"{name}.mp4"]


def test_a_relative_name_with_a_colon(make, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    render.film(make(ticks=1), "http:x/a.mp4", (64, 64), fps=2)
    assert Path("http:x/a.mp4").stat().st_size > 500


def test_a_link_stays_a_link_and_what_it_points_at_is_written(make, tmp_path):
    (tmp_path / "far").mkdir()
    for name in ("a.mp4", "a.png", "frames"):
        (tmp_path / name).symlink_to(Path("far") / name)
    render.film(make(ticks=1), tmp_path / "a.mp4", (64, 64), fps=2)
    render.film(make(ticks=1), tmp_path / "frames", (64, 64), fps=2)
    render.poster(make(ticks=1), tmp_path / "a.png", (64, 64))
    assert all((tmp_path / name).is_symlink() for name in ("a.mp4", "a.png", "frames"))
    assert sorted(each.name for each in (tmp_path / "far").iterdir()) == ["a.mp4", "a.png", "frames"]


@pytest.mark.parametrize(
    ("fps", "told"),
    [(29.97, "29.97"), (Fraction(30000, 1001), "29.97"), (23.976, "23.98"), (1.5, "1.50"), (np.int64(12), "12")],
)
def test_a_rate_need_be_no_whole_number(make, fps, told, tmp_path):
    film = render.film(make(ticks=10), tmp_path / "a.mp4", (64, 64), fps=fps, speed=10)
    said = subprocess.run([find_ffmpeg(), "-i", tmp_path / "a.mp4"], capture_output=True, text=True, check=False).stderr
    assert re.search(rf" {told} fps", said), said
    assert film.frames == int(np.ceil(float(fps))) + round(float(fps))
    assert len(list(render.frames(make(ticks=10), (64, 64), fps=fps, speed=10))) == film.frames


@pytest.mark.parametrize("fps", [0, -1, 1001, float("nan"), float("inf"), 0.5])
def test_a_rate_that_cannot_be_is_refused(make, fps, tmp_path):
    with pytest.raises(ValueError, match=r"fps: .* is not possible"):
        render.film(make(), tmp_path / "a.mp4", (64, 64), fps=fps)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["a.xyz", "a", "a.mp4", "a.psd.", ".png"])
def test_an_image_of_no_known_format_is_refused(make, name, tmp_path):
    for draw in (render.poster, render.sheet):
        with pytest.raises(ValueError, match=r"unknown format.*\.png"):
            draw(make(), tmp_path / name, (64, 64))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("place", ["missing", "none"])
def test_a_missing_ffmpeg_is_named_with_the_mend(make, place, tmp_path, monkeypatch):
    import imageio_ffmpeg

    def get() -> str:
        if place == "none":
            raise RuntimeError("No ffmpeg exe could be found.")
        return str(tmp_path / "ffmpeg")

    monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", get)
    with pytest.raises(render.FilmError, match=r"there is no ffmpeg.*pip install imageio-ffmpeg.*IMAGEIO_FFMPEG_EXE"):
        render.film(make(), tmp_path / "a.mp4", (64, 64))
    assert list(tmp_path.iterdir()) == []
