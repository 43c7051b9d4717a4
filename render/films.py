"""Films: frames rasterised on this thread while the encoder works on another."""

import os
from collections.abc import Callable
from pathlib import Path

from render.encoder import QUALITIES, encoder
from render.scene import Look
from render.stage import Stage
from render.theme import Theme, theme_named
from tiswarm.recording import Recording

Progress = Callable[[int, int], None]


def film(
    recording: Recording,
    path: str | os.PathLike,
    size: tuple[int, int] = (1280, 720),
    fps: int = 60,
    *,
    speed: float = 10.0,
    trail: float = 2.5,
    theme: str | Theme = "dark",
    quality: str = "good",
    progress: Progress | None = None,
) -> Path:
    """Film a recording as an H.264 MP4; return its path.

    size: width and height [px], both even. speed: ticks per second of film. trail: how long trails last [s of film].
    theme: "dark", "light", "print" or a Theme. quality: "draft", "good" or "best".
    progress: called with frames done and frames in all.

    Errors: ValueError for a setting that is not possible; FilmError when the film cannot be written, and then no file is left.
    """
    if quality not in QUALITIES:
        raise ValueError(f"quality: unknown {quality!r}; use one of {', '.join(QUALITIES)}")
    checked_size(size, even=True)
    stage = Stage(recording, size, theme_named(theme), Look(speed, trail), yuv=True)
    times = stage.times(fps)
    comment = f"{recording.scenario.title}; trial {recording.trial}, seed {recording.seed}"
    with encoder(Path(path), size, fps, QUALITIES[quality], {"title": recording.scenario.title, "comment": comment}) as reel:
        for n, time in enumerate(times):
            reel.put(stage.frame(time, reel.blank()))
            if progress:
                progress(n + 1, len(times))
    return Path(path)


def checked_size(size: tuple[int, int], *, even: bool) -> None:
    """Raise ValueError unless frames can have this size, naming the nearest that they can have."""
    if min(size) < 16 or max(size) > 16384:
        raise ValueError(f"size: {size[0]}x{size[1]} is not possible; use 16 to 16384 pixels each way")
    if even and any(edge % 2 for edge in size):
        near = "x".join(str(edge + edge % 2) for edge in size)
        raise ValueError(f"size: {size[0]}x{size[1]} has an odd edge, which H.264 video cannot have; use {near}")
