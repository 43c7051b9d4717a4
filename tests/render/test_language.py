"""Captions in several languages: tables are whole, numbers and plurals are the language's, and lines begin where they do."""

import re
import tomllib

import numpy as np
import pytest

import render
import tiswarm
from render.composition import Composition, Shot
from render.language import FOLDER, NAMES, language_named
from render.raster import faces
from render.raster.shapes import KIND, PLACE, SIZE, SPRITE
from render.story import events, outcome
from render.style import Look
from tiswarm.scenario import presets
from tiswarm.scenario.words import KINDS

pytestmark = pytest.mark.quick

TABLES = {name: tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8")) for name in NAMES}
OTHERS = [name for name in NAMES if name != "en"]
MORE = ("nouns", "titles", "covered", "areas", "units")
"""Sections in which English has nothing to translate."""


def _texts(entry):
    return list(entry.values()) if isinstance(entry, dict) else [entry]


def _fields(entry):
    return {name for text in _texts(entry) for name in re.findall(r"\{(\w+)\}", text)}


def _plural(name):
    from babel import Locale

    return {*Locale.parse(name).plural_form.tags, "other"}


@pytest.mark.parametrize("name", OTHERS)
def test_every_language_says_all_that_english_says(name):
    own, english = TABLES[name], TABLES["en"]
    assert {section for section in own if section not in MORE} == set(english)
    for section, entries in english.items():
        assert list(own[section]) == list(entries), section
        for key, entry in entries.items():
            assert _fields(own[section][key]) - {"count"} == _fields(entry) - {"count"}, key
            if isinstance(own[section][key], dict):
                assert set(own[section][key]) == _plural(name), key


@pytest.mark.parametrize("name", OTHERS)
def test_every_noun_of_the_presets_is_there_in_all_its_numbers(name):
    for preset in presets.presets():
        words = presets.load(preset).words
        for kind in KINDS:
            forms = TABLES[name]["nouns"][getattr(words, kind).partition("/")[0]]
            assert set(forms) == {"single", "several", *_plural(name)}, preset
        assert words.covered in TABLES[name]["covered"], preset


@pytest.mark.parametrize("name", OTHERS)
def test_every_title_is_a_presets_and_counts_what_is_there(name):
    for preset, title in TABLES[name]["titles"].items():
        scenario = tiswarm.load(preset)
        assert _fields(title) <= set(KINDS)
        assert language_named(name).title(scenario) != scenario.title


@pytest.mark.parametrize("name", NAMES)
def test_every_letter_can_be_drawn(name):
    for section in TABLES[name].values():
        for text in (text for entry in section.values() for text in _texts(entry)):
            drawn = [letters for _, letters in faces.runs(faces.seen(re.sub(r"\{\w+\}", "", text)))]
            assert not any(faces.MISSING in letters for letters in drawn), text


@pytest.mark.parametrize(
    ("name", "whole", "decimal", "short", "length", "listed"),
    [
        ("en", "12\u00a0345", "\N{MINUS SIGN}0.50", "2.5", "2.5 km", "1, 2 and 3"),
        ("de", "12.345", "\N{MINUS SIGN}0,50", "2,5", "2,5 km", "1, 2 und 3"),
        ("ar", "12,345", "\N{MINUS SIGN}0.50", "2.5", "2.5 كم", "1 و2 و3"),
    ],
)
def test_numbers_lengths_and_lists_are_written_as_the_language_does(name, whole, decimal, short, length, listed):
    words = language_named(name)
    assert (words.whole(12345), words.decimal(-0.5, 2), words.short(2.5)) == (whole, decimal, short)
    assert (words.length(2500), words.listed(["1", "2", "3"])) == (length, listed)


@pytest.mark.parametrize(
    ("name", "counts"),
    [
        ("en", {1: "1 swallow", 2: "2 swallows", 11: "11 swallows"}),
        ("de", {1: "1 Schwalbe", 2: "2 Schwalben", 11: "11 Schwalben"}),
        ("ar", {1: "سنونوة واحدة", 2: "سنونوتان", 9: "9 سنونوات", 11: "11 سنونوة"}),
    ],
)
def test_plurals_are_the_languages(name, counts):
    scenario = tiswarm.load("demo/hawk")
    for count, words in counts.items():
        assert language_named(name).counted(scenario, "prey", count) == words


def test_a_translated_title_stands_only_over_what_it_is_true_of():
    german, scenario = language_named("de"), tiswarm.load("demo/hawk")
    assert german.title(scenario) == "1 Habicht auf der Jagd: 200 Schwalben"
    assert german.title(scenario.replaced({"prey.count": 3})) == "1 Habicht auf der Jagd: 3 Schwalben"
    for changed in ({"predators.count": 0}, {"title": "Mine"}, {"words.prey": "kite"}):
        assert german.title(scenario.replaced(changed)) == scenario.replaced(changed).title
    assert german.noun(scenario.replaced({"words.prey": "kite"}), "prey", 2) == "kites"


def test_what_was_changed_is_told_in_short():
    changed = tiswarm.load("delft/pronav-10", {"prey.count": 1000, "prey.strategy": "evasive", "prey.weights.evade": 0.5})
    english = language_named("en")
    assert english.changed(changed).startswith("with prey.strategy = evasive, prey.count = 1\u00a0000, ")
    assert english.changed(changed, 1) == "with prey.strategy = evasive, 2 more"
    assert english.changed(tiswarm.load("delft/pronav-10")) == ""
    assert language_named("de").changed(changed, 1) == "mit prey.strategy = evasive, 2 weiteren"


def test_what_happens_is_told_in_the_language(make, tmp_path):
    recording = make(prey_ends={0: (3, "captured"), 1: (5, "arrived"), 2: (5, "arrived")}, predator_ends={2: (3, "captured")})
    recording.predators.position[:3, 2] = recording.prey.position[:3, 0] + 0.5
    told = [each.words for each in events(recording, language_named("de"))]
    assert told == ["Beutetier 0 wird von Räuber 2 gefangen", "Beutetiere 1 und 2 erreichen das Ziel"]
    assert outcome(recording, language_named("de")) == "6 Beutetiere, nach 8 s: 2 am Ziel, 1 gefangen und 3 unterwegs."
    assert language_named("de").clauses(told) == "; ".join(told)
    assert language_named("en").clauses(["Prey 0 crashes", "Prey 1 crashes"]) == "Prey 0 crashes; prey 1 crashes"
    text = render.subtitles(recording, tmp_path / "film.vtt", 30, language="de").read_text(encoding="utf-8")
    assert told[0] + "." in text


def _edges(recording, size, language):
    """How far a caption's words are from its left and right edges at least [px]."""
    stage = Composition(recording, size, Look(language=language), yuv=False)
    rows, box = np.concatenate([stage.caption.ground(), stage.caption.frame(2.0)]), stage.caption._panel
    words = rows[rows[:, KIND] == SPRITE]
    return words[:, PLACE].min() - box.left, box.right - (words[:, PLACE] + words[:, SIZE]).max()


@pytest.mark.parametrize("size", [(1280, 720), (1280, 640), (720, 1280)])
def test_captions_from_the_right_mirror_those_from_the_left(chase, size):
    """Words begin as far from the right edge as they do from the left, and none leaves the caption."""
    english, arabic = (_edges(chase, size, language) for language in ("en", "ar"))
    assert arabic[1] == pytest.approx(english[0], abs=4)
    assert arabic[0] > 0
    stage = Composition(chase, size, Look(language="ar"), yuv=False)
    stage.caption._within(0, 100)
    assert stage.caption._span(0, 25) == (75, 100)


@pytest.mark.parametrize("language", OTHERS)
def test_every_kind_of_caption_is_drawn(chase, make, language):
    look = {"language": language, "story": True, "cards": True, "chart": ("alive", "speed"), "overlay": ("density",)}
    look["among"] = render.Among("captured", np.array([0, 1, 2]))
    stage = Composition(chase, (1280, 720), Look(**look), yuv=False)
    for shot in (Shot(0.0, "opening", 0.5, 1.0), Shot(4.0), Shot(8.0, "closing", 1.0, 1.0)):
        assert stage.shot(shot, stage.canvas.blank()).any()
    pair = Composition([chase, make(trial=5)], (640, 360), Look(language=language), yuv=False)
    assert pair.frame(4.0, pair.canvas.blank()).any()


def test_an_unknown_language_is_refused_at_once():
    with pytest.raises(ValueError, match="language: unknown 'xx'; use one of ar, de, en"):
        Look(language="xx")
