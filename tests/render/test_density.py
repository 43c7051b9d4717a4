"""Crowds too large to be drawn one by one: the cloud is where they are, and whoever is few stands above it."""

from dataclasses import replace

import numpy as np
import pytest

from render.composition import Composition
from render.raster import shapes
from render.raster.canvas import Canvas
from render.raster.glyphs import Atlas
from render.raster.shapes import colour
from render.scene import orbits, scene
from render.scene.cells import Cells
from render.scene.density import _counted
from render.scene.scale import STEPS, Scale, even, lab
from render.style import Look
from render.theme import THEMES
from tiswarm.records.recording import Recording

SIZE = (320, 180)


@pytest.fixture
def crowded(monkeypatch):
    """Let a hundred be a crowd."""
    monkeypatch.setattr(scene, "CROWDED", 100)


def flock(make, middle, dim=2, boundary="periodic", **how) -> Recording:
    """Record 400 prey around a point, and whoever else is asked for far from it."""
    recording = make(prey=400, dim=dim, ticks=2, **how)
    size = np.array((*recording.scenario.world.size[:2], 20.0))[:dim]
    world = recording.scenario.world.model_copy(update={"boundary": boundary, "size": tuple(size)})
    around = np.random.default_rng(2).normal(np.array(middle)[:dim], 3.0, (400, dim))
    spots = np.mod(around, size) if boundary == "periodic" else around
    prey = replace(recording.prey, position=np.repeat(spots[None], 3, axis=0), velocity=np.zeros((3, 400, dim)))
    bare = np.zeros((0, dim))
    scenario = recording.scenario.model_copy(update={"world": world})
    return replace(recording, scenario=scenario, prey=prey, obstacle_position=bare, obstacle_radius=np.zeros(0))


def picture(recording: Recording, time: float = 1.0, **look) -> tuple[Composition, np.ndarray]:
    stage = Composition(recording, SIZE, Look(**look), yuv=False)
    return stage, stage.frame(time, stage.canvas.blank()).reshape(SIZE[1], SIZE[0], 3).astype(int)


def test_agents_are_spread_but_none_is_lost():
    places = np.random.default_rng(1).uniform(0.2, 0.8, (500, 2))
    cells = np.array([40, 30])
    for mode in ("constant", "wrap", "symmetric"):
        counts = _counted(places, cells, mode)
        assert counts.shape == (32, 42)
        assert counts[1:-1, 1:-1].sum() == pytest.approx(500, rel=1e-5)
    assert _counted(np.array([[-0.1, 0.5], [0.5, 1.0], [np.nan, 0.5]]), cells, "constant").sum() == 0


def test_across_the_edge_of_a_periodic_world_crowds_go_on():
    cells = np.array([40, 30])
    places = np.random.default_rng(1).uniform(0, 1, (500, 2))
    counts, moved = (_counted(np.mod(places + shift, 1), cells, "wrap") for shift in (0, (0.25, 0.5)))
    assert np.allclose(np.roll(counts[1:-1, 1:-1], (15, 10), axis=(0, 1)), moved[1:-1, 1:-1], atol=1e-5)
    assert np.allclose(counts[:, 0], counts[:, 40])


@pytest.mark.parametrize("mode", ["constant", "wrap", "symmetric"])
def test_a_kernel_finds_the_steps_that_arithmetic_finds(mode):
    scale, cells = Scale(80.0, np.zeros((1, 4)), ""), Cells()
    for columns, rows in ((40, 30), (3, 57), (61, 2), (40, 30)):  # one after the other in the same memory
        low, far, size = np.array([-3.0, 2.0]), np.array([5.0, 8.0]), np.array([columns, rows])
        points = np.random.default_rng(rows).normal((1, 5), (3, 2), (700, 2))
        points[7] = np.nan
        density = _counted((points - low) / (far - low), size, mode) * np.float32(columns * rows / 48)
        steps = cells.steps(points, low, far, size, mode, columns * rows / 48, 80.0)
        assert (steps == scale.level(density)[::-1]).all()
        assert len(np.unique(steps)) > 20


def test_a_cloud_blends_between_its_texels():
    atlas = Atlas()
    canvas = Canvas((64, 48), atlas, yuv=False)
    atlas.take([np.array([0, 0, 1, 1] * 3, np.int32)], [np.array([[0] * 4, [1] * 4], np.float32)])  # a rim, two cells, a rim
    canvas.lay((0.0, 0.0, 0.0), shapes.cloud((12, 8), (52, 40), (2, 1), 0))
    light = canvas.light()[..., 0]
    assert not light[:8].any()
    assert not light[:, :12].any()
    assert not light[40:].any()
    assert not light[:, 52:].any()
    assert np.allclose(light[20, 22:42], (np.arange(20) + 0.5) / 20, atol=1e-5)
    assert np.allclose(light[8:40, 42:52], 1)


@pytest.mark.parametrize("boundary", ["open", "periodic", "walls"])
@pytest.mark.parametrize("dim", [2, 3])
def test_the_cloud_is_where_the_crowd_is(make, crowded, dim, boundary):
    stage, image = picture(flock(make, (30.0, 15.0, 10.0), dim, boundary, predators=0))
    camera = stage.rigs[0].at(1.0)
    x, y = camera.place(np.array([[30.0, 15.0, 10.0]])[:, :dim])[0].astype(int)
    far = camera.place(np.array([[80.0, 40.0, 10.0]])[:, :dim])[0].astype(int)
    assert image[y, x].sum() > image[far[1], far[0]].sum() + 150


