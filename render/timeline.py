"""When: which time of the recording each frame of a film shows."""

import numpy as np

from render.motion import Motion

HOLD = 1.0
"""How long the last state stays on the screen [s]."""

SLOWEST = 0.25
"""Pace around a capture in slow motion, as a share of the speed."""

AROUND = 0.5
"""How long before and after a capture slow motion lasts, at full speed [s of film]."""


def times(paths: Motion, speed: float, fps: int, *, slow: bool = False) -> np.ndarray:
    """List the frames' times [ticks]; past the recording's last tick the picture stands still and flashes fade.

    speed: ticks per second of film. slow: slow down around captures of prey.

    Errors: ValueError for fewer than one frame per second.
    """
    if fps < 1:
        raise ValueError(f"fps: {fps} is not possible; use 1 or more")
    length = paths.ticks / speed
    if slow:
        captures = paths.end[(paths.fate == "captured") & paths.is_prey] / speed
        steady = np.arange(0, length, 1 / (4 * fps))
        pace = np.array([_pace(each, captures) for each in steady])
        reached = np.concatenate([[0], np.cumsum(1 / (4 * fps) / pace)])
        frames = np.arange(0, reached[-1], 1 / fps)
        shown = np.interp(frames, reached, np.append(steady, length))
    else:
        shown = np.arange(int(np.ceil(length * fps))) / fps
    return np.concatenate([shown, length + np.arange(max(round(HOLD * fps), 1)) / fps]) * speed


def _pace(now: float, captures: np.ndarray) -> float:
    """Give the share of full speed at a time [s], easing in and out of slow motion."""
    nearest = np.abs(captures - now).min(initial=np.inf)
    ease = min(max(nearest / AROUND - 0.5, 0.0) * 2, 1.0)
    return SLOWEST + (1 - SLOWEST) * ease * ease * (3 - 2 * ease)
