"""Rigs: who holds the camera, what of the world it shows, and where it goes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from render.captions.layout import Box
from render.scene.camera import Camera
from render.scene.orbits import MARGIN, PITCH, alongside, around, leaves
from render.scene.trajectories import Trajectories
from render.source import Live
from render.style import Look
from tiswarm.records.recording import Recording
from tiswarm.space import box

RIM = 0.012
"""Free rim around agents that leave the world: they only must not touch the edge."""

FOLLOWED = 0.5
"""Share of the fitted view that a following camera shows."""

FARTHEST = 0.5
"""How far from the world agents may start and still be shown [share of the world's size]."""

CALM = 12
"""A following camera's path is smoothed over about this many ticks."""

ENDLESS = 1.25
"""Width by height of the stage of a camera that goes along with a swarm in space: it has no form of its own."""


@dataclass(frozen=True)
class Rig:
    """Who holds the camera: `at` gives it for a time [ticks]; a still one never moves."""

    at: Callable[[float], Camera]
    still: bool


@dataclass(frozen=True)
class View:
    """What a fitting camera shows [m]: the world, and all that is reached by what moves, which holds the world.

    floor, top: the lowest and the highest point of 3-D worlds. along: how far around the prey one sees who goes along with
    them through space [m]; 0 where the camera stays in the world.
    """

    world: Box
    reach: Box
    floor: float = 0.0
    top: float = 0.0
    along: float = 0.0


def bounds(paths: Trajectories, scene: int, stray: float) -> Box:
    """Give the box [m] of a subject's world and of all that moves there.

    Who strays farther from the world than a share `stray` of its size is let go: the rest would become too small to see. Starts
    are always in it, and are all that is known of a live simulation.
    """
    subject = paths.subjects[scene]
    world, radius = subject.scenario.world, max(subject.scenario.prey.radius, subject.scenario.predators.radius)
    size = np.array(world.size[:2], float)
    if box.wraps(world.boundary):
        return Box(0, 0, *world.size[:2])
    start = paths.spots(0.0)[paths.scene == scene, :2]
    low, high = np.zeros(2), size
    if isinstance(subject, Recording):
        spots = np.concatenate([swarm.position[..., :2].reshape(-1, 2) for swarm in (subject.prey, subject.predators)])
        low = np.maximum(np.minimum(low, np.nanmin(spots, axis=0) - radius), -stray * size)
        high = np.minimum(np.maximum(high, np.nanmax(spots, axis=0) + radius), (1 + stray) * size)
    low = np.maximum(np.minimum(low, np.nanmin(start, axis=0) - radius), -FARTHEST * size)
    high = np.minimum(np.maximum(high, np.nanmax(start, axis=0) + radius), (1 + FARTHEST) * size)
    return Box(float(low[0]), float(low[1]), float(high[0]), float(high[1]))


def heights(subject: Recording | Live) -> tuple[float, float]:
    """Give the lowest and the highest point of a 3-D world [m]: the world's own, and those of what moves."""
    low, high = 0.0, float((*subject.scenario.world.size, 0.0)[2])
    if isinstance(subject, Recording) and subject.dim == 3:
        levels = np.concatenate([swarm.position[..., 2].ravel() for swarm in (subject.prey, subject.predators)])
        low, high = min(low, float(np.nanmin(levels))), max(high, float(np.nanmax(levels)))
    return low, high


def apparent(paths: Trajectories, view: View) -> tuple[float, float]:
    """Give how wide and high a view looks, next to each other: an orbit sees the diagonal of the floor, and that aslant."""
    width, height = view.reach.width, view.reach.height
    if view.along:
        return ENDLESS, 1.0
    if paths.dim == 2:
        return width, height
    across = float(np.hypot(width, height))
    return across, across * float(np.sin(PITCH)) + (view.top - view.floor) * float(np.cos(PITCH))


def rig(look: Look, paths: Trajectories, scene: int, view: View, stage: Box) -> Rig:
    """Choose who holds the camera on a subject. view: what "fit" shows; stage: where on the screen.

    Errors: ValueError when the agent to follow does not exist, or when a camera would have to look ahead in a live simulation.
    """
    if not isinstance(look.camera, str):
        (x0, y0), (x1, y1) = look.camera
        chosen = Box(x0, y0, x1, y1)
        held = fitted(View(chosen, chosen), stage)
        return Rig(lambda _: held, still=True)
    kind, _, agent = look.camera.partition(":")
    subject = paths.subjects[scene]
    if kind == "orbit" or (kind == "fit" and paths.dim == 3):
        return _orbiting(look, subject, view, stage)
    fit = fitted(view, stage)
    if kind == "fit" and not leaves(subject):
        return Rig(lambda _: fit, still=True)
    if not isinstance(subject, Recording):
        raise ValueError("camera: 'follow' looks ahead, which a live simulation does not let it; record it first, or use fit")
    count = subject.prey.count + subject.predators.count
    if agent and int(agent) >= count:
        raise ValueError(f"camera: no agent {agent} to follow; use 0 to {count - 1}")
    way = _calm_path(subject, int(agent) if agent else None)
    rows, shown = np.arange(len(way)), 1.0 if kind == "fit" else FOLLOWED
    world = subject.scenario.world
    period = np.array(world.size[:2]) if box.wraps(world.boundary) else None

    def follow(time: float) -> Camera:
        centre = np.array([np.interp(time, rows, way[:, 0]), np.interp(time, rows, way[:, 1])])
        return Camera(centre if period is None else np.mod(centre, period), fit.middle, fit.scale / shown)

    return Rig(follow, still=False)


def _calm_path(recording: Recording, agent: int | None) -> np.ndarray:
    """Smooth the path of an agent, or of the centre of the prey that are left: [tick, dim]. In a periodic world it goes on."""
    world = recording.scenario.world
    chosen = recording.prey.position
    if agent is not None:
        chosen = np.concatenate([chosen, recording.predators.position], axis=1)[:, agent : agent + 1]
    there = np.isfinite(chosen[..., :1])
    count = there.sum(axis=1)
    if box.wraps(world.boundary):
        turn = 2 * np.pi / np.array(world.size)
        waves = np.where(there, np.exp(1j * np.nan_to_num(chosen) * turn), 0).sum(axis=1)
        mean = np.unwrap(np.angle(waves), axis=0) / turn
    else:
        mean = np.where(there, chosen, 0).sum(axis=1) / np.maximum(count, 1)
    last = np.maximum.accumulate(np.where(count[:, 0] > 0, np.arange(len(mean)), 0))
    way = mean[last]
    weights = np.exp(-0.5 * (np.arange(-2 * CALM, 2 * CALM + 1) / (CALM / 2)) ** 2)
    rim = (2 * CALM, 2 * CALM), (0, 0)
    padded = np.pad(way, rim, mode="reflect", reflect_type="odd")  # goes on at both ends as it came
    return np.stack([np.convolve(padded[:, n], weights / weights.sum(), mode="valid") for n in range(way.shape[1])], axis=1)


def _orbiting(look: Look, subject: Recording | Live, view: View, stage: Box) -> Rig:
    """Walk around the world, or around the prey that leave it."""
    if view.along and isinstance(subject, Recording):
        return Rig(alongside(_calm_path(subject, None), view.along, look.speed, stage), still=False)
    reach = view.reach
    pivot = (reach.left + reach.right) / 2, (reach.top + reach.bottom) / 2, (view.floor + view.top) / 2
    sides = np.array([reach.width, reach.height, view.top - view.floor])
    return Rig(around(pivot, sides, look.speed, stage), still=False)


def fitted(view: View, stage: Box) -> Camera:
    """Show a view as large as the stage allows: the world in the middle unless what leaves it needs the room."""
    short = min(stage.width, stage.height)
    pads = MARGIN * short, RIM * short
    across = ((view.world.left, view.reach.left), (view.world.right, view.reach.right))
    up = ((view.world.top, view.reach.top), (view.world.bottom, view.reach.bottom))
    scale = min(_largest(*across, pads, stage.width), _largest(*up, pads, stage.height))
    x, y = _placed(*across, pads, stage.width, scale), _placed(*up, pads, stage.height, scale)
    centre = (view.world.left + view.world.right) / 2, (view.world.top + view.world.bottom) / 2
    return Camera(np.array(centre), np.array((stage.left + x, stage.bottom - y)), scale)


Ends = tuple[float, float]
"""An end of the world along one axis, and of what is reached there [m]."""


def _largest(low: Ends, high: Ends, pads: Ends, room: float) -> float:
    """Give the largest scale [px/m] at which world and reach, with their pads [px], have room along one axis."""
    pairs = [(a, b) for a in zip(low, pads, strict=True) for b in zip(high, pads, strict=True)]
    return min((room - pad - other) / (end - start) for (start, pad), (end, other) in pairs)


def _placed(low: Ends, high: Ends, pads: Ends, room: float, scale: float) -> float:
    """Give where the world's middle goes along one axis [px], as near to the middle of the room as is possible."""
    middle = (low[0] + high[0]) / 2
    before = max(scale * (middle - end) + pad for end, pad in zip(low, pads, strict=True))
    after = max(scale * (end - middle) + pad for end, pad in zip(high, pads, strict=True))
    return min(max(room / 2, before), room - after)
