"""The world: what stands still in a scene, drawn once under a still camera."""

import numpy as np

from render.camera import Camera, Orbit
from render.shapes import NONE, boxes, capsules, discs, mixed, rings
from render.text import Atlas
from render.theme import Theme
from tiswarm.recording import Recording

GRID_STEPS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Distances of grid lines to choose from [m]; the first that leaves at most LINES of them across the world is taken."""

LINES = 12


def ground(recording: Recording, theme: Theme, atlas: Atlas, unit: float, camera: Camera) -> np.ndarray:
    """Draw floor, grid, areas, edge, target and obstacles. unit: pixels per unit of type."""
    world = recording.scenario.world
    if isinstance(camera, Orbit):
        floor = _grid(world.size, theme, 1.2 * unit, camera, 0.16)
        return np.concatenate([floor, _cage(recording, theme, unit, camera)])
    low, high = _corners((0, 0), world.size[:2], camera)
    reach = np.hypot(*(high - low)) / 2
    rows = [
        boxes(low, high, theme["shadow"], theme.shadow_alpha * 0.7, corner=6 * unit, soft=28 * unit),
        boxes(low, high, theme["world"], corner=3 * unit),
        discs((low + high) / 2, reach * 0.25, theme["glow"], theme.glow_alpha, soft=reach * 1.5),
        _grid(world.size, theme, unit, camera, 0.06),
        *(_area(area, theme, atlas, unit, camera) for area in world.areas),
        boxes(low, high, theme["line"], 0.85 if world.boundary == "walls" else 0.22, corner=3 * unit, stroke=0.75 * unit),
        _target(recording, theme, unit, camera),
        _obstacles(recording, theme, camera),
    ]
    return np.concatenate(rows)


def _corners(low, high, camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Map a box of the world to its top left and bottom right corner on the screen."""
    a, b = camera.place(np.array([low, high], float))
    return np.minimum(a, b), np.maximum(a, b)


def _grid(size: tuple[float, ...], theme: Theme, wide: float, camera: Camera, alpha: float) -> np.ndarray:
    width, height = size[:2]
    step = next((each for each in GRID_STEPS if max(width, height) / each <= LINES), GRID_STEPS[-1])
    across, up = np.arange(step, width, step), np.arange(step, height, step)
    starts = np.concatenate([np.stack([across, 0 * across], 1), np.stack([0 * up, up], 1)])
    ends = np.concatenate([np.stack([across, 0 * across + height], 1), np.stack([0 * up + width, up], 1)])
    return capsules(camera.place(starts), camera.place(ends), wide / 2, wide / 2, theme["line"], alpha)


def _cage(recording: Recording, theme: Theme, unit: float, camera: Camera) -> np.ndarray:
    """Draw the twelve edges of the box that a 3-D world fills."""
    swarms = (recording.prey, recording.predators)
    heights = np.concatenate([swarm.position[..., 2].ravel() for swarm in swarms]) if recording.dim == 3 else np.zeros(1)
    width, height = recording.scenario.world.size[:2]
    top = float(np.nanmax(heights))
    corners = np.array([[x, y, z] for x in (0, width) for y in (0, height) for z in (0, top)], float)
    pairs = [(a, b) for a in range(8) for b in range(a) if (a ^ b) in (1, 2, 4)]
    spots = camera.place(corners)
    a, b = (spots[list(ends)] for ends in zip(*pairs, strict=True))
    return capsules(a, b, 0.6 * unit, 0.6 * unit, theme["line"], 0.35)


def _area(area, theme: Theme, atlas: Atlas, unit: float, camera: Camera) -> np.ndarray:
    """Tint an area and name it once, in its upper left corner."""
    words = area.label.lower()
    hue = theme["danger" if "danger" in words else "safe" if "safe" in words else "line"]
    low, high = _corners(area.region.low, area.region.high, camera)
    tint = boxes(low, high, hue, theme.tint_alpha)
    size, inset = round(11 * unit), 12 * unit
    if size < 7:  # too small to read: the tint alone has to do
        return tint
    spot = low[0] + inset, low[1] + inset + size * 0.75
    return np.concatenate([tint, atlas.line(area.label.upper(), spot, size, hue, 0.75, spacing=max(round(size * 0.12), 1))])


def _target(recording: Recording, theme: Theme, unit: float, camera: Camera) -> np.ndarray:
    target = recording.scenario.target
    centre, radius, hue = camera.place(np.array([target.position])), target.radius * camera.scale, theme["target"]
    return np.concatenate(
        [
            discs(centre, radius * 1.15, hue, 0.16, soft=radius * 1.1),
            discs(centre, radius, hue, 0.14),
            rings(centre, radius, 2.2 * unit, hue, 0.95),
            rings(centre, radius * 0.62, 1.2 * unit, hue, 0.45),
            discs(centre, max(radius * 0.16, 2 * unit), hue, 0.95),
        ]
    )


def _obstacles(recording: Recording, theme: Theme, camera: Camera) -> np.ndarray:
    """Shade obstacles like pebbles lit from the upper left."""
    if not len(recording.obstacle_radius):
        return NONE
    centre = camera.place(recording.obstacle_position)
    radius = recording.obstacle_radius * camera.scale
    aside = radius[:, None] * (1.0, 1.0)
    return np.concatenate(
        [
            discs(centre + aside * 0.22, radius, theme["shadow"], theme.shadow_alpha, soft=np.maximum(radius * 0.8, 1)),
            discs(centre, radius, mixed(theme["obstacle"], theme["shadow"], 0.25)),
            discs(centre - aside * 0.05, radius * 0.9, theme["obstacle"], soft=np.maximum(radius * 0.18, 1)),
            discs(centre - aside * 0.3, radius * 0.3, theme["obstacle_light"], 0.75, soft=np.maximum(radius * 0.7, 1)),
        ]
    )
