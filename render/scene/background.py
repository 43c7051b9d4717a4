"""Background: what stands still in a scene, drawn once under a still camera."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.raster.shapes import NONE, boxes, capsules, colour, discs, mixed, quads, rings
from render.scene.camera import Camera, Orbit
from render.scene.depths import depths
from render.scene.lettering import hue_of
from render.scene.rigs import heights
from render.source import Live, is_sky, target_of
from render.theme import Theme
from tiswarm.records.recording import Recording
from tiswarm.scenario.model import Area, World
from tiswarm.space import box

GRID_STEPS = (0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Distances of grid lines to choose from [m]; the first that leaves at most LINES of them across the world is taken."""

LINES = 12

OUTLINED = 0.4
"""Opacity of outlines of areas."""

WALL = 5
"""Width of walls [units of type]."""


@dataclass(frozen=True)
class Field:
    """A field of force to draw: points [point, 2], m, best on a square lattice, and arrows [point, 2], of any unit."""

    points: np.ndarray
    arrows: np.ndarray


def ground(
    subject: Recording | Live,
    theme: Theme,
    unit: float,
    cameras: Sequence[Camera],
    window: np.ndarray | None,
    field: Field | None,
) -> np.ndarray:
    """Draw floor, grid, areas, edge, target and obstacles. unit: pixels per unit of type.

    cameras: one, or one for each image of a periodic world. window: x0, y0, x1, y1 [px], which a floor without an end fills:
    that of an open world, or of a periodic one with its images; in space, that of one without a ground.
    """
    if isinstance(cameras[0], Orbit):
        return _room(subject, theme, unit, cameras[0]) if window is None else depths(theme, unit, cameras[0], window)
    world, target = subject.scenario.world, target_of(subject)
    low, high = _corners((0, 0), world.size[:2], cameras[0]) if window is None else (window[:2], window[2:])
    rows = _floor(subject, theme, unit, low, high, framed=window is None)
    endless = window is not None and len(cameras) == 1
    for camera in cameras:
        low, high = _corners((0, 0), world.size[:2], camera)
        bare = is_sky(subject)
        rows += [
            NONE if bare and not endless else _grid(world, theme, unit, camera, 0.06, window if endless else None),
            *(_area(area, theme, unit, camera) for area in world.areas),
            *([] if bare and endless else _edge(world.boundary, low, high, theme, unit, 0.22 / len(cameras))),
            _target(target, subject, theme, unit, camera, lone=len(cameras) == 1) if target else NONE,
            _obstacles(subject, theme, unit, camera, lone=len(cameras) == 1),
            _arrows(field, theme, unit, camera) if field else NONE,
        ]
    return np.concatenate(rows)


def _floor(
    subject: Recording | Live, theme: Theme, unit: float, low: np.ndarray, high: np.ndarray, *, framed: bool
) -> list[np.ndarray]:
    """Draw a floor that is lit in its middle; or the sky. framed: it ends at its corners, not at the stage's."""
    shade = boxes(low, high, theme["shadow"], theme.shadow_alpha * 0.7, corner=6 * unit, soft=28 * unit) if framed else NONE
    corner, seen = 3 * unit if framed else 0.0, theme.ground_alpha
    if is_sky(subject):
        overhead, horizon = (colour(each) for each in theme.sky)
        return [shade, boxes(low, high, overhead, seen, corner=corner), boxes(low, high, horizon, 0.0, seen, corner=corner)]
    reach = np.hypot(*(high - low)) / 2
    if box.rounded(subject.scenario.world.boundary):
        middle, radius = (low + high) / 2, (high - low).min() / 2
        return [
            discs(middle, radius, theme["shadow"], theme.shadow_alpha * 0.7, soft=28 * unit),
            discs(middle, radius, theme["world"], seen),
            discs(middle, reach * 0.25, theme["glow"], theme.glow_alpha, soft=min(reach * 1.5, 2 * radius - reach * 0.5)),
        ]
    return [
        shade,
        boxes(low, high, theme["world"], seen, corner=corner),
        discs((low + high) / 2, reach * 0.25, theme["glow"], theme.glow_alpha, soft=reach * 1.5),
    ]


