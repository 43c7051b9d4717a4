"""The page in a real browser."""

import re
from dataclasses import replace

import browser as browsers
import numpy as np
import pytest

import render
import tiswarm
from render.scene.trajectories import Trajectories
from render.theme import DARK, LIGHT

NASTY = "<script>window.hacked = 1</script><img src=x onerror=hacked=1>\"' &amp; </script> \u202eאבג " + "x" * 5000


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    window = browsers.started(tmp_path_factory.mktemp("profile"))
    yield window
    window.driver.quit()


@pytest.fixture(autouse=True)
def _calm_reader(browser):
    """Pages start still, and whatever a test does they have nothing to complain of."""
    browser.look()
    yield
    assert browser.complaints() == []


@pytest.fixture(scope="module")
def calm(make):
    """Agents that keep their colours: nobody is alarmed."""
    return make(state="calm", ticks=20)


@pytest.fixture(scope="module")
def page(calm, tmp_path_factory):
    return render.replay(calm, tmp_path_factory.mktemp("page") / "calm.html")


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


@pytest.fixture(scope="module")
def deep(make):
    """Make recordings of a 3-D world."""

    def recording(**how):
        scenario, where = tiswarm.load("lookout/aquarium"), np.array([[30.0, 20.0, 5.0], [45.0, 40.0, 9.0]])
        return replace(make(dim=3, **how), scenario=scenario, obstacle_position=where)

    return recording


def shade(code: str) -> np.ndarray:
    return np.array([int(code[n : n + 2], 16) for n in (1, 3, 5)])


def pixels(window, spots: np.ndarray, scene: int = 0) -> np.ndarray:
    """Map metres to pixels of the stage by what the camera says of itself: [point, 2]."""
    script = "const {middle, centre, scale} = tiswarm.stage.scenes[arguments[0]].lens; return [middle, centre, scale]"
    middle, centre, scale = window.run(script, scene)
    return np.array(middle) + (spots - centre) * np.array([scale, -scale])


def assert_agents(window, recording, tick: int, theme) -> None:
    """Check that each agent's colour is where the recording says, and not where it says for another tick."""
    picture = window.picture()
    hues = [shade(theme.prey[group]) for group in recording.prey.group[tick]]
    for place, hue in zip(recording.prey.position[tick], hues, strict=True):
        x, y = np.round(pixels(window, place)).astype(int)
        assert np.abs(picture[y, x] - hue).max() <= 12, (tick, x, y)
    for place in recording.predators.position[tick]:
        x, y = np.round(pixels(window, place)).astype(int)
        assert np.abs(picture[y, x] - shade(theme.predator)).max() <= 12, (tick, x, y)


@pytest.mark.parametrize("webgl", [True, False])
@pytest.mark.parametrize("theme", ["dark", "light"])
def test_agents_are_where_the_recording_says(browser, page, calm, theme, webgl):
    browser.look(theme=theme, webgl=webgl)
    browser.open(page)
    assert browser.run("return tiswarm.stage.painter.name") == ("WebGL" if webgl else "canvas")
    for tick in (0, 7, 20):
        script = "const s = document.getElementById('scrub'); s.value = arguments[0]; s.dispatchEvent(new Event('input'))"
        browser.run(script, tick)
        assert_agents(browser, calm, tick, {"dark": DARK, "light": LIGHT}[theme])


def test_a_moved_camera_shows_the_same(browser, page, calm):
    browser.open(page, "#tick=5")
    browser.press("+", "+")
    browser.run("tiswarm.stage.drag(-60, 40)")
    inside = pixels(browser, calm.prey.position[5])
    size = browser.run("const c = document.getElementById('stage'); return [c.width, c.height]")
    seen = calm.prey.position[5][((inside > 20) & (inside < np.array(size) - 20)).all(axis=1)]
    assert len(seen)
    picture = browser.picture()
    for x, y in np.round(pixels(browser, seen)).astype(int):
        nearest = min(np.abs(picture[y, x] - shade(hue)).max() for hue in DARK.prey)
        assert nearest <= 12


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


@pytest.mark.parametrize("dim", [2, 3])
def test_agents_go_the_way_that_films_show(browser, make, deep, tmp_path, dim):
    recording = (make if dim == 2 else deep)(
        prey_ends={0: (3, "captured"), 1: (4, "crashed"), 2: (5, "arrived")}, predator_ends={0: (3, "captured")}
    )
    browser.open(render.replay(recording, tmp_path / "chase.html", exact=True))
    paths = Trajectories([recording])
    for time in (0, 0.25, 2.5, 2.99, 3.5, 4.75, 8, 9):
        script = "const {paths} = tiswarm.stage.scenes[0]; paths.load(arguments[0]); return [[...paths.spot], [...paths.slope]]"
        spots, slopes = (np.reshape(each, (-1, dim)) for each in browser.run(script, time))
        assert np.allclose(spots, paths.spots(time), atol=1e-4), time
        going = np.flatnonzero(time < paths.end)
        assert np.allclose(slopes[going], paths.speeds(time, going), atol=1e-4), time


