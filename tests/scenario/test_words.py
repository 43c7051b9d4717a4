"""Titles and nouns are true of the scenario that they stand over, however it was changed."""

import pytest

import tiswarm
from tiswarm.scenario import presets
from tiswarm.scenario.changes import changes
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.words import Words, literal, named, titled
from tiswarm.system.words import plural, spelt

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (0, "no"),
        (1, "one"),
        (13, "thirteen"),
        (42, "forty-two"),
        (90, "ninety"),
        (100, "a hundred"),
        (101, "101"),
        (200, "two hundred"),
        (1000, "a thousand"),
        (1234, "1\u00a0234"),
        (50_000, "fifty thousand"),
        (100_000, "a hundred thousand"),
        (1_000_000, "a million"),
        (4_000_000, "four million"),
    ],
)
def test_numbers_are_spelt_out_where_words_are_few(number, words):
    assert spelt(number) == words


@pytest.mark.parametrize(
    ("noun", "more"),
    [
        ("robot", "robots"),
        ("fish/fish", "fish"),
        ("finch", "finches"),
        ("fly", "flies"),
        ("ray", "rays"),
        ("prey/prey", "prey"),
    ],
)
def test_nouns_have_their_plurals(noun, more):
    assert plural(noun, 2) == plural(noun, 0) == more
    assert plural(noun, 1) == noun.partition("/")[0]


@pytest.mark.parametrize(
    ("preset", "overrides", "title"),
    [
        ("demo/chase", {}, "Six prey split up to slip past fifteen predators"),
        ("demo/chase", {"prey.count": 1000}, "A thousand prey split up to slip past fifteen predators"),
        ("demo/chase", {"prey.count": 1, "predators.count": 1}, "A prey splits up to slip past a predator"),
        ("delft/pronav-10", {"predators.count": 0}, "Six prey run through ten obstacles"),
        ("delft/pronav-10", {"obstacles.count": 1, "predators.count": 0}, "Six prey run through an obstacle"),
        ("delft/pronav-10", {"obstacles.count": 0, "predators.count": 0}, "Six prey run over open ground"),
        ("m20/hawk", {"predators.count": 0}, "Ten swallows fly where no hawk hunts"),
        ("demo/hawk", {"predators.count": 2}, "Two hawks hunt two hundred swallows"),
        ("lookout/aquarium", {"prey.count": 1, "obstacles.count": 1}, "A boid finds its way around a sphere"),
        ("delft/pronav-10", {"title": "My own {braces}, [brackets]"}, None),
    ],
)
def test_titles_count_what_is_there(preset, overrides, title):
    if title is None:
        with pytest.raises(ScenarioError, match=r"unknown field '\{braces\}'"):
            tiswarm.load(preset, overrides)
    else:
        assert tiswarm.load(preset, overrides).title == title


def test_every_preset_says_nothing_of_predators_where_none_are():
    for name in presets.presets():
        scenario = tiswarm.load(name, {"predators.count": 0})
        assert "predator" not in scenario.title, name
        assert scenario.title == scenario.replaced({}).title


def test_lists_of_presets_have_the_titles_that_films_have():
    for name in presets.presets():
        assert presets.title(name) == tiswarm.load(name).title


def test_a_template_survives_being_written_and_read():
    scenario = tiswarm.load("demo/chase", {"prey.count": 3})
    again = type(scenario).from_json(scenario.to_json()).replaced({"prey.count": 2})
    assert again.title == "Two prey split up to slip past fifteen predators"


def test_a_changed_scenario_says_what_was_changed():
    assert changes(tiswarm.load("delft/pronav-10")) == {}
    changed = tiswarm.load("delft/pronav-10", {"prey.count": 1000, "prey.strategy": "evasive", "prey.weights.evade": 0.5})
    assert changes(changed) == {"prey.strategy": "evasive", "prey.count": 1000, "prey.weights.evade": 0.5}
    assert named(changes(changed)) == ["prey.strategy = evasive", "prey.count = 1\u00a0000", "prey.weights.evade = 0.5"]


def test_words_change_nothing_that_is_computed():
    scenario = tiswarm.load("delft/pronav-10")
    assert scenario.replaced({"words.prey": "mouse/mice", "film.measures": ["speed"]}).hash() == scenario.hash()
    with pytest.raises(ScenarioError, match=r"film\.measures"):
        tiswarm.load("delft/pronav-10", {"film.measures": ["beauty"]})


@pytest.mark.parametrize(
    "title", ["", "plain", "[a|b]", "{prey.count} [x", "{what}", "a}b{", "{[]}", "{{prey}}", "]]{", "[{predators}|none]"]
)
def test_a_title_from_elsewhere_stays_as_it_is(title):
    assert titled(literal(title), Words(), {"prey": 1, "predators": 0, "obstacles": 0}) == title