def test_who_is_few_stands_above_the_cloud(make, crowded):
    predators = flock(make, (15.0, 5.0), predators=5)
    without = replace(predators, predators=make(predators=0, ticks=2).predators)
    (stage, image), (_, empty) = picture(predators, trail=0), picture(without, trail=0)
    x, y = stage.rigs[0].at(1.0).place(predators.predators.position[1, 2])
    assert np.abs(image - empty)[int(y) - 2 : int(y) + 3, int(x) - 2 : int(x) + 3].max() > 60


def test_the_scale_does_not_change_with_the_rest_of_the_crowd(make, crowded):
    one = flock(make, (30.0, 15.0), predators=0)
    other = replace(one, prey=replace(one.prey, position=one.prey.position.copy()))
    other.prey.position[:, 200:] = other.prey.position[:, 200:201] * 0 + (80.0, 40.0)
    (stage, before), (_, after) = (picture(each, camera=((20.0, 10.0), (40.0, 20.0))) for each in (one, other))
    assert after.sum() < before.sum()
    (stage, whole) = picture(other)
    x, y = stage.rigs[0].at(1.0).place(np.array([30.0, 15.0])).astype(int)
    assert whole[y, x].sum() > 150, "a knot elsewhere must not darken the rest"


@pytest.mark.parametrize("theme", sorted(THEMES))
def test_equal_steps_of_the_scale_look_alike(theme):
    stops = np.array([colour(each) for each in THEMES[theme].heat])
    steps = lab(even(stops, 100))
    apart = np.linalg.norm(np.diff(steps, axis=0), axis=1)
    assert apart.max() < 1.25 * apart.min(), "but for the step around a stop"
    assert (np.diff(steps[:, 0]) > 0).all() or (np.diff(steps[:, 0]) < 0).all(), "and lightness alone tells more from less"


def test_cielab_is_what_is_published_for_known_colours():
    assert np.allclose(
        lab(np.array([[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])),
        [(100, 0, 0), (0, 0, 0), (53.24, 80.09, 67.20)],
        atol=0.05,
    )


def evenly(make, apart: float, dim: int = 2, layers: int = 1) -> Recording:
    """Record prey on a square lattice, in space one lattice above the other."""
    x, y = np.meshgrid(np.arange(30.0, 50.0, apart), np.arange(5.0, 25.0, apart))
    spots = np.stack([x.ravel(), y.ravel()], axis=1)
    if dim == 3:
        spots = np.concatenate([np.column_stack([spots, np.full(len(spots), 8.0 + n)]) for n in range(layers)])
    recording = flock(make, (40.0, 15.0, 10.0), dim, "open", predators=0)
    many = len(spots)
    swarm = replace(
        recording.prey,
        position=np.repeat(spots[None], 3, axis=0),
        velocity=np.zeros((3, many, dim)),
        fate=np.full(many, "alive"),
        state=np.full((3, many), "calm"),
        group=np.full((3, many), -1, np.int32),
    )
    return replace(recording, prey=swarm)


@pytest.mark.parametrize(("dim", "layers"), [(2, 1), (3, 1), (3, 4)])
def test_a_colour_is_a_number_of_agents_on_a_square_metre(make, crowded, monkeypatch, dim, layers):
    levels = []
    level, steps = Scale.level, Cells.steps

    def watched(self, *given):
        found = steps(self, *given)
        levels.append(given[-1] * (found / (STEPS - 1)) ** 2)
        return found

    monkeypatch.setattr(Scale, "level", lambda self, density: levels.append(density) or level(self, density))
    monkeypatch.setattr(Cells, "steps", watched)
    monkeypatch.setattr(orbits, "PITCH", np.pi / 2)  # from straight above layers hide each other
    stage, _ = picture(evenly(make, 0.5, dim, layers))
    assert np.quantile(levels[-1][levels[-1] > 2], 0.8) == pytest.approx(4.0 * layers, rel=0.1), "as perspective shows it"
    assert stage.scene.density.scale.top == pytest.approx(4.0 * layers, rel=0.5)


def test_the_scale_is_told_and_held_still(make, crowded):
    recording = evenly(make, 0.5)
    recording.prey.position[2] += (20.0, 15.0)
    size = (960, 540)
    stages = [Composition(recording, size, Look(theme=theme), yuv=False) for theme in ("dark", "light")]
    for stage in stages:
        scale, frames = stage.scene.density.scale, [stage.frame(t, stage.canvas.blank()).copy() for t in (0.0, 2.0)]
        words = scale.bar(stage.windows[-2], stage.look.colours, stage._atlas, stage._unit, stage.look.wording)
        left, right = int(words[:, shapes.PLACE].min()) - 4, int(words[:, shapes.PLACE].max()) + 4
        low = int(stage.windows[-2][3]) - 24
        first, last = (each.reshape(size[1], size[0], 3)[low : low + 20, left:right] for each in frames)
        assert (first == last).all()
        assert len(np.unique(first.reshape(-1, 3), axis=0)) > 20
