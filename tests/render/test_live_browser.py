"""A live page in a real browser: what is turned there reaches the simulation, and what runs there reaches the page."""

import os
import signal
import subprocess
import time

import numpy as np
import pytest
from browser import pixels, shade, started
from live_server import CHEAP, Live

NASTY = "<script>window.hacked = 1</script><img src=x onerror=hacked=1>\"' &amp; \u202eאבג " + "x" * 300
SLIDE = """const s = document.getElementById('knob-' + arguments[0]); s.value = arguments[1];
    s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change'))"""

TRIED = """return tiswarm.page.settled === tiswarm.page.serial
    && document.getElementById('outcomes-state').textContent.startsWith('1,000 trials')"""


@pytest.fixture(scope="module")
def live(tmp_path_factory):
    preset = tmp_path_factory.mktemp("live") / "nasty.toml"
    title = NASTY.replace("\\", "").replace('"', '\\"')
    preset.write_text(f'base = "delft/pronav-10"\ntitle = "{title}"\n', encoding="utf-8")
    server = Live(str(preset), sets=(*CHEAP, "world.ticks=400"))
    yield server
    if server.process.poll() is None:
        server.interrupt()


@pytest.fixture
def page(browser, live):
    """A page whose simulation stands still at the start of trial 0, seed 1."""
    browser.visit(live.address)
    browser.run("tiswarm.clock.pause(); tiswarm.page.wire.send({act: 'restart', seed: 1})")
    browser.until("return tiswarm.page.header.seed === 1 && tiswarm.scene().ticks === 0 && !tiswarm.clock.playing")
    return browser


def test_a_slider_moves_a_weight_of_the_simulation(page):
    now, before = (
        f"return [...document.querySelectorAll('#outcomes td:nth-child({k})')].map(e => e.textContent)" for k in (2, 3)
    )
    page.until(TRIED)
    page.run(SLIDE, "prey.goal", 0.3)
    page.until("return tiswarm.page.values['prey.goal'] === 0.3 && tiswarm.page.heard >= tiswarm.page.serial")
    assert "prey.goal=0.3" in page.run("return document.getElementById('command').value")
    page.until(TRIED)
    told = page.run(now)
    page.run(SLIDE, "prey.goal", 0.1)
    page.until("return tiswarm.page.values['prey.goal'] === 0.1")
    page.until(TRIED)
    assert page.run(before) == told != page.run(now)
    serial = page.run("return tiswarm.page.serial")
    page.run("document.getElementById('again').click()")  # the same trials once more: nothing new to compare
    page.until("return tiswarm.page.serial > arguments[0]", serial)
    page.until(TRIED)
    assert page.run(before) == told


def test_what_the_page_draws_is_what_the_simulation_sent(page):
    from render.theme import DARK

    page.run("tiswarm.clock.step(1)")
    page.until("return tiswarm.scene().ticks === 1")
    page.run("document.getElementById('switch-trails').click()")
    picture = page.picture()
    spots = page.run("const r = tiswarm.scene(); return [...r.position.slice(r.ticks * r.count * 2)].slice(0, r.count * 2)")
    places = np.round(pixels(page, np.reshape(spots, (-1, 2))[6:])).astype(int)
    there = [np.abs(picture[y, x] - shade(DARK.predator)).max() <= 12 for x, y in places]
    assert sum(there) >= 10  # of fifteen, some of which hide behind others
    page.run("document.getElementById('switch-trails').click()")


def at_rest(page):
    """The tick that is shown once those that were under way when somebody paused have come: each of them ends a look back."""
    page.until("return tiswarm.clock.shown === tiswarm.scene().when[tiswarm.scene().ticks]")
    shown, now = None, page.run("return tiswarm.clock.shown")
    while now != shown:
        time.sleep(0.5)
        shown, now = now, page.run("return tiswarm.clock.shown")
    return now


def test_it_plays_pauses_steps_and_looks_back(page):
    page.press(" ")
    page.until("return tiswarm.scene().ticks > 4 && tiswarm.clock.shown > 2")
    page.press("t", "t")
    page.drawn()
    assert page.run("return tiswarm.clock.playing")  # dark or light stops nothing
    page.press(" ")
    page.until("return tiswarm.page.state.playing === false")
    here = at_rest(page)
    page.run("tiswarm.clock.step(-2)")
    page.until("return tiswarm.clock.shown === arguments[0] - 2", here)
    page.run("tiswarm.clock.step(2); tiswarm.clock.step(1)")
    page.until("return tiswarm.clock.shown === arguments[0] + 1", here)
    page.run("document.getElementById('afresh').click()")
    page.until("return tiswarm.page.header.seed !== 1 && tiswarm.scene().ticks === 0")
    assert f"seed {page.run('return tiswarm.page.header.seed')}" in page.text("subtitle")


