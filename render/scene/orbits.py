"""Orbits: cameras that walk around a 3-D world, or around a swarm that leaves an open one for good."""

from collections.abc import Callable, Sequence

import numpy as np

from render.captions.layout import Box
from render.scene.camera import Camera, Orbit
from render.source import Live, is_endless
from tiswarm.records.recording import Recording

PITCH, START, TURN, DISTANCE = 0.42, 0.35, 0.1, 2.6
"""Angles above the ground and around it at the start [rad], turn [rad/s of film], distance [half diagonals]."""

MARGIN = 0.014
"""Free rim around what is shown, as a share of the stage's shorter edge: room for a wall."""

LEFT = 0.2
"""Share of a recording that the prey's centre may be outside an open world before the camera goes with it."""

INSIDE, MOSTLY = 0.95, 0.9
"""A camera that goes along shows this share of the agents, for this share of the time."""

CLOSEST = 0.05
"""It shows at least this share of the world's longest edge to each side."""

AIR = 1.15
"""How much more than that it shows."""

SAMPLES = 200
"""Ticks at which it is found how far agents are from their centre."""


def leaves(subject: Recording | Live) -> bool:
    """Tell whether prey wander off for good through an open world in which nothing keeps them: then one must go along."""
    if not isinstance(subject, Recording) or not is_endless(subject):
        return False
    size, prey = np.array(subject.scenario.world.size), subject.prey.position
    there = np.isfinite(prey[:, :, 0]).any(axis=1)
    away = np.abs(np.nanmean(prey[there], axis=1) - size / 2) > size / 2
    return bool(away.any(axis=1).sum() > LEFT * len(prey))


def roamed(subjects: Sequence[Recording | Live]) -> float:
    """Give how far around the prey a camera must look that goes along with 3-D subjects [m]: 0 where nobody leaves."""
    if subjects[0].scenario.world.dim == 2 or not any(leaves(subject) for subject in subjects):
        return 0.0
    return max(_reach(subject) for subject in subjects if isinstance(subject, Recording))


def _reach(recording: Recording) -> float:
    """Give how far most agents are from the middle of the prey, most of the time [m]."""
    ticks = np.linspace(0, recording.ticks, min(recording.ticks + 1, SAMPLES)).astype(int)
    prey, predators = recording.prey.position[ticks], recording.predators.position[ticks]
    there = np.isfinite(prey[:, :, 0]).any(axis=1)  # later nobody is left to be shown
    centre = np.nanmean(prey[there], axis=1, keepdims=True)
    apart = np.linalg.norm(np.concatenate([prey[there], predators[there]], axis=1) - centre, axis=2)
    reach = float(np.quantile(np.nanquantile(apart, INSIDE, axis=1), MOSTLY))
    return max(reach, CLOSEST * max(recording.scenario.world.size))


def around(pivot: tuple[float, ...], sides: np.ndarray, speed: float, stage: Box) -> Callable[[float], Camera]:
    """Walk around a room, looking slightly down on it. pivot, sides: its middle and extent [m]; speed: ticks/s of film."""
    away = DISTANCE * float(np.linalg.norm(sides)) / 2
    middle_of = np.array(pivot)
    corners = middle_of + sides * [[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    turns = [Orbit(middle_of, np.zeros(2), 1.0, axes(angle), away) for angle in np.linspace(0, 2 * np.pi, 60)]
    spread = np.concatenate([turn.place(corners) for turn in turns])
    margin = 2 * MARGIN * min(stage.width, stage.height)
    low, high = spread.min(axis=0), spread.max(axis=0)
    scale = float(min((stage.width - margin) / (high[0] - low[0]), (stage.height - margin) / (high[1] - low[1])))
    across, up = (stage.left + stage.right) / 2, (stage.top + stage.bottom) / 2 - scale * float(low[1] + high[1]) / 2
    middle = np.array([across, up])

    def orbit(time: float) -> Camera:
        return Orbit(middle_of, middle, scale, _turned(time, speed), away)

    return orbit


def alongside(way: np.ndarray, reach: float, speed: float, stage: Box) -> Callable[[float], Camera]:
    """Walk around what moves on a way [tick, 3], m, so near that `reach` [m] to each side of it is seen."""
    rows = np.arange(len(way))
    scale = min(stage.width, stage.height) / (2 * AIR * reach)
    middle = np.array([(stage.left + stage.right) / 2, (stage.top + stage.bottom) / 2])

    def orbit(time: float) -> Camera:
        pivot = np.array([np.interp(time, rows, each) for each in way.T])
        return Orbit(pivot, middle, scale, _turned(time, speed), DISTANCE * reach)

    return orbit


def _turned(time: float, speed: float) -> np.ndarray:
    return axes(START + time / speed * TURN)


def axes(angle: float) -> np.ndarray:
    """Give the directions right, up and forward of an eye that looks down on the world from an angle around it: [3, 3]."""
    c, s, cp, sp = np.cos(angle), np.sin(angle), np.cos(PITCH), np.sin(PITCH)
    return np.array([[c, s, 0], [-s * sp, c * sp, cp], [-s * cp, c * cp, -sp]])
