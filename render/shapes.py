"""Shapes, the one thing a canvas draws: rows of numbers, made many at a time.

A shape is a row of COLUMNS float32 numbers. Lengths are pixels, x to the right and y down from the top left corner; colours
are linear light. Shapes are drawn in the order of their rows. Rows that follow each other with the same group above zero are
joined (the strongest counts) and blended once, so that a trail of many capsules has no beads where they meet.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

KIND, GROUP, PLACE, SIZE, TWEAK, SOFT, STROKE, PAINT, ALPHA, BOUNDS = 0, 1, 2, 6, 8, 9, 10, 11, 14, 16
COLUMNS = 20

CAPSULE, DART, BOX, SPRITE = 0, 1, 2, 3

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


def _rows(kind: int, count: int, paint, alpha, group=0, soft=1.0, stroke=0.0) -> np.ndarray:
    rows = np.zeros((count, COLUMNS), np.float32)
    rows[:, KIND] = kind
    rows[:, GROUP] = group
    rows[:, SOFT] = soft
    rows[:, STROKE] = stroke
    rows[:, PAINT : PAINT + 3] = paint
    rows[:, ALPHA] = rows[:, ALPHA + 1] = alpha
    return rows


def _bound(rows: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Store whole-pixel bounds of points low..high [shape, 2] and of the soft edge around them."""
    reach = (rows[:, SOFT] / 2 + rows[:, STROKE] + 0.5)[:, None]
    rows[:, BOUNDS : BOUNDS + 2] = np.floor(low - reach)
    rows[:, BOUNDS + 2 : BOUNDS + 4] = np.ceil(high + reach)
    return rows


def capsules(a, b, radius_a, radius_b, paint, alpha_a=1.0, alpha_b=None, group=0, soft=1.0, stroke=0.0) -> np.ndarray:
    """Draw tapered capsules from points a to points b: [shape, 2]; every other argument is one number or [shape].

    A stroke above zero is half the width of an outline, drawn instead of the filled shape.
    """
    a, b = np.atleast_2d(a), np.atleast_2d(b)
    rows = _rows(CAPSULE, len(a), paint, alpha_a, group, soft, stroke)
    rows[:, ALPHA + 1] = alpha_a if alpha_b is None else alpha_b
    rows[:, PLACE : PLACE + 2], rows[:, PLACE + 2 : PLACE + 4] = a, b
    rows[:, SIZE], rows[:, SIZE + 1] = radius_a, radius_b
    reach = rows[:, SIZE : SIZE + 2].max(axis=1)[:, None]
    return _bound(rows, np.minimum(a, b) - reach, np.maximum(a, b) + reach)


def discs(centre, radius, paint, alpha=1.0, group=0, soft=1.0) -> np.ndarray:
    """Draw discs around centres [shape, 2]. A ramp of `soft` pixels adds area, which the radius gives back."""
    true = np.maximum(np.asarray(radius, float) ** 2 - np.asarray(soft, float) ** 2 / 12, 0.0) ** 0.5
    return capsules(centre, centre, true, true, paint, alpha, group=group, soft=soft)


def rings(centre, radius, width, paint, alpha=1.0, soft=1.0) -> np.ndarray:
    """Draw circles of a line width around centres [shape, 2]."""
    return capsules(centre, centre, radius, radius, paint, alpha, soft=soft, stroke=np.asarray(width) / 2)


def darts(centre, heading, length, width, notch, paint, alpha=1.0) -> np.ndarray:
    """Draw swept darts at centres [shape, 2] along headings (unit vectors).

    length, width: half the extent along and across the heading; notch: how deep the tail is cut.
    """
    centre = np.atleast_2d(centre)
    rows = _rows(DART, len(centre), paint, alpha)
    rows[:, PLACE : PLACE + 2], rows[:, PLACE + 2 : PLACE + 4] = centre, heading
    rows[:, SIZE], rows[:, SIZE + 1], rows[:, TWEAK] = length, width, notch
    reach = np.hypot(rows[:, SIZE], rows[:, SIZE + 1])[:, None]
    return _bound(rows, centre - reach, centre + reach)


def boxes(low, high, paint, alpha_top=1.0, alpha_bottom=None, corner=0.0, soft=1.0, stroke=0.0) -> np.ndarray:
    """Draw boxes between corners low and high [shape, 2], rounded, and fading from top to bottom."""
    low, high = np.atleast_2d(np.asarray(low, float)), np.atleast_2d(np.asarray(high, float))
    rows = _rows(BOX, len(low), paint, alpha_top, soft=soft, stroke=stroke)
    rows[:, ALPHA + 1] = alpha_top if alpha_bottom is None else alpha_bottom
    rows[:, PLACE : PLACE + 2] = (low + high) / 2
    rows[:, SIZE : SIZE + 2] = (high - low) / 2
    rows[:, TWEAK] = np.minimum(corner, rows[:, SIZE : SIZE + 2].min(axis=1))
    return _bound(rows, low, high)


def sprites(corner, size, source, paint, alpha=1.0) -> np.ndarray:
    """Draw pieces of the atlas: top left corners, sizes and places in the atlas are whole pixels [shape, 2]."""
    corner = np.atleast_2d(corner)
    rows = _rows(SPRITE, len(corner), paint, alpha)
    rows[:, PLACE : PLACE + 2], rows[:, PLACE + 2 : PLACE + 4] = corner, source
    rows[:, BOUNDS : BOUNDS + 2] = corner
    rows[:, BOUNDS + 2 : BOUNDS + 4] = corner + np.asarray(size)
    return rows


def clipped(rows: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """Cut bounds to a rectangle (x0, y0, x1, y1) and drop the shapes that lie outside it or cannot be seen."""
    rows = rows.copy()
    box = rows[:, BOUNDS : BOUNDS + 4]
    np.maximum(box, np.tile(bounds[:2], 2), out=box)
    np.minimum(box, np.tile(bounds[2:], 2), out=box)
    seen = (box[:, 2] > box[:, 0]) & (box[:, 3] > box[:, 1]) & (rows[:, ALPHA : ALPHA + 2].max(axis=1) > 0)
    return np.ascontiguousarray(rows[seen])
