import re
import subprocess
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

import render
import tiswarm
from render.encoder import format_of
from render.films import Film

SMALL = (320, 180)


def described(path: Path) -> str:
    """Give what ffmpeg says about a file."""
    return subprocess.run(
        [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path)], capture_output=True, text=True, check=False
    ).stderr


def decoded(path: Path, size: tuple[int, int]) -> np.ndarray:
    """Decode a film: [frame, y, x, channel]."""
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, size[1], size[0], 3)


@pytest.fixture(scope="module")
def mp4(chase, tmp_path_factory) -> Film:
    return render.film(chase, tmp_path_factory.mktemp("film") / "chase.mp4", SMALL, 30)


def test_a_film_has_the_stated_frames_size_and_rate(mp4):
    assert decoded(mp4.path, SMALL).shape == (mp4.frames, 180, 320, 3)
    assert mp4.frames == 8 * 3 + 30
    stream = re.search(r"Stream .*Video.*", described(mp4.path)).group()
    assert "h264" in stream
    assert "320x180" in stream
    assert "30 fps" in stream


def test_a_film_is_tagged_as_what_it_is(mp4):
    words = described(mp4.path)
    assert re.search(r"yuv420p\(tv, bt709", words)
    assert "seed 7" in words
    assert "trial 4" in words
    assert "preset: delft/pronav-10" in words
    assert f"tiswarm: {tiswarm.__version__}" in words
    assert "Six prey run fifteen" in words


def test_a_film_starts_fast(mp4):
    raw = mp4.path.read_bytes()
    assert raw.index(b"moov") < raw.index(b"mdat")


def test_decoded_frames_are_the_drawn_ones(chase, tmp_path):
    made = render.film(chase, tmp_path / "best.mp4", SMALL, 10, quality="best")
    for film_frame, drawn in zip(decoded(made.path, SMALL), render.frames(chase, SMALL, 10), strict=True):
        assert np.abs(film_frame.astype(int) - drawn).mean() < 3


def test_a_film_shows_itself_in_a_notebook(mp4):
    assert mp4._repr_html_().startswith('<video src="data:video/mp4;base64,')


@pytest.mark.parametrize(("name", "codec"), [("a.webm", "vp9"), ("a.gif", "gif")])
def test_other_formats(chase, tmp_path, name, codec):
    made = render.film(chase, tmp_path / name, (160, 90), 10, quality="draft")
    words = described(made.path)
    assert codec in words
    assert "160x90" in words
    assert len(decoded(made.path, (160, 90))) == made.frames


def test_a_path_without_suffix_is_a_folder_of_images(chase, tmp_path):
    made = render.film(chase, tmp_path / "frames", (160, 90), 10)
    images = sorted((tmp_path / "frames").iterdir())
    assert len(images) == made.frames
    with Image.open(images[0]) as first:
        assert np.array_equal(np.asarray(first), next(render.frames(chase, (160, 90), 10)))
    with pytest.raises(render.FilmError, match="not an empty folder"):
        render.film(chase, tmp_path / "frames", (160, 90), 10)


def test_frames_are_arrays_of_their_own(chase):
    first, second, *_ = render.frames(chase, (64, 64), 10)
    assert first.shape == (64, 64, 3)
    assert first.dtype == np.uint8
    assert not np.shares_memory(first, second)


@pytest.mark.parametrize("theme", sorted(render.THEMES))
def test_posters(chase, tmp_path, theme):
    with Image.open(render.poster(chase, tmp_path / "poster.png", SMALL, theme=theme)) as image:
        assert image.size == SMALL
        assert len(image.getcolors(100_000)) > 50


def test_a_sheet_holds_its_frames(chase, tmp_path):
    with Image.open(render.sheet(chase, tmp_path / "sheet.png", (160, 90), shape=(3, 2))) as image:
        assert image.width > 3 * 160
        assert image.height > 2 * 90


def test_progress_counts_to_the_end(chase, tmp_path):
    seen = []
    made = render.film(chase, tmp_path / "a.mp4", (64, 64), 10, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(n + 1, made.frames) for n in range(made.frames)]


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"size": (321, 180)}, "use 322x180"),
        ({"size": (8, 180)}, "16 to 16384"),
        ({"fps": 0}, "fps"),
        ({"quality": "super"}, "draft, good, best"),
        ({"theme": "blue"}, "dark, light, print"),
        ({"speed": 0}, "speed"),
        ({"speed": float("nan")}, "speed"),
        ({"trail": -1}, "trail"),
        ({"overlay": ("nothing",)}, "perception"),
        ({"camera": "drone"}, "follow"),
        ({"camera": "follow:99"}, "use 0 to 10"),
        ({"camera": ((5, 5), (1, 9))}, "lower to its upper"),
        ({"labels": ["a", "b"]}, "one each"),
    ],
)
def test_wrong_choices_are_named_before_anything_is_written(chase, tmp_path, how, words):
    with pytest.raises(ValueError, match=words):
        render.film(chase, tmp_path / "a.mp4", **{"size": SMALL, **how})
    assert not list(tmp_path.iterdir())


def test_an_unknown_format_and_an_unknown_choice_are_named(chase, tmp_path):
    with pytest.raises(ValueError, match=r"\.mp4"):
        render.film(chase, tmp_path / "a.avi")
    with pytest.raises(TypeError, match="a look has theme"):
        render.film(chase, tmp_path / "a.mp4", colour="red")
    with pytest.raises(ValueError, match="fps"):
        render.film(chase, tmp_path / "a.gif", fps=60)


def test_odd_sizes_are_for_images_only(chase, tmp_path):
    assert not format_of(tmp_path / "a.gif", "good").yuv
    with Image.open(render.poster(chase, tmp_path / "odd.png", (321, 181))) as image:
        assert image.size == (321, 181)