def _edge(boundary: str, low: np.ndarray, high: np.ndarray, theme: Theme, unit: float, alpha: float) -> list[np.ndarray]:
    """Draw the edge of the world: solid walls around it, or a fine line."""
    if not box.solid(boundary):
        return [boxes(low, high, theme["line"], alpha, corner=3 * unit, stroke=0.75 * unit)]
    half = WALL / 2 * unit
    if box.rounded(boundary):
        middle, radius = (low + high) / 2, (high - low).min() / 2
        return [
            rings(middle, radius, 4 * unit, theme["shadow"], 0.5 * theme.shadow_alpha, soft=10 * unit),
            rings(middle, radius + half, 2 * half, theme["obstacle"]),
            rings(middle, radius + half, 1.2 * unit, theme["obstacle_edge"]),
        ]
    return [
        boxes(low, high, theme["shadow"], 0.5 * theme.shadow_alpha, soft=10 * unit, stroke=2 * unit),
        boxes(low - half, high + half, theme["obstacle"], corner=2 * half, stroke=half),
        boxes(low - half, high + half, theme["obstacle_edge"], corner=2 * half, stroke=0.6 * unit),
    ]


def _corners(low, high, camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Map a box of the world to its top left and bottom right corner on the screen."""
    a, b = camera.place(np.array([low, high], float))
    return np.minimum(a, b), np.maximum(a, b)


def _grid(
    world: World, theme: Theme, wide: float, camera: Camera, alpha: float, window: np.ndarray | None = None
) -> np.ndarray:
    """Draw lines at round numbers of metres across a world, or across all that a window shows."""
    (x0, y0), (x1, y1) = (0.0, 0.0), world.size[:2]
    if window is not None:
        (x0, y1), (x1, y0) = camera.centre + (window.reshape(2, 2) - camera.middle) * (1, -1) / camera.scale
    step = next((each for each in GRID_STEPS if max(world.size[:2]) / each <= LINES), GRID_STEPS[-1])
    across = np.arange(np.floor(x0 / step) + 1, np.ceil(x1 / step)) * step
    up = np.arange(np.floor(y0 / step) + 1, np.ceil(y1 / step)) * step
    starts = np.concatenate([np.stack([across, 0 * across + y0], 1), np.stack([0 * up + x0, up], 1)])
    ends = np.concatenate([np.stack([across, 0 * across + y1], 1), np.stack([0 * up + x1, up], 1)])
    if box.rounded(world.boundary):
        starts, ends = _chords(starts, ends, *box.disc(world.size[:2]))
    return capsules(camera.place(starts), camera.place(ends), wide / 2, wide / 2, theme["line"], alpha * theme.ground_alpha)


def _chords(starts: np.ndarray, ends: np.ndarray, middle: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Cut lines [line, 2] along the axes to what of them lies in a circle."""
    along = np.sign(ends - starts)
    off = np.where(along == 0, starts - middle, 0)
    half = radius**2 - (off**2).sum(axis=1, keepdims=True)
    foot, reach = middle + off, along * np.sqrt(np.maximum(half, 0))
    kept = half[:, 0] > 0
    return (foot - reach)[kept], (foot + reach)[kept]


def _ball(size: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Give both ends of the pieces of a ball's three great circles: [piece, 3], m."""
    middle, radius = box.disc(size)
    angle = np.linspace(0, 2 * np.pi, 97)
    circle = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    circles = [middle + np.roll(circle, turn, axis=1) for turn in range(3)]
    return np.concatenate([each[:-1] for each in circles]), np.concatenate([each[1:] for each in circles])


def _room(subject: Recording | Live, theme: Theme, unit: float, camera: Orbit) -> np.ndarray:
    """Draw the floor of a 3-D world, what stands on it, and the twelve edges of its room, or the circles of its ball."""
    size = subject.scenario.world.size
    (width, height), (bottom, top) = size[:2], heights(subject)
    walled = box.bounded(subject.scenario.world.boundary)
    bottom = bottom if walled else 0.0  # where the floor is
    corners = np.array([[x, y, z] for x in (0, width) for y in (0, height) for z in (bottom, top)], float)
    pairs = [(a, b) for a in range(8) for b in range(a) if (a ^ b) in (1, 2, 4)]
    if top > bottom and not walled:
        pairs = [(a, b) for a, b in pairs if not (a | b) & 1]  # only around the floor: nothing stops who goes on in the air
    spots, near = camera.place(corners), camera.nearness(corners)
    a, b = (np.array(ends) for ends in zip(*pairs, strict=True))
    if box.rounded(subject.scenario.world.boundary):
        ends = _ball(size)
        spots, near = camera.place(np.concatenate(ends)), camera.nearness(np.concatenate(ends))
        a, b = np.arange(2 * len(ends[0])).reshape(2, -1)
    floor = camera.place(np.array([(0, 0), (0, height), (width, height), (width, 0)], float))[None]
    rows = [
        quads(floor, theme["world"], theme.ground_alpha),
        quads(floor, theme["glow"], 0.5 * theme.glow_alpha),
        _grid(subject.scenario.world, theme, 1.2 * unit, camera, 0.16),
        capsules(
            spots[a],
            spots[b],
            0.6 * unit * near[a],
            0.6 * unit * near[b],
            theme["line"],
            0.32 * near[a] ** 2,
            0.32 * near[b] ** 2,
        ),
    ]
    if len(subject.obstacle_radius) and subject.obstacle_position.shape[1] == 3:
        below = subject.obstacle_position[:, :2]
        size_there = subject.obstacle_radius * camera.scale * camera.nearness(below)
        rows.append(discs(camera.place(below), size_there, theme["shadow"], 0.5 * theme.shadow_alpha, soft=size_there))
    target = target_of(subject)
    if target:
        rows.append(_target(target, subject, theme, unit, camera, lone=True))
    return np.concatenate(rows)


def spheres(subject: Recording | Live, theme: Theme, camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Draw obstacles as balls lit from the upper left, and give how near each shape is."""
    if not len(subject.obstacle_radius):
        return NONE.copy(), np.zeros(0)
    spots, radii = reaching_in(subject, subject.obstacle_position, subject.obstacle_radius)
    near = camera.nearness(spots)
    centre, radius = camera.place(spots), radii * camera.scale * near
    haze = Orbit.haze(near)
    body, light, edge = (
        np.array(theme[name]) * (1 - haze) + np.array(theme["backdrop"]) * haze
        for name in ("obstacle", "obstacle_light", "obstacle_edge")
    )
    aside = radius[:, None] * (1.0, 1.0)
    rows = [
        discs(centre, radius, body * 0.75),
        discs(centre - aside * 0.06, radius * 0.86, body, soft=np.maximum(radius * 0.3, 1)),
        discs(centre - aside * 0.3, radius * 0.3, light, 0.8, soft=np.maximum(radius * 0.8, 1)),
        rings(centre, radius * 0.985, np.maximum(radius * 0.03, 1.2), edge),
    ]
    return np.concatenate(rows), np.tile(near, len(rows))


def _area(area: Area, theme: Theme, unit: float, camera: Camera) -> np.ndarray:
    """Tint an area, or outline it where there is no ground; its name is written above all that moves."""
    alpha, stroke = (theme.tint_alpha, 0.0) if theme.ground_alpha else (OUTLINED, 0.75 * unit)
    return boxes(*_corners(area.region.low, area.region.high, camera), theme[hue_of(area.label)], alpha, stroke=stroke)


def reaching_in(subject: Recording | Live, centres: np.ndarray, radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Add to discs or balls [disc, dim] their images beyond the edges of a periodic world that reach into it.

    Whoever meets the part of an obstacle that lies beyond an edge meets it there.
    """
    world = subject.scenario.world
    if not box.wraps(world.boundary) or not len(radii):
        return centres, radii
    size = np.array(world.size[: centres.shape[1]], float)
    ways = np.stack(np.meshgrid(*[(0, 1, -1)] * len(size), indexing="ij"), axis=-1).reshape(-1, len(size))  # itself first
    images = (centres[None] + ways[:, None] * size).reshape(-1, len(size))
    sizes = np.tile(radii, len(ways))
    beyond = images - np.clip(images, 0, size)
    kept = (beyond**2).sum(axis=1) < sizes**2
    kept[: len(radii)] = True
    return images[kept], sizes[kept]


def _target(target, subject: Recording | Live, theme: Theme, unit: float, camera: Camera, *, lone: bool) -> np.ndarray:
    spot, reach = np.array([target.position], float), np.array([target.radius], float)
    if lone:
        spot, reach = reaching_in(subject, spot, reach)
    near = camera.nearness(spot)
    centre, radius, hue = camera.place(spot), reach * camera.scale * near, theme["target"]
    return np.concatenate(
        [
            discs(centre, radius * 1.15, hue, 0.16, soft=radius * 1.1),
            discs(centre, radius, hue, 0.14),
            rings(centre, radius, 2.2 * unit, hue, 0.95),
            rings(centre, radius * 0.62, 1.2 * unit, hue, 0.45),
            discs(centre, np.maximum(radius * 0.16, 2 * unit), hue, 0.95),
        ]
    )


def _obstacles(subject: Recording | Live, theme: Theme, unit: float, camera: Camera, *, lone: bool) -> np.ndarray:
    """Shade obstacles like pebbles lit from the upper left. lone: no other camera shows their images."""
    if not len(subject.obstacle_radius):
        return NONE
    spots, radii = subject.obstacle_position, subject.obstacle_radius
    if lone:
        spots, radii = reaching_in(subject, spots, radii)
    centre, radius = camera.place(spots), radii * camera.scale
    aside = radius[:, None] * (1.0, 1.0)
    return np.concatenate(
        [
            discs(centre + aside * 0.22, radius, theme["shadow"], theme.shadow_alpha, soft=np.maximum(radius * 0.8, 1)),
            discs(centre, radius, mixed(theme["obstacle"], theme["shadow"], 0.25)),
            discs(centre - aside * 0.05, radius * 0.9, theme["obstacle"], soft=np.maximum(radius * 0.18, 1)),
            discs(centre - aside * 0.3, radius * 0.3, theme["obstacle_light"], 0.75, soft=np.maximum(radius * 0.7, 1)),
            rings(centre, np.maximum(radius - 0.5 * unit, 0.5 * unit), 1.1 * unit, theme["obstacle_edge"]),
        ]
    )


def _arrows(field: Field, theme: Theme, unit: float, camera: Camera) -> np.ndarray:
    """Draw a field as arrows that begin at its points; the longest is as long as points are apart, the weak ones fade."""
    strength = np.linalg.norm(field.arrows, axis=1)
    strongest = strength.max(initial=0)
    if not strongest > 0:
        return NONE
    felt = np.flatnonzero(strength > 0.01 * strongest)
    points, share = field.points[felt], np.sqrt(strength[felt] / strongest)
    apart = np.sqrt(np.ptp(field.points[:, 0]) * np.ptp(field.points[:, 1]) / max(len(field.points), 1)) * camera.scale
    heading = camera.turn(points, field.arrows[felt])
    reach = (0.85 * apart * share)[:, None]
    start = camera.place(points) - heading * reach / 2
    tip, hue = start + heading * reach, mixed(theme["quiet"], theme["ink"], 0.4)
    half, alpha = 0.7 * unit, 0.25 + 0.6 * share
    aside = heading[:, ::-1] * (1, -1)
    barbs = [tip - heading * 0.3 * reach + side * 0.18 * reach * aside for side in (1, -1)]
    return np.concatenate([capsules(a, tip, half, half, hue, alpha) for a in (start, *barbs)])