def test_a_click_drops_an_obstacle_and_the_target_is_dragged(page):
    before = page.run("return tiswarm.scene().header.obstacles.length")
    page.run("document.getElementById('drop-obstacle').click()")
    page.click(*pixels(page, np.array([50.0, 20.0])))
    page.until("return tiswarm.scene().header.obstacles.length === arguments[0] + 1", before)
    where = page.run("return tiswarm.scene().header.obstacles.at(-1)")
    assert np.allclose(where[:2], [50, 20], atol=0.2)
    page.run("document.getElementById('drop-obstacle').click()")
    page.drag(pixels(page, np.array([10.0, 25.0])), pixels(page, np.array([30.0, 40.0])))
    moved = "return Math.abs(tiswarm.page.values['target.position.' + arguments[0]] - arguments[1]) < 0.3"
    page.until(moved, 0, 30)
    page.until(moved, 1, 40)
    for axis, value in enumerate((10, 25)):
        page.run(SLIDE, f"target.position.{axis}", value)


def test_a_menu_compiles_another_strategy_and_shows_its_weights(page):
    menu = (
        "const m = document.getElementById('knob-prey.strategy'); m.value = arguments[0]; m.dispatchEvent(new Event('change'))"
    )
    page.run(menu, "evasive")
    page.until("return document.getElementById('building').textContent.includes('Compiling prey.strategy=evasive')")
    page.until("return tiswarm.page.header.prey.strategy === 'evasive'", seconds=60)
    assert page.find("building").is_displayed() is False
    assert "evasive: strength" in page.text("said-prey.weights.evade")
    assert page.run("return document.getElementById('knob-prey.weights.evade').max") == "0.04"
    page.run(menu, "baseline")
    page.until("return tiswarm.page.header.prey.strategy === 'baseline'", seconds=60)


def test_names_are_words_and_nothing_else_runs(page):
    assert page.text("title").startswith("<script>window.hacked")
    assert page.run("return window.hacked ?? null") is None
    assert page.run("return document.images.length") == 0


@pytest.mark.parametrize("width", [360, 1280, 2560])
def test_nothing_sticks_out_and_everything_has_a_name(page, width):
    page.look(width, 900)
    page.drawn()
    assert page.run("return document.documentElement.scrollWidth") <= width
    nameless = """return [...document.querySelectorAll('button, input, select, textarea, canvas, aside')].filter(e =>
        !e.closest('[hidden]') && e.getAttribute('aria-hidden') !== 'true' && !e.getAttribute('aria-label')
        && !e.textContent.trim() && !e.closest('label') && !(e.labels ?? []).length).map(e => e.outerHTML)"""
    assert page.run(nameless) == []


def test_an_address_without_the_token_is_refused_and_a_killed_browser_harms_nobody(page, live, tmp_path):
    page.driver.get(f"http://127.0.0.1:{live.port}/wrong/")
    assert "open the address" in page.run("return document.body.textContent")
    page.complaints()  # of the refusal
    page.visit(live.address)
    other = started(tmp_path)
    other.visit(live.address)
    page.run("tiswarm.clock.play()")
    page.until("return tiswarm.page.state.playing")
    driver = other.driver.service.process.pid
    listed = subprocess.run(["ps", "-o", "pid=", "--ppid", str(driver)], capture_output=True, text=True, check=True)
    for pid in map(int, listed.stdout.split()):
        os.kill(pid, signal.SIGKILL)
    other.driver.service.stop()
    tick = page.run("return tiswarm.clock.shown + 1000 * tiswarm.page.header.scene")
    page.until("return tiswarm.clock.shown + 1000 * tiswarm.page.header.scene > arguments[0] + 5", tick)
    assert live.process.poll() is None


def test_a_large_swarm_is_a_cloud_where_its_agents_are(browser):
    region = "[[10, 10], [30, 30]]"
    alone = ("prey.count=4000", "predators.count=0", "obstacles.count=0", f"prey.spawn.region={region}", "prey.avoidance=none")
    server = Live("delft/avoidance-10", sets=alone)
    try:
        browser.visit(server.address)
        browser.run("tiswarm.clock.pause(); tiswarm.page.wire.send({act: 'restart', seed: 1})")
        browser.until("return tiswarm.page.header.seed === 1 && tiswarm.scene().ticks === 0")
        assert browser.text("counts").startswith("4000 alive")
        assert "4,000 prey" in browser.text("who")
        picture = browser.picture()
        inside, outside = (pixels(browser, np.array(each)) for each in ([20.0, 32.0 - 12], [60.0, 40.0]))
        bright = [picture[round(y), round(x)].sum() for x, y in (inside, outside)]
        assert bright[0] > bright[1] + 150
        assert "take too long" in browser.text("outcomes-state")
    finally:
        browser.driver.get("about:blank")  # else it asks the server that ends once more, and complains
        assert server.interrupt() == (0, "")
