"""The page as a file: what it holds, how large it is, and that it is nothing but words where words are meant."""

import base64
import html.parser
import json
import re
import shutil
import subprocess
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import render
import tiswarm
from render.page.document import LIVE, REPLAY, joined
from render.page.pack import packed
from tiswarm.records.recording import Swarm

FOLDER = Path(render.__file__).parent / "page"
CHECKS = Path(__file__).parent / "javascript"


def section(header: dict, numbers: str, name: str) -> np.ndarray:
    """Read a section as docs/page.md describes it, not as the page's own code does."""
    told, raw = header["sections"][name], zlib.decompress(base64.b64decode(numbers))
    width, count = told["bits"] // 8, int(np.prod(told["shape"]))
    planes = np.frombuffer(raw, np.uint8, width * count, told["at"]).reshape(width, count)
    folded = sum(planes[n].astype(np.int64) << (8 * n) for n in range(width))
    whole = ((folded >> 1) ^ -(folded & 1)).reshape(told["shape"])
    for _ in range(told["order"]):
        whole = whole.cumsum(axis=0)
    whole %= 1 << told["bits"]
    if told["kind"] == "codes":
        return whole - 1
    if told["kind"] == "float":
        return whole.astype(np.uint32).view(np.float32)
    return np.array(told["low"]) + np.array(told["step"]) * whole


def unpacked(recording, **how):
    header, numbers = packed(recording, **how)
    return header, lambda name: section(header, numbers, name)


@pytest.mark.parametrize("dim", [2, 3])
def test_places_are_exact_to_16_bits_over_the_world(make, dim):
    recording = make(dim=dim, ticks=40, prey_ends={0: (3, "captured"), 1: (30, "crashed")})
    if dim == 3:
        recording = replace(recording, scenario=tiswarm.load("lookout/aquarium"), obstacle_position=np.zeros((2, 3)))
    header, read = unpacked(recording)
    for kind in ("prey", "predators"):
        swarm = getattr(recording, kind)
        there = swarm.alive
        steps = np.array(header["sections"][f"{kind}.position"]["step"])
        assert (steps <= 200 / 65_000).all()
        assert (np.abs(read(f"{kind}.position") - swarm.position)[there] <= 0.51 * steps).all()
        steps = np.array(header["sections"][f"{kind}.velocity"]["step"])
        assert (np.abs(read(f"{kind}.velocity") - swarm.velocity)[there] <= 0.51 * steps).all()
        assert (read(f"{kind}.group") == swarm.group).all()
        names = np.array(header[kind]["states"])
        assert (names[read(f"{kind}.state").astype(int)] == swarm.state).all()
    assert header["prey"]["end"][:3] == [3, 30, None]
    assert header["prey"]["fate"][:3] == [2, 3, 0]


def test_exact_means_float32(make):
    recording = make(ticks=40)
    _, read = unpacked(recording, exact=True)
    assert (read("prey.position") == recording.prey.position.astype(np.float32)).all()
    assert (read("predators.velocity") == recording.predators.velocity.astype(np.float32)).all()


def test_terms_and_measures_are_kept(make):
    recording = make(ticks=10)
    pull = np.linspace(-1, 1, recording.prey.velocity.size).reshape(recording.prey.velocity.shape)
    recording = replace(recording, prey=replace(recording.prey, terms={"goal": pull}))
    header, read = unpacked(recording)
    assert header["prey"]["terms"] == ["goal"]
    assert np.allclose(read("prey.terms.goal"), pull, atol=2 / 65_000)
    from tiswarm.measures import recorded

    assert set(header["measures"]) == {"polarisation", "nearest", "kinetic", "potential"}
    for name in header["measures"]:
        assert np.allclose(read(f"measure.{name}")[:, 0], getattr(recorded, name)(recording), rtol=1e-6, equal_nan=True)


def test_nobody_at_all_and_no_time_at_all_are_pages_too(make, tmp_path):
    for recording in (make(predators=0), make(ticks=0), make(prey_ends=dict.fromkeys(range(6), (0, "crashed")))):
        assert render.replay(recording, tmp_path / "few.html").stat().st_size > 0


def test_a_delft_trial_fits_into_a_mail(f32, tmp_path):
    recording = tiswarm.record(tiswarm.load("delft/pronav-10", {"prey.strategy": "split-evasive"}), trial=3)
    assert render.replay(recording, tmp_path / "trial.html").stat().st_size <= 250_000
    assert render.replay(recording, tmp_path / "exact.html", exact=True).stat().st_size <= 400_000


