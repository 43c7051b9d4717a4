"""Events of a recording are told as they happened, once each, and long enough to read."""

import re

import numpy as np
import pytest

import render
from render.composition import Composition
from render.encoder import FilmError
from render.story import Event, events, outcome
from render.style import Look

pytestmark = pytest.mark.quick

STAMP = re.compile(r"(\d\d):(\d\d):(\d\d)\.(\d{3})")


def seconds(text: str) -> list[float]:
    return [3600 * int(h) + 60 * int(m) + int(s) + int(ms) / 1000 for h, m, s, ms in STAMP.findall(text)]


def test_every_end_is_told_once_in_its_tick(make):
    recording = make(
        prey_ends={0: (3, "captured"), 1: (4, "crashed"), 2: (5, "arrived"), 3: (5, "arrived")},
        predator_ends={4: (6, "crashed")},
    )
    assert events(recording) == [
        Event(3, "Prey 0 is caught", (0,)),
        Event(4, "Prey 1 crashes", (1,)),
        Event(5, "Prey 2 and 3 reach the target", (2, 3)),
        Event(6, "Predator 4 crashes", (10,)),
    ]
    assert outcome(recording) == "After 8 s, of 6 prey: 2 arrived, 1 captured, 1 crashed and 2 alive."


def test_a_captor_is_named_where_it_is_known(make):
    """Both die of a capture; a predator that died elsewhere in that tick was not it."""
    recording = make(prey_ends={0: (3, "captured")}, predator_ends={2: (3, "captured")})
    assert events(recording)[0].words == "Prey 0 is caught"
    recording.predators.position[:3, 2] = recording.prey.position[:3, 0] + 0.5
    assert events(recording)[0] == Event(3, "Prey 0 is caught by predator 2", (0, 8))


def test_subtitles_follow_each_other_and_end_with_the_film(make, tmp_path):
    recording = make(ticks=60, prey_ends={0: (20, "captured"), 1: (21, "crashed"), 2: (45, "arrived")})
    text = render.subtitles(recording, tmp_path / "film.vtt", 30).read_text(encoding="utf-8")
    assert text.startswith("WEBVTT\n\n")
    assert all(
        line in text for line in ("Prey 0 is caught.\nPrey 1 crashes.", "Prey 2 reaches the target.", outcome(recording))
    )
    stamps = np.array(seconds(text)).reshape(-1, 2)
    assert (stamps[:, 1] - stamps[:, 0] >= 0.9).all()
    assert (stamps[1:, 0] >= stamps[:-1, 1]).all()
    assert stamps[-1, 1] == pytest.approx(7.0, abs=0.05)  # 60 ticks at 10 a second, and a second's rest
    assert stamps[1, 0] == pytest.approx(2.0, abs=0.05)  # tick 20


def test_subtitles_that_cannot_be_written_leave_nothing(make, tmp_path):
    (tmp_path / "film.vtt").mkdir()
    (tmp_path / "film.vtt" / "mine").touch()
    with pytest.raises(FilmError, match="cannot be written"):
        render.subtitles(make(), tmp_path / "film.vtt")
    assert [each.name for each in tmp_path.iterdir()] == ["film.vtt"]


def test_a_story_tells_each_event_for_as_long_as_it_takes_to_read(make):
    """One line at a time, so that nothing overlaps; only of one recording."""
    recording = make(ticks=90, prey_ends={0: (20, "captured"), 1: (24, "crashed"), 2: (70, "arrived")})
    stage = Composition(recording, (640, 360), Look(story=True), yuv=False)
    shown = {time: len(stage._happening(float(time))) for time in (10, 20.5, 25, 44, 60, 71, 88)}
    assert [time for time, shapes in shown.items() if not shapes] == [10, 60]
    assert shown[25] > shown[20.5]  # both, once both have happened
    assert stage.length(30) > Composition(recording, (640, 360), Look(), yuv=False).length(30)
    with pytest.raises(ValueError, match="story: needs one recording"):
        Composition([recording, recording], (640, 360), Look(story=True), yuv=False)
