"""The page in a real browser: what its readers can do, and what it never does."""

import re
from dataclasses import replace

import numpy as np
import pytest
from browser import pixels

import render
import tiswarm

NASTY = "<script>window.hacked = 1</script><img src=x onerror=hacked=1>\"' &amp; </script> \u202eאבג " + "x" * 5000


@pytest.fixture(scope="module")
def termed(make):
    """A recording whose terms, two for prey and one for predators, add up to the changes of velocity."""
    recording = make(ticks=12)
    swarms = {}
    for kind in ("prey", "predators"):
        swarm = getattr(recording, kind)
        change = np.full(swarm.velocity.shape, np.nan)
        change[:-1] = np.diff(swarm.velocity, axis=0)
        pull = np.broadcast_to([0.25, -0.125], change.shape).copy()
        swarms[kind] = replace(swarm, terms={"goal": pull, "separation": change - pull})
    return replace(recording, **swarms)


def test_a_page_plays_by_itself_unless_its_reader_wants_rest(browser, make, tmp_path):
    page = render.replay(make(ticks=600), tmp_path / "long.html")
    browser.open(page)
    assert not browser.run("return tiswarm.clock.playing")
    browser.look(calm=False)
    browser.open(page)
    browser.until("return tiswarm.clock.time > 2")
    assert browser.find("play").get_attribute("aria-label") == "Pause"
    browser.press(" ")
    assert not browser.run("return tiswarm.clock.playing")


def test_the_end_is_reached_and_is_the_start_of_the_next_play(browser, page):
    browser.open(page, "#tick=19")
    browser.run("tiswarm.clock.pace(20); tiswarm.clock.play()")
    browser.until("return !tiswarm.clock.playing")
    assert browser.find("scrub").get_attribute("value") == "20"
    browser.press("l", " ")
    browser.until("return tiswarm.clock.time < 15")
    assert browser.find("loop").get_attribute("aria-pressed") == "true"


def test_the_keyboard_does_all(browser, page):
    from selenium.webdriver.common.keys import Keys

    browser.open(page)
    ticks = []
    for key in (Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_LEFT, Keys.END, Keys.ARROW_LEFT, Keys.HOME):
        browser.press(key)
        ticks.append(browser.run("return tiswarm.clock.time"))
    assert ticks == [1, 2, 1, 20, 19, 0]
    browser.press(Keys.ARROW_UP)
    assert browser.find("speed").get_attribute("value") == "2"
    browser.press("?")
    assert browser.run("return document.getElementById('help').open")
    browser.press(Keys.ESCAPE)
    browser.press("n", "n")
    assert browser.find("agent").get_attribute("value") == "1"
    browser.press("c")
    assert browser.run("return tiswarm.stage.following")
    browser.press("t")
    assert browser.run("return document.documentElement.dataset.theme") == "light"