def test_a_thousand_agents_for_600_ticks_take_six_megabytes_at_most(make, tmp_path):
    rng = np.random.default_rng(1)
    small = make(predators=0, ticks=600)
    turn = rng.uniform(-0.3, 0.3, (601, 1000)).cumsum(axis=0)
    velocity = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    position = rng.uniform(0, 50, (1, 1000, 2)) + velocity.cumsum(axis=0)
    still = np.full((601, 1000), "calm"), np.full((601, 1000), -1, np.int32)
    large = replace(small, prey=Swarm(position, velocity, np.full(1000, "alive"), *still))
    assert render.replay(large, tmp_path / "large.html").stat().st_size <= 6_000_000


class Outline(html.parser.HTMLParser):
    """Notes what a browser would take for markup."""

    def __init__(self, text: str):
        super().__init__()
        self.tags: list[tuple[str, dict]] = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))


def test_hostile_names_add_no_markup(make, tmp_path):
    nasty = "</script><script>alert(1)</script><!-- ]]> \"' onload=x <style> \u2028 <!--SCRIPT--> <!--RECORDINGS-->"
    plain = Outline(render.replay(make(), tmp_path / "plain.html").read_text(encoding="utf-8"))
    words = {"title": nasty, "source": nasty, "world.areas": [{"label": nasty, "region": [[0, 0], [70, 50]]}]}
    recording = replace(make(), scenario=tiswarm.load("delft/pronav-10", words))
    path = render.replay(recording, tmp_path / "nasty.html", labels=[nasty], title=nasty)
    text = path.read_text(encoding="utf-8")
    assert Outline(text).tags[6:] == plain.tags[6:]
    assert [tag for tag, _ in Outline(text).tags] == [tag for tag, _ in plain.tags]
    held = re.search(r'class="header">(.*?)</script>', text)[1]
    assert json.loads(held)["title"] == nasty


def test_the_policy_names_the_page_s_own_script_and_nothing_else(make, tmp_path):
    text = render.replay(make(), tmp_path / "page.html").read_text(encoding="utf-8")
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe" not in policy
    assert "http" not in policy
    assert not re.search(r'\b(src|href)="(?!#)', text)


def test_every_module_is_in_the_page_behind_those_that_it_needs():
    assert {*REPLAY, *LIVE} == {file.stem for file in FOLDER.glob("*.js")}
    for modules in (REPLAY, LIVE):
        seen: set[str] = set()
        for name in modules:
            needed = set(re.findall(r'^import .* from "\./(\w+)\.js";$', (FOLDER / f"{name}.js").read_text(), re.MULTILINE))
            assert needed <= seen, name
            seen.add(name)
        assert not re.search(r"^(import|export) ", joined(modules), re.MULTILINE)


def test_modules_are_short():
    for file in FOLDER.glob("*.js"):
        assert len(file.read_text().splitlines()) < 300, file


def test_wrong_input_is_told(make, tmp_path):
    with pytest.raises(ValueError, match="no recording given"):
        render.replay([], tmp_path / "none.html")
    with pytest.raises(ValueError, match="5 recordings are too many"):
        render.replay([make(ticks=1)] * 5, tmp_path / "many.html")
    with pytest.raises(ValueError, match="some recordings are flat"):
        render.replay([make(ticks=1), make(ticks=1, dim=3)], tmp_path / "mixed.html")
    assert not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def checks(tmp_path_factory):
    """A folder with the modules and, from npm, what checks them."""
    if shutil.which("npm") is None:
        pytest.skip("npm is not installed: the page's JavaScript is not checked")
    folder = tmp_path_factory.mktemp("javascript")
    shutil.copytree(CHECKS, folder, dirs_exist_ok=True)
    shutil.copytree(FOLDER, folder / "page", ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    command = ["npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"npm cannot install what checks the page's JavaScript: {done.stderr.strip()[-300:]}")
    return folder


@pytest.mark.parametrize("command", [["tsc", "--project", "."], ["eslint", "page"]])
def test_the_javascript_is_typed_and_clean(checks, command):
    program = checks / "node_modules" / ".bin" / command[0]
    done = subprocess.run([program, *command[1:]], cwd=checks, capture_output=True, check=False)
    assert done.returncode == 0, done.stdout.decode()
