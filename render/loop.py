"""Loop: a film whose end runs into its beginning: its last frames cross-fade into its first ones, which it begins after."""

from collections.abc import Callable, Iterator

import numpy as np

from render.composition import Composition
from render.raster.framebuffer import Framebuffer
from render.timeline import Rate

LONGEST = 1.0
"""A cross-fade lasts as long as trails do, and at most this [s of film]."""


def faded(stage: Composition, fps: Rate) -> int:
    """Count the frames of the cross-fade."""
    return max(min(round(min(stage.look.trail, LONGEST) * float(fps)), stage.length(fps) // 3), 1)


def _mixed(one: np.ndarray, other: np.ndarray, share: float) -> np.ndarray:
    """Mix bytes: `share` of the other."""
    return np.rint(one * (1 - share) + other * share)


def _blended(one: np.ndarray, other: np.ndarray, share: float) -> np.ndarray:
    """Mix bytes of colours and opacities: each colour counts as much as there is of it."""
    pair = np.stack([one, other]).reshape(2, -1, 4).astype(np.float32)
    weights = pair[..., 3:] * np.array((1 - share, share), np.float32)[:, None, None]
    alpha = weights.sum(axis=0)
    colours = ((weights + 1e-3) * pair[..., :3]).sum(axis=0) / (alpha + 2e-3)
    return np.rint(np.concatenate([colours, alpha], axis=1)).reshape(-1)


def drawn(stage: Composition, fps: Rate, blank: Callable[[], Framebuffer]) -> Iterator[Framebuffer]:
    """Draw the frames of a film, in a loop or not, each on a plate that `blank` gives."""
    overlap = faded(stage, fps) if stage.look.loop else 0
    last = stage.length(fps) - overlap
    spare, first = stage.canvas.blank(), list[np.ndarray]()
    for n, shot in enumerate(stage.shots(fps)):
        if n < overlap:
            first.append(stage.shot(shot, spare).copy())
            continue
        plate = blank()
        stage.shot(shot, plate)
        if overlap and n >= last:
            share = (n - last + 1) / (overlap + 1)
            blend = _blended if stage.look.transparent else _mixed
            plate.bytes[:] = blend(plate.bytes, first[n - last], share)
            plate.ground = -1  # it is not what was drawn on it any more
        yield plate
