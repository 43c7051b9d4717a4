"""Signs: a shape for each fate, so that nobody has to tell them apart by colour."""

import numpy as np

from render.raster.shapes import NONE, capsules, colour, discs, rings
from render.scene.trajectories import ALIVE, ARRIVED, CAPTURED, CRASHED
from render.theme import Theme
from tiswarm.records.recording import FATES

_STROKES = {
    ARRIVED: (((-0.95, 0.05), (-0.3, 0.7)), ((-0.3, 0.7), (0.95, -0.7))),  # a tick
    CRASHED: (((-0.8, -0.8), (0.8, 0.8)), ((-0.8, 0.8), (0.8, -0.8))),  # a cross
}

PARTED = len(FATES)
"""In place of a fate: that a swarm has parts, each of its own colour."""


def signs(fate: int, places: np.ndarray, size: float, theme: Theme, alpha: float = 1.0) -> np.ndarray:
    """Draw a fate at places [place, 2]: a disc for who lives, a tick for an arrival, a ring for a capture, a cross for a crash.

    PARTED is a pair of discs in the colours of the first two parts. size: half the width of a sign [px].
    """
    if not len(places):
        return NONE
    if fate == PARTED:
        pair = ((-0.45, colour(theme.prey[0])), (0.45, colour(theme.prey[1])))
        return np.concatenate([discs(places + np.array((aside * size, 0.0)), 0.62 * size, hue, alpha) for aside, hue in pair])
    hue = sign_paint(fate, theme)
    if fate == ALIVE:
        return discs(places, 0.85 * size, hue, alpha)
    if fate == CAPTURED:
        return rings(places, 0.8 * size, max(0.42 * size, 1.0), hue, alpha)
    half = max(0.24 * size, 0.6)
    return np.concatenate(
        [capsules(places + size * np.array(a), places + size * np.array(b), half, half, hue, alpha) for a, b in _STROKES[fate]]
    )


def sign_paint(fate: int, theme: Theme) -> tuple[float, float, float]:
    """Give the colour of a fate in linear light."""
    return colour(theme.prey[0]) if fate == ALIVE else theme[FATES[fate]]
