"""Timeline: which time of a subject each frame of a film shows."""

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from render.scene.trajectories import Trajectories
from tiswarm.records.recording import Recording

Rate = int | float | Fraction
"""Frames per second."""

HOLD = 1.0
"""How long the last state stays on the screen [s]."""

SLOWEST = 0.25
"""Pace around a capture in slow motion, as a share of the speed."""

AROUND = 0.5
"""How long before and after a capture slow motion lasts, at full speed [s of film]."""


def times(paths: Trajectories, speed: float, fps: Rate, *, slow: bool = False) -> Iterator[float]:
    """Give the frames' times [ticks]; past the last tick the picture stands still and flashes fade.

    speed: ticks per second of film. slow: slow down around captures of prey, which only recordings know beforehand.

    Errors: ValueError for fewer than one frame per second.
    """
    if not 1 <= fps < float("inf"):
        raise ValueError(f"fps: {fps} is not possible; use 1 or more")
    return _times(paths, speed, _plain(fps), slow)


def length(paths: Trajectories, speed: float, fps: Rate, *, slow: bool = False) -> int:
    """Count the frames: for a live simulation, which may end early, the most there can be."""
    fps = _plain(fps)
    moving = len(_slowed(paths, speed, fps)) if slow else int(np.ceil(paths.last / speed * fps))
    return moving + max(round(HOLD * fps), 1)


def _plain(fps: Rate) -> int | float:
    """Give a rate as a number that NumPy counts with."""
    return int(fps) if fps == int(fps) else float(fps)


def _times(paths: Trajectories, speed: float, fps: Rate, slow: bool) -> Iterator[float]:
    if slow:
        yield from _slowed(paths, speed, fps) * speed
    else:
        for n in range(int(np.ceil(paths.last / speed * fps))):
            if not paths.reach(n / fps * speed):  # a live simulation may end before it has run its ticks
                break
            yield n / fps * speed
    paths.reach(paths.last)
    for n in range(max(round(HOLD * fps), 1)):
        yield (paths.last / speed + n / fps) * speed


def _slowed(paths: Trajectories, speed: float, fps: Rate) -> np.ndarray:
    """List the times until the last tick [s at full speed]."""
    end, captures = paths.last / speed, _captures(paths) / speed
    steady = np.arange(0, end, 1 / (4 * fps))
    pace = np.array([_pace(each, captures) for each in steady])
    reached = np.concatenate([[0], np.cumsum(1 / (4 * fps) / pace)])
    return np.interp(np.arange(0, reached[-1], 1 / fps), reached, np.append(steady, end))


def _captures(paths: Trajectories) -> np.ndarray:
    """List the ticks at which prey of recordings are captured."""
    preys = [subject.prey for subject in paths.subjects if isinstance(subject, Recording)]
    ends = [np.isfinite(prey.position[:, prey.fate == "captured", 0]).sum(axis=0) for prey in preys]
    return np.concatenate(ends).astype(float)


def _pace(now: float, captures: np.ndarray) -> float:
    """Give the share of full speed at a time [s], easing in and out of slow motion."""
    nearest = np.abs(captures - now).min(initial=np.inf)
    ease = min(max(nearest / AROUND - 0.5, 0.0) * 2, 1.0)
    return SLOWEST + (1 - SLOWEST) * ease * ease * (3 - 2 * ease)