def test_events_are_counted_and_marked(browser, chase, tmp_path):
    browser.open(render.replay(chase, tmp_path / "chase.html"), "#tick=8")
    browser.drawn()
    said = browser.text("counts")
    assert said == "3 alive1 arrived1 captured1 crashed"
    inked = """const c = document.getElementById('marks');
        const p = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
        const columns = []; for (let x = 0; x < c.width; x++) { let any = 0;
        for (let y = 0; y < c.height; y++) any += p[(y * c.width + x) * 4 + 3]; columns.push(any > 0); }
        return columns"""
    columns = np.array(browser.run(inked))
    starts = np.flatnonzero(columns & ~np.roll(columns, 1))
    assert len(starts) == 3
    assert np.allclose((starts + 3) / len(columns), np.array([3, 4, 5]) / 8, atol=0.02)


def test_recordings_are_compared_under_one_clock(browser, make, tmp_path):
    one, other = make(ticks=8, state="calm"), make(ticks=12, prey=4, state="calm")
    path = render.replay([one, other], tmp_path / "two.html", labels=["evasive", "split"])
    browser.open(path, "#tick=6")
    assert_agents_of_both(browser, (one, other))
    labels = browser.run("return [...document.querySelectorAll('#labels .scene')].map(e => e.textContent)")
    assert labels == ["evasive", "split"]
    assert browser.find("scrub").get_attribute("max") == "12"
    assert "6 | 4 alive" in browser.text("counts")


def assert_agents_of_both(window, recordings) -> None:
    picture = window.picture()
    for scene, recording in enumerate(recordings):
        for x, y in np.round(pixels(window, recording.predators.position[6], scene)).astype(int):
            assert np.abs(picture[y, x] - shade(DARK.predator)).max() <= 12


def test_a_gallery_opens_what_is_clicked(browser, make, deep, tmp_path):
    path = render.replay([make(trial=1), make(trial=2), deep()], tmp_path / "all.html", gallery=True, labels=["a", "b", "c"])
    browser.open(path)
    said = browser.run("return [...document.querySelectorAll('#gallery a')].map(e => e.innerText)")
    assert [each.split("\n")[0] for each in said] == ["a", "b", "c"]
    assert "6 alive · 8 ticks" in said[0]
    browser.run("document.querySelectorAll('#gallery a')[1].click()")
    browser.until("return globalThis.tiswarm && document.body.dataset.ready === 'true'")
    assert "trial 2" in browser.text("subtitle")
    assert browser.find("overview").is_displayed()


def test_a_deep_world_turns_by_drag(browser, deep, tmp_path):
    browser.open(render.replay(deep(), tmp_path / "deep.html"), "#tick=3")
    before = browser.picture()
    browser.run("tiswarm.stage.drag(200, 60)")
    assert np.abs(browser.picture() - before).max(axis=2).mean() > 1


def test_a_periodic_world_has_no_streaks(browser, make, tmp_path):
    recording = make(state="calm", predators=0, ticks=10)
    around = {"world.boundary": "periodic", "world.areas": [], "target.present": False, "obstacles.count": 0}
    scenario = tiswarm.load("delft/pronav-10", {**around, "predators.spawn.region": [[0, 0], [9, 9]]})
    size = np.array(scenario.world.size)
    begin = np.mod(recording.prey.position[0] + [45.0, 0.0], size)
    line = np.mod(begin - np.arange(11)[:, None, None] * [8.0, 0.0], size)
    assert (np.abs(np.diff(line[..., 0], axis=0)) > 50).any()
    velocity = np.broadcast_to([-8.0, 0.0], line.shape).copy()
    swarm = replace(recording.prey, position=line, velocity=velocity)
    bare = replace(recording, scenario=scenario, prey=swarm, obstacle_position=np.zeros((0, 2)), obstacle_radius=np.zeros(0))
    browser.open(render.replay(bare, tmp_path / "round.html"), "#tick=3")
    with_trails = browser.picture()
    browser.run("document.getElementById('switch-trails').click()")
    changed = np.abs(browser.picture() - with_trails).max(axis=2) > 8
    trails = np.argwhere(changed)[:, ::-1]
    assert len(trails) > 100
    # Where a trail may be: the way that each agent has come, on either side of the edge.
    shares = np.linspace(0, 1, 60)[:, None]
    way = line[0] - np.concatenate([shares * 24.0, shares * 0.0], axis=1)[:, None]
    allowed = pixels(browser, np.mod(way, size).reshape(-1, 2))
    gaps = np.sqrt(((trails[:, None, :] - allowed[None]) ** 2).sum(axis=2)).min(axis=1)
    assert gaps.max() < 16


def test_the_camera_goes_with_prey_that_leave_an_open_sky(browser, make, tmp_path):
    bare = {"world.areas": [], "target.present": False, "obstacles.count": 0}
    recording = make(state="calm", predators=0, ticks=20)
    far = recording.prey.position + np.arange(21)[:, None, None] * [-30.0, 12.0]
    swarm = replace(recording.prey, position=far, velocity=recording.prey.velocity + np.array([-30.0, 12.0]))
    scenario = tiswarm.load("delft/pronav-10", bare)
    gone = replace(recording, scenario=scenario, prey=swarm, obstacle_position=np.zeros((0, 2)), obstacle_radius=np.zeros(0))
    browser.open(render.replay(gone, tmp_path / "gone.html"), "#tick=20")
    assert_agents(browser, gone, 20, DARK)
    middle = browser.run("return tiswarm.stage.scenes[0].lens.centre")
    assert np.allclose(middle, far[20].mean(axis=0), atol=0.1)
    browser.run("tiswarm.stage.drag(50, 0); tiswarm.clock.seek(0)")
    browser.drawn()
    assert browser.run("return tiswarm.stage.scenes[0].lens.centre")[0] < middle[0]


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
