"""Worlds of other kinds: periodic, walled, deep; without target, predators or obstacles."""

import numpy as np
import pytest
from handmade import SIZE, path, picture, world

import render
from render.captions.caption import counters
from render.composition import Composition
from render.scene.background import Field, reaching_in
from render.scene.coverage import Cells
from render.source import is_sky
from render.style import Look
from tiswarm.measures import recorded
from tiswarm.records.recording import Recording


def crossing(dim: int = 2) -> Recording:
    """Let one prey fly to the right through the edge of a periodic world of 40 m x 20 m: at tick 5 it is there."""
    x = np.mod(35 + np.arange(11.0), 40)
    position = np.full((11, 1, dim), 10.0)
    position[:, 0, 0] = x
    return world(path(position, np.eye(dim)[0]), **{"world.boundary": "periodic"})


def what_moves(recording: Recording, time: float, **look: object) -> tuple[Composition, np.ndarray]:
    """Tell which pixels the agents and their trails change."""
    stage, image = picture(recording, time, **look)
    ground = world(
        path(np.full_like(recording.prey.position, np.nan), 0), **{"world.boundary": recording.scenario.world.boundary}
    )
    return stage, np.abs(image - picture(ground, time, **look)[1]).max(axis=2) > 12


@pytest.mark.parametrize("camera", ["fit", "follow", "orbit"])
@pytest.mark.parametrize("time", [4.7, 5.0, 5.4, 9.0])
def test_whoever_wraps_leaves_no_streak(camera, time):
    _, image = picture(crossing(), time, camera=camera, trail=0.3)
    _, before = picture(crossing(), 4.0, camera=camera, trail=0.3)
    lit = (np.abs(image[:180] - np.median(image[:180], axis=1, keepdims=True)).max(axis=2) > 40).sum(axis=1).max()
    lit_before = (np.abs(before[:180] - np.median(before[:180], axis=1, keepdims=True)).max(axis=2) > 40).sum(axis=1).max()
    assert lit < lit_before + 60


def test_an_agent_on_a_periodic_edge_is_seen_on_both_sides():
    stage, moving = what_moves(crossing(), 5.0, trail=0)
    camera = stage.rigs[0].at(5.0)
    (left, _), (right, _) = camera.place(np.array([[0.0, 10.0], [40.0, 10.0]]))
    columns = moving.any(axis=0).nonzero()[0]
    assert columns.min() <= left + 2
    assert columns.max() >= right - 3
    assert (columns >= np.floor(left)).all()
    assert (columns <= np.ceil(right)).all()
    assert not moving[:, int(left) + 40 : int(right) - 40].any()


def test_a_trail_goes_on_behind_a_periodic_edge():
    stage, moving = what_moves(crossing(), 7.0, trail=2.0)
    y = int(stage.rigs[0].at(7.0).place(np.array([[0.0, 10.0]]))[0, 1])
    spots = stage.rigs[0].at(7.0).place(np.array([[37.0, 10.0], [39.5, 10.0], [0.5, 10.0], [20.0, 10.0]]))[:, 0].astype(int)
    assert [bool(moving[y - 1 : y + 2, x - 1 : x + 2].any()) for x in spots] == [True, True, True, False]


def test_the_way_across_an_edge_is_no_way_through_the_world():
    _, moving = what_moves(crossing(), 5.5, overlay=("velocity",), trail=0)
    assert not moving[:, 120:280].any()


def test_neighbours_across_an_edge_are_linked_across_it():
    x = np.array([[1.0, 10.0], [39.0, 10.0]])
    recording = world(path(np.stack([x, x]), np.zeros(2)), **{"world.boundary": "periodic", "prey.perception": 5})
    _, linked = picture(recording, 0.0, overlay=("links",))
    without = picture(recording, 0.0)[1]
    columns = np.abs(linked - without).max(axis=2).any(axis=0).nonzero()[0]
    assert len(columns)
    assert not ((columns > 60) & (columns < 340)).any()


