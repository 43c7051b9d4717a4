"""Lettering: what is written on the stage, above all that moves: names of areas, and a bar that tells how long a metre is."""

import numpy as np

from render.language import Language
from render.raster.glyphs import Atlas, width
from render.raster.shapes import NONE, capsules
from render.scene.camera import Camera, Orbit
from render.source import Live
from render.theme import Theme
from tiswarm.records.recording import Recording

NAME, LENGTH = 11, 14
"""Sizes of areas' names and of the bar's length [units of type]."""

LEAST = 7
"""Smaller letters than this [px] are left out: the tint of an area alone has to do."""

INSET, TICK = 12, 5
"""Room around words, and half the height of the bar's ends [units of type]."""

SPAN = 0.18
"""The bar is at most this share of the stage's width."""


def names(subject: Recording | Live, theme: Theme, atlas: Atlas, unit: float, camera: Camera, words: Language) -> np.ndarray:
    """Name each area of a flat world once, in its lower left corner. unit: pixels per unit of type."""
    size, inset, rows = round(NAME * unit), INSET * unit, [NONE]
    if size < LEAST or isinstance(camera, Orbit):
        return NONE
    for area in subject.scenario.world.areas:
        left, base = camera.place(np.array([area.region.low], float))[0] + (inset, -inset)
        hue = theme.label(hue_of(area.label))
        name = words.word("areas", area.label).upper()
        apart = max(round(size * 0.12), 1) if words.rightward else 0  # letters that join must not be parted
        rows.append(atlas.line(name, (left, base), size, hue, spacing=apart))
    return np.concatenate(rows)


def hue_of(label: str) -> str:
    """Give the theme's colour for an area of some name."""
    meant = label.lower()
    return "danger" if "danger" in meant else "safe" if "safe" in meant else "line"


def scale_bar(edges: np.ndarray, theme: Theme, atlas: Atlas, unit: float, camera: Camera, words: Language) -> np.ndarray:
    """Draw a bar of a round length in the lower right corner of a stage: in space as long as it looks in the view's middle.

    edges: x0, y0, x1, y1 [px]. unit: pixels per unit of type.
    """
    size = round(LENGTH * unit)
    if size < LEAST:
        return NONE
    metres = rounded(SPAN * (edges[2] - edges[0]) / camera.scale)
    right, y, hue = edges[2] - INSET * unit, edges[3] - INSET * unit, theme.label("line")
    left, half = right - metres * camera.scale, max(0.8 * unit, 0.6)
    ends = np.array([(left, y - TICK * unit), (left, y), (right, y), (right, y - TICK * unit)])
    length = words.line(words.length(metres))
    above = atlas.line(length, ((left + right) / 2, y - 7 * unit), size, hue, align="centre")
    if width(length, size) > right - left:  # beside the bar where it is too short to stand above it
        above = atlas.line(length, (left - 6 * unit, y), size, hue, align="right")
    return np.concatenate([capsules(ends[:-1], ends[1:], half, half, hue, 1.0, group=1), above])


def rounded(most: float) -> float:
    """Give the largest of 1, 2, 5, 10, 20, ... and 0.5, 0.2, ... that is not above a length."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(each * power for each in (1, 2, 5) if each * power <= most * (1 + 1e-9)))


def rounded_up(value: float) -> float:
    """Give the smallest number of one leading digit, or 1.5 or 2.5 times a power of ten, that is not below a value."""
    if not value > 0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(each * power for each in (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10) if each * power >= value * (1 - 1e-9)))