def test_fingers_choose_drag_and_zoom(browser, page, calm):
    browser.open(page, "#tick=7")
    browser.drawn()
    box = browser.run("const b = document.getElementById('stage').getBoundingClientRect(); return [b.x, b.y]")

    def touch(kind: str, *spots) -> None:
        points = [{"x": box[0] + x, "y": box[1] + y, "id": n} for n, (x, y) in enumerate(spots)]
        browser.ask("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    spot = pixels(browser, calm.prey.position[7, 2])
    touch("touchStart", spot + np.array([12, 0]))
    touch("touchEnd")
    browser.until("return tiswarm.stage.chosen.agent === 2")
    before = browser.run("return tiswarm.stage.scenes[0].lens.centre")
    touch("touchStart", (300, 300))
    touch("touchMove", (340, 300))
    touch("touchMove", (400, 300))
    touch("touchEnd")
    browser.until("return tiswarm.stage.scenes[0].lens.centre[0] < arguments[0] - 1", before[0])
    touch("touchStart", (300, 300), (400, 300))
    touch("touchMove", (250, 300), (450, 300))
    touch("touchMove", (200, 300), (500, 300))
    touch("touchEnd")
    browser.until("return tiswarm.stage.scenes[0].lens.zoom > 2")
    assert browser.run("return tiswarm.stage.chosen.agent") == 2


def test_every_control_has_a_name_and_can_be_reached(browser, page):
    from selenium.webdriver.common.keys import Keys

    browser.open(page)
    nameless = """return [...document.querySelectorAll('button, input, select, canvas, section')].filter(e =>
        !e.closest('[hidden]') && e.getAttribute('aria-hidden') !== 'true' && !e.getAttribute('aria-label')
        && !e.closest('label') && !(e.labels ?? []).length).map(e => e.outerHTML)"""
    assert browser.run(nameless) == []
    reached = []
    for _ in range(25):
        browser.press(Keys.TAB)
        reached.append(browser.run("return document.activeElement.id"))
    wanted = {"theme", "closer", "farther", "fit", "scrub", "back", "play", "on", "speed", "loop", "full", "ask", "agent"}
    assert wanted | {"switch-trails", "switch-links"} <= set(reached)
    browser.run("document.getElementById('play').focus()")
    browser.press(Keys.TAB)
    outline = browser.run("return getComputedStyle(document.activeElement).outlineWidth")
    assert float(outline.removesuffix("px")) >= 2


def test_the_card_says_what_the_recording_holds(browser, page, calm):
    browser.open(page, "#tick=7")
    browser.drawn()
    x, y = pixels(browser, calm.prey.position[7, 2])
    browser.point(x, y)
    browser.until("return !document.getElementById('card').hidden")
    words = browser.text("card").replace("−", "-")
    assert words.startswith("prey 3calm, sub-swarm 0")
    place, velocity = calm.prey.position[7, 2], calm.prey.velocity[7, 2]
    assert f"position{place[0]:.2f}, {place[1]:.2f} m" in words
    shown = [float(each) for each in re.search(r"velocity(.*?) m/s", words)[1].split(",")]
    assert np.allclose(shown, velocity, atol=6e-4)
    assert f"speed{np.hypot(*velocity):.3f} m/s" in words
    apart = np.linalg.norm(calm.prey.position[7] - place, axis=1)
    mates = (apart > 0) & (apart < calm.scenario.prey.perception) & (calm.prey.group[7] == calm.prey.group[7, 2])
    assert f"neighbours{mates.sum()}" in words


def test_neighbours_are_those_whom_the_agent_heeds(browser, calm, tmp_path):
    place, velocity = calm.prey.position[7], calm.prey.velocity[7]
    for degrees, nearest in ((140, "all"), (360, 2), (200, 1)):
        narrow = replace(calm, scenario=calm.scenario.replaced({"prey.field_of_view": degrees, "prey.nearest": nearest}))
        browser.open(render.replay(narrow, tmp_path / "narrow.html", exact=True), "#tick=7&agent=3")
        browser.drawn()
        way = place - place[2]
        apart = np.linalg.norm(way, axis=1)
        counts = (apart > 0) & (apart < calm.scenario.prey.perception) & (calm.prey.group[7] == calm.prey.group[7, 2])
        counts &= way @ velocity[2] >= np.cos(np.radians(degrees) / 2) * apart * np.hypot(*velocity[2])
        expected = counts.sum() if nearest == "all" else min(counts.sum(), nearest)
        assert f"neighbours{expected}" in browser.text("card")


@pytest.mark.parametrize("exact", [False, True])
def test_terms_add_up_to_the_change_of_velocity(browser, termed, tmp_path, exact):
    browser.open(render.replay(termed, tmp_path / "terms.html", exact=exact), "#tick=4&agent=8")
    browser.drawn()
    rows = browser.run(
        "return [...document.querySelectorAll('#card .terms tr')].map(r => [...r.cells].map(c => c.textContent))"
    )
    told = {name: [float(each) for each in way.replace("−", "-").split(",")] for name, way, _ in rows}
    change = termed.predators.velocity[5, 1] - termed.predators.velocity[4, 1]
    assert set(told) == {"goal", "separation", "sum"}
    assert np.allclose(told["goal"], [0.25, -0.125], atol=1e-4)
    assert np.allclose(np.add(told["goal"], told["separation"]), told["sum"], atol=2e-4)
    assert np.allclose(told["sum"], change, atol=2e-4)


def test_names_are_words_and_never_markup(browser, make, tmp_path):
    scenario = tiswarm.load(
        "delft/pronav-10", {"title": NASTY, "source": NASTY, "world.areas": [{"label": NASTY, "region": [[0, 0], [70, 50]]}]}
    )
    recording = replace(make(ticks=3), scenario=scenario)
    for gallery in (False, True):
        path = render.replay(
            [recording, recording], tmp_path / "nasty.html", labels=[NASTY, NASTY], gallery=gallery, title=NASTY
        )
        browser.open(path)
        assert browser.text("title") == NASTY
        assert browser.run("return window.hacked ?? null") is None
        assert browser.run("return document.images.length") == 0
        assert browser.run("return document.documentElement.scrollWidth") <= 1280


@pytest.mark.parametrize("width", [360, 1280, 2560])
def test_nothing_sticks_out(browser, page, width):
    browser.look(width, 800)
    browser.open(page, "#tick=4&agent=1")
    browser.drawn()
    assert browser.run("return document.documentElement.scrollWidth") <= width
    small = """return [...document.querySelectorAll('#buttons button, #zoom button, header button')].filter(e =>
        e.getBoundingClientRect().width < 30 || e.getBoundingClientRect().height < 30).map(e => e.id)"""
    assert browser.run(small) == []


def test_a_page_talks_to_nobody(browser, page):
    browser.open(page)
    assert browser.run("return performance.getEntriesByType('resource').length") == 0
    refused = "const done = arguments[0]; fetch('http://127.0.0.1:9/').then(() => done(false), () => done(true))"
    assert browser.driver.execute_async_script(refused)
    assert any("Content Security Policy" in each for each in browser.complaints())


def test_a_page_that_cannot_be_read_says_so(browser, page, tmp_path):
    text = page.read_text().replace('"format":1,', '"format":9,')
    broken = tmp_path / "broken.html"
    broken.write_text(text)
    browser.open(broken)
    assert "format 1, not 9" in browser.text("failed")
    assert browser.complaints()
