from dataclasses import replace

import numpy as np
import pytest

import render
from render.captions.caption import fitting
from render.raster import faces
from render.raster.glyphs import Atlas, width, wrapped

pytestmark = pytest.mark.quick

LINES = {
    "Chinese": "六只猎物穿过十个障碍物",
    "Cyrillic": "Шесть жертв",
    "Arabic": "ست فرائس تهرب",
    "Hebrew": "שלום עולם",
    "Korean": "한국어",
    "Greek": "Ωμέγα",
    "signs": "σ ± 5 µm, 3 m² × 2 ≥ 1 – Zürich → ½",
}


def _ink(text):
    atlas = Atlas()
    place = atlas._placed(faces.seen(text), 24)
    left, top, wide, high = place[:4]
    return atlas.ink[top : top + high, left : left + wide]


@pytest.mark.parametrize("text", LINES.values(), ids=LINES.keys())
def test_a_face_is_found_for_what_people_write(text):
    assert all(faces.MISSING not in letters for _, letters in faces.runs(faces.seen(text)))
    assert _ink(text).any()
    assert abs(_ink(text).shape[1] - width(text, 24)) < 12


def test_signs_are_not_lost():
    assert width("5 µm", 24) > width("5 m", 24) + 5
    assert not np.array_equal(_ink("±"), _ink("+"))


def test_what_no_face_has_is_a_visible_mark():
    assert faces.runs("\U0001f600")[0][1] == faces.MISSING
    assert _ink("\U0001f600").any()


def test_arabic_is_joined_and_runs_from_right_to_left():
    joined = faces.seen("سلام")
    assert joined != "سلام"
    assert all("\ufe70" <= letter <= "\ufefc" for letter in joined)
    assert faces.seen("abc שלום") == "abc םולש"  # the Latin word leads, as its line is one of left to right


def test_lines_without_spaces_break_between_letters():
    lines = wrapped(LINES["Chinese"] * 3, 20, 120, 9)
    assert len(lines) > 3
    assert "".join(lines) == LINES["Chinese"] * 3
    assert all(width(line, 20) <= 120 for line in lines)


@pytest.mark.parametrize("title", ["", " ", "\x00\x1b[31m", "\u200b", *LINES.values()])
@pytest.mark.parametrize("size", [(320, 180), (180, 320)])
def test_any_title_makes_a_picture(make, title, size):
    recording = make()
    titled = replace(recording, scenario=recording.scenario.replaced({"title": title, "source": title}))
    assert next(iter(render.frames(titled, size=size))).shape == (size[1], size[0], 3)
    pair = render.frames([titled, titled], size=size, labels=[title, title])
    assert next(iter(pair)).shape == (size[1], size[0], 3)


def test_long_words_break_behind_their_hyphens():
    assert wrapped("fifteen proportional-navigation predators", 20, 220, 9) == [
        "fifteen proportional-",
        "navigation predators",
    ]
    assert wrapped("a network of 13-16-2 in 3-D", 20, 130, 9) == ["a network of", "13-16-2 in 3-D"]


def test_titles_shrink_before_a_word_is_broken():
    title = "Six prey run fifteen proportional-navigation predators through ten obstacles"
    lines, size = fitting(title, (34, 30, 26, 22), 252, 5, 1.0)
    assert size < 34
    assert "proportional-navigation" in " ".join(lines).split()
    lines, size = fitting(title, (34,), 252, 9, 1.0)
    assert size == 34
    assert any(line.endswith("proportional-") for line in lines)


def test_wrapped_lines_fit_and_end_in_an_ellipsis():
    text = "Six prey run fifteen proportional-navigation predators through ten obstacles"
    lines = wrapped(text, 20, 240, 2)
    assert len(lines) == 2
    assert lines[-1].endswith("…")
    assert all(width(line, 20) <= 240 for line in lines)
    assert " ".join(wrapped(text, 20, 240, 9)) == text


def test_one_word_too_long_is_shortened():
    (line,) = wrapped("Donaudampfschifffahrtsgesellschaft", 20, 100, 3)
    assert width(line, 20) <= 100


def test_running_numbers_stand_still():
    assert len({width(f"{n:03d}.5", 30, tabular=True) for n in range(0, 999, 37)}) == 1


def test_the_atlas_grows_without_moving_what_it_holds():
    atlas = Atlas()
    before = atlas.line("first", (0, 50), 30, (1, 1, 1))
    for n in range(60):
        atlas.line(f"a longer line of text, number {n}", (0, 50), 30, (1, 1, 1))
    assert np.array_equal(atlas.line("first", (0, 50), 30, (1, 1, 1)), before)
    assert atlas.ink.shape[0] > 64