def test_who_sees_nobody_behind_it_is_drawn_with_what_it_sees():
    x = np.array([[12.0, 10.0], [20.0, 10.0], [28.0, 10.0]])
    swarm = path(np.stack([x, x + np.array([1.0, 0.0])]), np.array([1.0, 0.0]))

    def overlaid(overlay, **rule):
        recording = world(swarm, **{"prey.perception": 9, **rule})
        stage, with_it = picture(recording, 0.0, overlay=(overlay,), trail=0)
        return stage, np.abs(with_it - picture(recording, 0.0, trail=0)[1]).max(axis=2) > 4

    stage, around = overlaid("perception")
    behind = int(stage.rigs[0].at(0.0).place(np.array([[3.0, 10.0]]))[0, 0])
    assert around[:, behind - 3 : behind + 3].any()
    _, ahead = overlaid("perception", **{"prey.field_of_view": 180})
    assert ahead.any()
    assert not ahead[:, behind - 3 : behind + 3].any()
    _, linked = overlaid("links")
    _, half = overlaid("links", **{"prey.field_of_view": 180})  # each draws its own half of the way to those it heeds
    assert 0 < half.sum() < 0.7 * linked.sum()


def test_walls_are_drawn_where_there_are_walls():
    still = path(np.full((2, 1, 2), 5.0), np.zeros(2))
    stage, walled = picture(world(still, **{"world.boundary": "walls"}), 0.0)
    _, free = picture(world(still), 0.0)
    (left, top), _ = stage.rigs[0].at(0.0).place(np.array([[0.0, 20.0], [40.0, 0.0]]))
    wall = np.abs(walled - free).max(axis=2)
    assert wall[100, max(int(left) - 4, 0) : int(left) + 1].max() > 30
    assert wall[max(int(top) - 4, 0) : int(top) + 1, 200].max() > 30


def test_a_predator_shows_which_cluster_it_chases():
    still = path(np.full((2, 1, 2), 5.0), np.zeros(2))
    seen = [picture(world(still, path(np.full((2, 1, 2), 12.0), np.zeros(2), group=each)), 0.0)[1] for each in (-1, 0, 1)]
    assert all((one != other).any() for one, other in ((seen[0], seen[1]), (seen[1], seen[2]), (seen[0], seen[2])))


def test_only_what_can_happen_is_counted():
    still, hunter = path(np.full((2, 3, 2), 5.0), np.zeros(2)), path(np.full((2, 1, 2), 12.0), np.zeros(2))

    def names(recording: Recording, **look: object) -> list[str]:
        return [counter.name for counter in counters(Composition(recording, SIZE, Look(**look), yuv=False).scene)]  # type: ignore[arg-type]

    assert names(world(still)) == []
    assert names(world(still), overlay=("coverage",)) == ["covered"]
    assert names(world(still, hunter, **{"predators.count": 1})) == ["alive", "captured"]
    assert names(world(still, hunter, **{"predators.count": 1, "world.contact": "none"})) == []
    assert names(world(still, obstacles=2, **{"target.present": True})) == ["alive", "arrived", "crashed"]


def test_a_world_without_ground_is_a_sky():
    still = path(np.full((2, 1, 2), 5.0), np.zeros(2))
    assert is_sky(world(still, **{"world.boundary": "periodic"}))
    assert not is_sky(world(still, **{"world.boundary": "walls"}))
    assert not is_sky(world(still, **{"target.present": True}))
    assert not is_sky(world(still, obstacles=1))


@pytest.mark.parametrize("boundary", ["open", "periodic", "walls"])
@pytest.mark.parametrize("theme", sorted(render.THEMES))
def test_deep_worlds_of_every_kind_can_be_drawn(boundary, theme):
    rng = np.random.default_rng(1)
    flock = path(np.cumsum(rng.uniform(0, 0.5, (9, 20, 3)), axis=0) + 2, np.full(3, 0.25))
    recording = world(flock, obstacles=4, **{"world.boundary": boundary, "target.present": True})
    stage, image = picture(recording, 6.5, theme=theme)
    assert len(np.unique(image)) > 30
    assert not stage.rigs[0].still, "an orbit is what deep worlds have for fit"


def test_flat_and_deep_worlds_do_not_mix():
    deep = path(np.full((2, 1, 3), 5.0), np.zeros(3))
    with pytest.raises(ValueError, match="one by one"):
        Composition([world(deep), crossing()], SIZE, Look(), yuv=False)


