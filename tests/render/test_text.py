import numpy as np

from render.raster.glyphs import Atlas, plain, width, wrapped


def test_letters_that_the_face_lacks_become_plain_ones():
    assert plain("café – 2 × 3 → München") == "cafe - 2 x 3 -> Munchen"


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
