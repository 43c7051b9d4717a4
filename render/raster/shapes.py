"""Shapes, the one thing a canvas draws: rows of numbers, made many at a time.

A shape is a row of COLUMNS float32 numbers. Lengths are pixels, x to the right and y down from the top left corner; colours
are linear light. Shapes are drawn in the order of their rows. Rows that follow each other with the same group above zero are
joined (the strongest counts) and blended once, so that a trail of many capsules has no beads where they meet. WINDOW is the
number of the window that a shape is cut to; its BOUNDS are the canvas's to fill in.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

KIND, GROUP, PLACE, SIZE, TWEAK, SOFT, STROKE, PAINT, ALPHA, WINDOW, BOUNDS = 0, 1, 2, 6, 8, 9, 10, 11, 14, 16, 17
COLUMNS = 21

CAPSULE, DART, BOX, SPRITE, QUAD, CLOUD = 0, 1, 2, 3, 4, 5

Colour = tuple[float, float, float]

NONE = np.zeros((0, COLUMNS), np.float32)
"""No shapes."""


def linear(encoded_colour: np.ndarray | Sequence[float]) -> np.ndarray:
    """Turn sRGB values 0..1 into linear light."""
    value = np.asarray(encoded_colour, float)
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def encoded(light: np.ndarray | Sequence[float]) -> np.ndarray:
    """Turn linear light 0..1 into sRGB values, which video players take for BT.709's as well."""
    value = np.asarray(light, float)
    return np.where(value <= 0.0031308, value * 12.92, 1.055 * np.maximum(value, 1e-9) ** (1 / 2.4) - 0.055)


@cache
def colour(code: str) -> Colour:
    """Read "#rrggbb" as linear light."""
    red, green, blue = linear([int(code[n : n + 2], 16) / 255 for n in (1, 3, 5)])
    return float(red), float(green), float(blue)


def mixed(a: Colour, b: Colour, share: float) -> Colour:
    """Blend two colours: `share` of b."""
    return tuple(x + (y - x) * share for x, y in zip(a, b, strict=True))  # type: ignore[return-value]


def _rows(kind: int, count: int, paint, alpha_a, alpha_b, group, soft, stroke) -> np.ndarray:
    """Fill rows with what all kinds have."""
    rows = np.zeros((count, COLUMNS), np.float32)
    rows[:, KIND], rows[:, GROUP], rows[:, SOFT], rows[:, STROKE] = kind, group, soft, stroke
    rows[:, PAINT : PAINT + 3] = paint
    rows[:, ALPHA], rows[:, ALPHA + 1] = alpha_a, alpha_b
    return rows


def _points(given) -> np.ndarray:
    """Take points as [shape, 2], which they mostly are."""
    return given if isinstance(given, np.ndarray) and given.ndim == 2 else np.atleast_2d(given)


def capsules(a, b, radius_a, radius_b, paint, alpha_a=1.0, alpha_b=None, group=0, soft=1.0, stroke=0.0) -> np.ndarray:
    """Draw tapered capsules from points a to points b: [shape, 2]; every other argument is one number or [shape].

    A stroke above zero is half the width of an outline, drawn instead of the filled shape.
    """
    a, b = _points(a), _points(b)
    rows = _rows(CAPSULE, len(a), paint, alpha_a, alpha_a if alpha_b is None else alpha_b, group, soft, stroke)
    rows[:, PLACE : PLACE + 2], rows[:, PLACE + 2 : PLACE + 4] = a, b
    rows[:, SIZE], rows[:, SIZE + 1] = radius_a, radius_b
    return rows


def discs(centre, radius, paint, alpha=1.0, group=0, soft=1.0) -> np.ndarray:
    """Draw discs around centres [shape, 2]. A ramp of `soft` pixels adds area, which the radius gives back."""
    centre = _points(centre)
    true = np.maximum(radius * radius - soft * soft / 12, 0.0) ** 0.5
    return capsules(centre, centre, true, true, paint, alpha, group=group, soft=soft)


