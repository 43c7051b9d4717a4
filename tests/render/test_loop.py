"""A loop ends where it begins: no jump between its last frame and its first."""

from itertools import pairwise

import numpy as np
import pytest
from PIL import Image

import render
from render.style import Look

SIZE = (160, 90)


def film(recording, **look):
    return [frame.astype(int) for frame in render.frames(recording, SIZE, 20, speed=10, **look)]


def test_the_end_of_a_loop_runs_into_its_beginning(make):
    recording = make(ticks=30)
    plain, looped = film(recording), film(recording, loop=True)
    overlap = len(plain) - len(looped)
    assert overlap == 20  # a second of trail
    for n in range(len(looped) - overlap):
        assert (looped[n] == plain[n + overlap]).all()
    steps = [np.abs(a - b).mean() for a, b in zip(looped, [*looped[1:], looped[0]], strict=True)]
    ordinary = max(np.abs(a - b).mean() for a, b in pairwise(plain))
    jump = np.abs(plain[-1] - plain[0]).mean()
    assert jump > 4 * ordinary
    assert steps[-1] < 0.2 * jump
    assert max(steps) < ordinary + 2 * jump / overlap  # each frame fades by its share


def test_a_loop_has_no_cards():
    with pytest.raises(ValueError, match="leave out the cards"):
        Look(loop=True, cards=True)


def test_loops_are_written_as_webp(make, tmp_path):
    written = render.film(make(ticks=10), tmp_path / "loop.webp", (64, 36), 20, loop=True, trail=0.5)
    assert written.frames == 30
    with Image.open(tmp_path / "loop.webp") as image:
        assert image.size == (64, 36)
        assert image.n_frames > 15  # those that are alike are one
        assert image.info["loop"] == 0
