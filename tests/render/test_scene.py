"""Every kind of recording and every choice of look can be drawn, and shows what it should."""

import hashlib
import subprocess
import sys

import numpy as np
import pytest

import render
import tiswarm
from render.captions.strip import Strip
from render.composition import Composition
from render.raster.canvas import Canvas
from render.raster.glyphs import Atlas
from render.raster.shapes import NONE, colour, encoded
from render.scene.camera import Camera
from render.scene.snapshot import now
from render.style import Look

SIZE = (480, 270)


def picture(subject, time: float, size=SIZE, **look) -> np.ndarray:
    stage = Composition(subject, size, Look(**look), yuv=False)
    return stage.frame(time, stage.canvas.blank()).reshape(size[1], size[0], 3)


def paint_near(image: np.ndarray, code: str, tolerance: int = 40) -> int:
    """Count the pixels close to a colour."""
    wanted = encoded(colour(code)) * 255
    return int((np.abs(image.astype(int) - wanted).max(axis=2) < tolerance).sum())


def test_prey_predators_and_target_are_there_to_see(make):
    image = picture(make(state="calm"), 2.5)
    theme = render.THEMES["dark"]
    for code in (theme.prey[0], theme.predator, theme.target):
        assert paint_near(image, code) > 10


def test_agents_never_are_smaller_than_five_pixels(make):
    recording = make(prey=1, predators=0, state="calm")
    far = ((-2000.0, -1000.0), (2100.0, 1050.0))
    with_prey = picture(recording, 0.0, size=(192, 192), camera=far, trail=0)
    without = picture(
        make(prey=1, predators=0, ticks=8, prey_ends={0: (1, "arrived")}), 8.0 + 30, size=(192, 192), camera=far, trail=0
    )
    rows, columns = (np.abs(with_prey.astype(int) - without).max(axis=2) > 20).nonzero()
    assert np.ptp(rows) + 1 >= 5
    assert np.ptp(columns) + 1 >= 5


@pytest.mark.parametrize(
    "how",
    [
        {"predators": 0},
        {"prey": 1, "predators": 0},
        {"prey": 1, "predators": 1},
        {"ticks": 0},
        {"ticks": 1},
        {"ticks": 3, "prey_ends": dict.fromkeys(range(6), (3, "captured"))},
        {"prey_ends": dict.fromkeys(range(6), (3, "crashed")), "predator_ends": dict.fromkeys(range(5), (2, "crashed"))},
        {"prey": 40, "predators": 60},
        {"dim": 3},
        {"dim": 3, "prey_ends": dict.fromkeys(range(6), (3, "captured")), "predator_ends": {0: (3, "captured")}},
        {"state": "exploding"},
        {"state": "jumped"},
    ],
)
def test_every_kind_of_recording_can_be_drawn(make, how):
    recording = make(**how)
    for time in (0.0, 2.9, 3.0, 3.1, recording.ticks, recording.ticks + 9.9):
        assert len(np.unique(picture(recording, time))) > 20


@pytest.mark.parametrize("size", [(64, 64), (16, 16), (480, 480), (270, 480), (200, 1600), (1600, 200), (3840, 2160)])
def test_every_size_can_be_drawn(chase, size):
    assert len(np.unique(picture(chase, 4.5, size=size))) > 5


@pytest.mark.parametrize(
    "look",
    [
        *({"overlay": (name,)} for name in render.OVERLAYS),
        {"overlay": render.OVERLAYS},
        {"camera": "follow"},
        {"camera": "follow:8"},
        {"label": (3, 7)},
        {"camera": "orbit"},
        {"camera": ((20.0, 10.0), (50.0, 40.0))},
        {"trail": 0},
        {"trail": 100},
        {"speed": 0.5},
        {"theme": "light"},
        {"theme": "print"},
    ],
)
def test_every_look_changes_the_picture(chase, look):
    assert (picture(chase, 4.5, **look) != picture(chase, 4.5)).any()


def test_nothing_that_moves_is_drawn_on_the_panel(make):
    stage = Composition(make(prey=30, predators=30, ticks=100), SIZE, Look(), yuv=False)
    box = stage.boxes[0]
    panel = np.ones((270, 480), bool)
    panel[int(box.top) : int(np.ceil(box.bottom)), int(box.left) : int(np.ceil(box.right))] = False
    assert panel.mean() > 0.15
    stage.caption = None
    ground = stage.canvas.draw(NONE, None, stage.canvas.blank()).reshape(270, 480, 3)
    for time in (0.0, 50.5, 99.0):
        frame = stage.frame(time, stage.canvas.blank()).reshape(270, 480, 3)
        assert (frame[panel] == ground[panel]).all()


def test_several_recordings_are_named_by_what_differs(make):
    from render.captions.mosaic import labels_of
    from render.language import language_named

    assert labels_of([make(trial=n) for n in (2, 5)], language_named("en")) == ["trial 2", "trial 5"]
    ways = [make(), make()]
    other = tiswarm.load("delft/pronav-10", {"prey.strategy": "split"})
    object.__setattr__(ways[1], "scenario", other)
    assert labels_of(ways, language_named("en")) == ["baseline", "split"]


@pytest.mark.parametrize("count", [1, 2, 3, 16])
def test_several_recordings_stand_side_by_side(make, count):
    subjects = [make(trial=n, ticks=4 + n) for n in range(count)]
    assert len(np.unique(picture(subjects, 4.5))) > 20
    stage = Composition(subjects, SIZE, Look(), yuv=False)
    assert list(stage.times(10))[-1] >= 4 + count - 1