def rings(centre, radius, width, paint, alpha=1.0, soft=1.0) -> np.ndarray:
    """Draw circles of a line width around centres [shape, 2]."""
    centre = _points(centre)
    return capsules(centre, centre, radius, radius, paint, alpha, soft=soft, stroke=width / 2)


def darts(centre, heading, length, width, notch, paint, alpha=1.0) -> np.ndarray:
    """Draw swept darts at centres [shape, 2] along headings (unit vectors).

    length, width: half the extent along and across the heading; notch: how deep the tail is cut.
    """
    centre = _points(centre)
    rows = _rows(DART, len(centre), paint, alpha, alpha, 0, 1.0, 0.0)
    rows[:, PLACE : PLACE + 2], rows[:, PLACE + 2 : PLACE + 4] = centre, heading
    rows[:, SIZE], rows[:, SIZE + 1], rows[:, TWEAK] = length, width, notch
    return rows


def boxes(low, high, paint, alpha_top=1.0, alpha_bottom=None, corner=0.0, soft=1.0, stroke=0.0) -> np.ndarray:
    """Draw boxes between corners low and high [shape, 2], rounded, and fading from top to bottom."""
    low, high = np.atleast_2d(np.asarray(low, float)), np.atleast_2d(np.asarray(high, float))
    rows = _rows(BOX, len(low), paint, alpha_top, alpha_top if alpha_bottom is None else alpha_bottom, 0, soft, stroke)
    rows[:, PLACE : PLACE + 2] = (low + high) / 2
    rows[:, SIZE : SIZE + 2] = (high - low) / 2
    rows[:, TWEAK] = np.minimum(corner, rows[:, SIZE : SIZE + 2].min(axis=1))
    return rows


def quads(corners, paint, alpha=1.0) -> np.ndarray:
    """Draw convex quadrilaterals: corners [shape, 4, 2], clockwise on the screen."""
    rows = _rows(QUAD, len(corners), paint, alpha, alpha, 0, 1.0, 0.0)
    rows[:, PLACE : PLACE + 4], rows[:, SIZE : SIZE + 2] = corners[:, :2].reshape(-1, 4), corners[:, 2]
    rows[:, TWEAK], rows[:, STROKE] = corners[:, 3].T  # no quadrilateral has a tweak or a stroke
    return rows


def sprites(corner, size, source, paint, alpha=1.0) -> np.ndarray:
    """Draw pieces of the atlas: top left corners, sizes and places in the atlas are whole pixels [shape, 2]."""
    corner = np.atleast_2d(corner)
    rows = _rows(SPRITE, len(corner), paint, alpha, alpha, 0, 1.0, 0.0)
    rows[:, PLACE : PLACE + 2], rows[:, PLACE + 2 : PLACE + 4] = corner, source
    rows[:, SIZE : SIZE + 2] = size
    return rows


def cloud(low, high, cells: tuple[int, int], first: int) -> np.ndarray:
    """Draw a cloud between the corners low and high [2]: colours that run into each other, from the atlas's cells.

    cells: columns and rows, from the top left corner on. first: number of the first; they have a rim of one cell around.
    """
    low, extent = np.asarray(low, float), np.subtract(high, low)
    rows = _rows(CLOUD, 1, 0.0, 1.0, 1.0, 0, 1.0, first)
    rows[:, PLACE : PLACE + 2], rows[:, PLACE + 2 : PLACE + 4] = low, cells / extent
    rows[:, SIZE : SIZE + 2], rows[:, TWEAK] = extent, cells[0] + 2
    return rows


def moved(rows: np.ndarray, step: tuple[float, float]) -> np.ndarray:
    """Move capsules, darts, boxes and sprites by whole pixels; return new rows."""
    rows = rows.copy()
    rows[:, PLACE : PLACE + 2] += step
    rows[rows[:, KIND] == CAPSULE, PLACE + 2 : PLACE + 4] += step
    return rows
