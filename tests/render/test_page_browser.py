"""The page in a real browser: what it shows."""

from dataclasses import replace

import numpy as np
import pytest
from browser import assert_agents, pixels, shade
from handmade import path, world

import render
import tiswarm
from render.scene.trajectories import Trajectories
from render.theme import DARK, LIGHT


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


def test_crowds_go_on_beyond_a_periodic_edge(browser, tmp_path):
    """Of 2 000 agents all is drawn nine times, of one more only what is near an edge: the picture is the same."""
    columns, rows = np.meshgrid(np.arange(50), np.arange(40))
    places = np.stack([0.8 * columns + 0.01, 0.5 * rows + 0.01], axis=-1).reshape(-1, 2)  # 2 000, the first ones on an edge
    pictures = []
    for crowd in (places, np.concatenate([places, places[-1:]])):
        shown = world(
            path(np.stack([crowd, crowd]), np.array([0.8, 0.3])), **{"world.boundary": "periodic", "prey.radius": 0.02}
        )
        browser.open(render.replay(shown, tmp_path / f"{len(crowd)}.html", exact=True), "#tick=0")
        pictures.append(browser.picture())
    (x, y), (east, _) = pixels(browser, np.array([places[-1], [39.97, 10.0]])).round().astype(int)
    assert (pictures[0][:, east - 3 : east] != pictures[0][5, 5]).any()
    changed = (
        np.abs(pictures[0] - pictures[1]).max(axis=2) > 24
    )  # the world's frame is drawn over itself, and a little brighter
    changed[y - 12 : y + 12, x - 12 : x + 12] = False  # two of them lie there
    assert not changed.any()


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
