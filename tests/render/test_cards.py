"""Cards say before a film what it shows, and after it how that ended."""

from dataclasses import replace

import numpy as np
import pytest

from render.composition import Composition
from render.language import NAMES
from render.raster.shapes import ALPHA, KIND, PLACE, SIZE, SPRITE
from render.scene.signs import PARTED
from render.story import CLOSING, OPENING
from render.style import Look


def stage(subject, size=(640, 360), **look):
    return Composition(subject, size, Look(**look), yuv=False)


def test_cards_come_before_and_after_what_is_filmed(chase):
    shots = list(stage(chase, cards=True).shots(20))
    plain = list(stage(chase).shots(20))
    before, after = round(20 * OPENING), round(20 * CLOSING)
    assert [shot.card for shot in shots] == ["opening"] * before + [""] * len(plain) + ["closing"] * after
    assert shots[before:-after] == plain
    assert len(shots) == stage(chase, cards=True).length(20)


def test_a_film_begins_and_ends_with_its_cards_at_their_fullest_and_they_come_and_go(chase):
    filmed = stage(chase, cards=True)
    shots = list(filmed.shots(20))
    veils = [filmed._cards.frame(shot.card, shot.age, shot.left)[0, ALPHA] if shot.card else 0.0 for shot in shots]
    assert veils[0] == veils[-1] == max(veils) > 0.8
    steps = np.diff(veils[: round(20 * OPENING) + 1])
    assert (steps <= 1e-6).all()
    assert (steps >= -0.3).all()


def test_the_last_card_knows_how_it_ended_even_if_nothing_was_drawn_before(chase):
    filmed = stage(chase, cards=True)
    filmed._cards.frame("closing", 1.0, 1.0)
    counts = {each.name: each.text(8) for each in filmed._cards._found}
    assert counts == {"alive": "3", "arrived": "1", "captured": "1", "crashed": "1", "predators": "3"}


@pytest.mark.parametrize("size", [(640, 360), (360, 640), (720, 1280), (320, 180), (400, 400)])
@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("language", NAMES)
def test_what_cards_say_stays_inside_the_frame(chase, size, count, language):
    filmed = stage(chase if count == 1 else [chase] * count, size, cards=True, language=language)
    for name in ("opening", "closing"):
        rows = filmed._cards.frame(name, 1.0, 1.0)[1:]
        assert len(rows) > 10
        assert (rows[:, PLACE] >= 0).all()
        assert (rows[:, PLACE + 1] >= 0).all()
        words = rows[rows[:, KIND] == SPRITE]
        assert (words[:, PLACE] + words[:, SIZE] <= size[0]).all()
        assert (rows[:, PLACE] <= size[0]).all()
        assert (rows[:, PLACE + 1] + np.where(rows[:, SIZE + 1] < 2, 0, 1) <= size[1]).all()


def test_a_key_explains_the_colours_of_a_swarm_that_splits_up_and_only_there(chase):
    whole = replace(chase, prey=replace(chase.prey, group=np.zeros_like(chase.prey.group)))
    for subject, explained in ((chase, True), (whole, False), ([whole, chase], True), ([whole, whole], False)):
        assert (PARTED in stage(subject)._cards._key) == explained
    assert len(stage(chase).caption._prey_likeness(np.zeros((1, 2)), np.ones((1, 2)))) == 2
    assert len(stage(whole).caption._prey_likeness(np.zeros((1, 2)), np.ones((1, 2)))) == 1
