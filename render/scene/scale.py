"""Scale: which colour a density has, from none to the most of a film, and the bar that says so."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.language import Language
from render.raster.glyphs import Atlas
from render.raster.shapes import NONE, boxes, colour
from render.scene.lettering import rounded_up
from render.source import Live
from render.theme import Theme
from tiswarm.records.recording import Recording

STEPS = 1024
"""Colours of the scale."""

CROWDED, GROWTH = 0.99, 1.25
"""The scale ends where this share of a recording's agents are less crowded; a live simulation's, at so many times its start."""

SAMPLES = 8
"""Moments of a recording at which that is looked at."""

OPAQUE, VEIL = 0.96, 0.55
"""Opacity of a cloud that stands for its agents, and of one that lies under agents who are drawn as well."""

FAINT = 0.15
"""From about this place on the scale on a cloud hides its ground."""

LENGTH, HEIGHT, TYPE, INSET, PLATE = 190, 9, 13, 12, 0.72
"""The bar's size, its words', its distance from the stage's corner [units of type], and its plate's opacity."""

LEAST = 7
"""Smaller letters than this [px] are left out, and the bar with them."""

PIECES = 64


@dataclass(frozen=True)
class Scale:
    """Colours of densities from 0 to `top` [agents/m²]; place on the scale is the square root of the share of the top.

    So one step of it is as much as chance alone makes of a count, anywhere on the scale: a difference that is seen is one.

    colours: [step, 4], premultiplied linear light and opacity. counted: what is counted, and across what.
    """

    top: float
    colours: np.ndarray
    counted: str

    def level(self, density: np.ndarray) -> np.ndarray:
        """Give the number of the colour of densities [agents/m²]."""
        return (np.sqrt(np.clip(density / self.top, 0, 1)) * (STEPS - 1) + 0.5).astype(np.int32)

    def bar(self, edges: np.ndarray, theme: Theme, atlas: Atlas, unit: float, words: Language) -> np.ndarray:
        """Draw the scale in the lower left corner of a stage. edges: x0, y0, x1, y1 [px]; unit: pixels per unit of type."""
        size = round(TYPE * unit)
        if size < LEAST or LENGTH * unit > 0.6 * (edges[2] - edges[0]):
            return NONE
        left, base = edges[0] + 2 * INSET * unit, edges[3] - INSET * unit - 1.7 * size
        right, top = left + LENGTH * unit, base - HEIGHT * unit
        shares = np.linspace(0, 1, PIECES + 1)
        x = left + shares * (right - left)
        texels = self.colours[((shares[:-1] + shares[1:]) / 2 * (STEPS - 1)).astype(int)]
        low, high = np.stack([x[:-1], np.full(PIECES, top)], 1), np.stack([x[1:], np.full(PIECES, base)], 1)
        pieces = boxes(low, high, texels[:, :3] / texels[:, 3:], texels[:, 3], soft=0.01)
        rim = INSET * unit
        corners = (left - rim, top - 1.4 * size - 0.7 * rim), (right + rim, base + 1.4 * size + 0.7 * rim)
        plate = boxes(*corners, theme["backdrop"], PLATE, corner=4 * unit)
        rows = [plate, pieces, atlas.line(words.line(self.counted), (left, top - 0.5 * size), size, theme.label("line"))]
        for share, align in ((0.0, "left"), (0.5, "centre"), (1.0, "right")):
            spot = (left + share * (right - left), base + 1.3 * size)
            rows.append(atlas.line(words.short(share**2 * self.top), spot, size, theme.label("line"), align=align))
        return np.concatenate(rows)


def scale_of(theme: Theme, top: float, *, veiled: bool, counted: str) -> Scale:
    """Build a scale. top: agents/m², which is rounded up. veiled: agents are drawn as well."""
    level = np.linspace(0, 1, STEPS)
    opacity = (VEIL if veiled else OPAQUE) * (1 - np.exp(-((level / FAINT) ** 2)))
    light = even(np.array([colour(each) for each in theme.heat]), STEPS)
    texels = np.column_stack([light * opacity[:, None], opacity]).astype(np.float32)
    return Scale(rounded_up(top), texels, counted)


def even(stops: np.ndarray, steps: int) -> np.ndarray:
    """Walk from stop to stop [stop, 3], linear light, in steps that look alike: of one distance in CIELAB. Gives [step, 3]."""
    fine = np.linspace(0, len(stops) - 1, 16 * steps)
    path = np.stack([np.interp(fine, np.arange(len(stops)), each) for each in stops.T], axis=1)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(lab(path), axis=0), axis=1))])
    return np.stack([np.interp(np.linspace(0, along[-1], steps), along, each) for each in path.T], axis=1)


def lab(light: np.ndarray) -> np.ndarray:
    """Turn linear light [..., 3] of sRGB into CIELAB under D65 (CIE 15:2004, 8.2.1; IEC 61966-2-1)."""
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    x, y, z = np.moveaxis(light @ (to_xyz / to_xyz.sum(axis=1, keepdims=True)).T, -1, 0)
    x, y, z = (np.where(v > (6 / 29) ** 3, np.cbrt(v), v * (29 / 6) ** 2 / 3 + 4 / 29) for v in (x, y, z))
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def moments(subject: Recording | Live, start: np.ndarray) -> list[np.ndarray]:
    """Give where prey and predators are at some moments of a recording, or at the start of a live simulation: [agent, dim]."""
    if not isinstance(subject, Recording):
        return [start]
    ticks = np.unique(np.linspace(0, subject.ticks, SAMPLES).astype(int))
    return [np.concatenate([subject.prey.position[tick], subject.predators.position[tick]]) for tick in ticks]


def most(densities: Sequence[np.ndarray], *, live: bool) -> float:
    """Give where a scale ends, from how crowded it is around agents at some moments [agents/m²]."""
    around = np.concatenate(densities)
    if not len(around):
        return 1.0
    return float(GROWTH * np.median(around) if live else np.quantile(around, CROWDED))