def test_who_is_followed_or_labelled_is_marked_until_it_is_gone(chase):
    """Agent 0 is captured at tick 3."""
    for look in ({"label": (0,)}, {"camera": "follow:0"}):
        scene = Composition(chase, SIZE, Look(**look), yuv=False).scene
        here = [len(scene._chosen(*_looked(scene, time))) for time in (2.0, 5.0)]
        assert here == [1, 0], look
    with pytest.raises(ValueError, match="label: no agent 11; use 0 to 10"):
        Composition(chase, SIZE, Look(label=(11,)), yuv=False)


def _looked(scene, time):
    here = now(scene.paths, time, Camera(np.array([50.0, 25.0]), np.array([240.0, 135.0]), 4.0), None, scene._lone)
    return here, np.full(len(here.who), 5.0)


def test_no_recording_is_refused():
    with pytest.raises(ValueError, match="give one or more"):
        Composition([], SIZE, Look(), yuv=False)


def test_frames_do_not_depend_on_the_number_of_threads(tmp_path):
    """Runs in processes of their own: one process has one number of threads."""
    program = (
        "import sys, hashlib, numpy as np, tiswarm\n"
        "tiswarm.init(threads=int(sys.argv[1]))\n"
        "from render.raster import shapes\n"
        "from render.raster.canvas import Canvas\n"
        "from render.raster.glyphs import Atlas\n"
        "atlas = Atlas()\n"
        "canvas = Canvas((400, 300), atlas, yuv=True)\n"
        "rng = np.random.default_rng(3)\n"
        "def some(n): return rng.uniform(0, 400, (n, 2))\n"
        "canvas.lay((0.01, 0.02, 0.03), shapes.discs(some(50), 30, (0.5, 0.2, 0.1), 0.5, soft=20))\n"
        "rows = [shapes.capsules(some(300), some(300), 3, 1, (0.2, 0.4, 0.9), 0.8, 0.1, group=np.arange(300) // 10 + 1),\n"
        "        shapes.darts(some(200), np.tile([0.6, 0.8], (200, 1)), 12, 7, 8, (0.9, 0.3, 0.1)),\n"
        "        atlas.line('the same at any number', (20, 200), 30, (1, 1, 1))]\n"
        "print(hashlib.sha256(canvas.draw(np.concatenate(rows), None, canvas.blank()).tobytes()).hexdigest())\n"
    )
    prints = [
        subprocess.run([sys.executable, "-c", program, threads], capture_output=True, text=True, check=True).stdout.split()[-1]
        for threads in ("1", "2")
    ]
    assert prints[0] == prints[1]


def test_the_same_frame_twice_is_the_same_bytes(chase):
    prints = {hashlib.sha256(picture(chase, 4.5).tobytes()).hexdigest() for _ in range(2)}
    assert len(prints) == 1


def test_importing_render_does_not_wait_for_taichi():
    program = "import sys, render; assert 'taichi' not in sys.modules"
    subprocess.run([sys.executable, "-c", program], check=True)


def test_a_canvas_of_another_size_stands_beside_the_first(make):
    for size in ((64, 48), (96, 64)):
        Canvas(size, Atlas(), yuv=True).lay((0, 0, 0), NONE)


@pytest.mark.parametrize("size", [(1920, 1080), (1280, 720), (854, 480), (480, 270)])
def test_a_wide_world_fills_a_wide_frame(make, size):
    """The caption stands below a world of 100 m x 50 m, which then takes most of the frame, and nobody is cut off."""
    stage = Composition(make(prey=4, predators=0), size, Look(), yuv=False)
    held, box = stage.rigs[0], stage.boxes[0]
    scale = held.at(0.0).scale
    assert box.width == size[0]
    assert 100 * scale * 50 * scale > 0.55 * size[0] * size[1]
    assert isinstance(stage.caption, Strip)


def test_whoever_leaves_the_world_stays_in_the_picture(make):
    stage = Composition(make(ticks=15, predators=12), (1280, 720), Look(), yuv=False)
    recording, held, box = stage.scene.subjects[0], stage.rigs[0], stage.boxes[0]
    spots = np.concatenate([held.at(0.0).place(each.position).reshape(-1, 2) for each in (recording.prey, recording.predators)])
    assert (spots > (box.left, box.top)).all()
    assert (spots < (box.right, box.bottom)).all()


def test_what_is_kept_between_frames_changes_no_picture(chase, make):
    """Trials end at different times; marks, trails and scenes that are over are drawn once and kept."""
    subjects = [chase, make(ticks=60)]
    stage = Composition(subjects, SIZE, Look(), yuv=False)
    for time in (3.5, 4.5, 55.0, 40.5, 58.5, 3.5):
        kept = stage.frame(time, stage.canvas.blank()).reshape(SIZE[1], SIZE[0], 3)
        assert (kept == picture(subjects, time)).all()


def test_ways_through_the_same_trial_are_told_apart_by_whom_they_kept(make):
    first, other = (
        make(prey_ends={0: (3, "captured"), 1: (6, "arrived")}),
        make(prey_ends={0: (6, "captured"), 1: (7, "crashed")}),
    )
    stage = Composition([first, other], (640, 240), Look(), yuv=False, labels=["a", "b"])
    caption = stage.caption
    told = []
    for time in (0.0, 4.0, 6.0, 8.0):
        stage.frame(time, stage.canvas.blank())
        told.append([caption._lead(n, time) for n in (0, 1)])
    assert told == [["", "±0"], ["", "+1"], ["", "±0"], ["", "\N{MINUS SIGN}1"]]
    apart = Composition([first, make(trial=9)], (640, 240), Look(), yuv=False).caption
    assert apart._lead(1, 8.0) == "", "other trials are no pairs"