def test_cleaned_ground_is_what_tools_have_passed_over():
    position = np.stack([np.linspace(5, 35, 31), np.full(31, 10.0)], axis=1)[:, None]
    recording = world(path(position, np.array([1.0, 0.0])), **{"prey.radius": 1.0, "world.boundary": "walls"})
    stage = Composition(recording, SIZE, Look(overlay=("coverage",)), yuv=False)
    stage.frame(30.0, stage.canvas.blank())
    coverage = stage.scene.coverage
    assert coverage is not None
    assert coverage.share(30.0) == pytest.approx((30 * 2 + np.pi) / (40 * 20), rel=0.1)


def test_the_share_in_the_caption_is_the_measure():
    position = np.stack([np.linspace(5, 35, 31), 10 + 3 * np.sin(np.arange(31.0))], axis=1)[:, None]
    grid = {"coverage.cell": 0.7, "coverage.tool": 1.2, "world.boundary": "walls"}
    recording = world(path(position, np.array([1.0, 0.0])), obstacles=2, **grid)
    stage = Composition(recording, SIZE, Look(), yuv=False)
    stage.frame(30.0, stage.canvas.blank())
    coverage, measured = stage.scene.coverage, recorded.coverage(recording)
    assert coverage is not None
    for tick in (0, 7, 15, 30):
        assert coverage.share(tick) == pytest.approx(measured[tick])


def test_a_camera_goes_with_a_swarm_that_leaves_an_open_world_for_good():
    position = np.stack([np.linspace(5, 200, 40), np.full(40, 10.0)], axis=1)[:, None]
    for target, still in ((False, False), (True, True)):
        recording = world(path(position, np.array([5.0, 0.0])), **{"target.present": target})
        stage, _ = picture(recording, 39.0)
        assert stage.rigs[0].still == still
    spot = picture(world(path(position, np.array([5.0, 0.0]))), 35.0)[0].rigs[0].at(35.0).place(position[35])
    assert 50 < spot[0, 0] < 350


def test_cells_lie_where_their_numbers_say():
    cells = Cells((40.0, 20.0), 1.0)
    assert cells.of(np.array([[0.5, 0.5], [39.5, 0.5], [0.5, 1.5], [-0.1, 3.0], [np.nan, 1.0], [40.5, 1.0]])).tolist() == [
        0,
        39,
        40,
        -1,
        -1,
        -1,
    ]


def test_a_field_is_drawn_as_arrows(tmp_path):
    recording = world(path(np.full((2, 1, 2), 5.0), np.zeros(2)), obstacles=1)
    points = np.stack(np.meshgrid(np.arange(2.0, 40, 4), np.arange(2.0, 20, 4)), axis=-1).reshape(-1, 2)
    field = Field(points, points - recording.obstacle_position)
    stages = [Composition(recording, SIZE, Look(), yuv=False, field=each) for each in (field, None)]
    drawn, plain = (stage.frame(0.0, stage.canvas.blank()).reshape(240, 400, 3).astype(int) for stage in stages)
    assert (np.abs(drawn - plain).max(axis=2) > 20).sum() > 200
    render.poster(recording, tmp_path / "a.png", SIZE, field=Field(points, np.zeros_like(points)))


def test_what_reaches_across_a_periodic_edge_is_drawn_on_both_sides():
    centres, radii = np.array([[39.0, 10.0], [0.5, 0.5], [20.0, 10.0]]), np.array([2.0, 1.0, 2.0])
    sky = world(path(np.full((2, 1, 2), 20.0), np.zeros(2)), **{"world.boundary": "periodic"})
    images, sizes = reaching_in(sky, centres, radii)
    there = {(*map(float, spot), float(size)) for spot, size in zip(images, sizes, strict=True)}
    corner = {(x, y, 1.0) for x in (0.5, 40.5) for y in (0.5, 20.5)}
    assert there == {(39.0, 10.0, 2.0), (-1.0, 10.0, 2.0), (20.0, 10.0, 2.0)} | corner
    room, wide = np.array([[0.5, 5.0, 10.0]]), np.array([1.0])
    walls = world(path(np.full((2, 1, 2), 20.0), np.zeros(2)), **{"world.boundary": "walls"})
    assert len(reaching_in(walls, centres, radii)[0]) == 3
    deep = world(path(np.full((2, 1, 3), 10.0), np.zeros(3)), **{"world.boundary": "periodic"})
    assert sorted(reaching_in(deep, room, wide)[0][:, 0].tolist()) == [0.5, 40.5]
