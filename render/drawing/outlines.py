"""Outlines of shapes: rows of numbers in, closed curves and lines out, many at a time."""

from dataclasses import dataclass

import numpy as np

from render.raster.shapes import (
    ALPHA,
    BOX,
    CAPSULE,
    DART,
    GROUP,
    KIND,
    PAINT,
    PLACE,
    QUAD,
    SIZE,
    SOFT,
    STROKE,
    TWEAK,
    encoded,
    linear,
)

MOVE, LINE, CURVE, CLOSE = 1, 2, 4, 79
"""Codes of points: where a curve begins, a corner, a point of a cubic curve, and the end that closes it."""

BLURRED, RAMP = 3.0, 12
"""Wider ramps than this [px] are drawn as so many outlines within each other, whose opacities add up to them."""

BANDS = 14
"""Opacities of a trail, and of a line that fades."""

FAINT = 0.004
"""What is less opaque than this cannot be seen."""

BEND = 0.9
"""Cosine of the sharpest bend that one ribbon makes."""

_ARC = 3
"""Cubic curves of an arc."""


@dataclass(frozen=True)
class Mark:
    """One outline: points [point, 2], px, their codes, colour [channel], sRGB, opacity, width of a line [px], 0 when filled."""

    points: np.ndarray
    codes: np.ndarray
    paint: np.ndarray
    alpha: float
    width: float = 0.0


def outlined(rows: np.ndarray, ground: np.ndarray) -> list[Mark]:
    """Give what is drawn for rows of one window, neither words nor clouds, in their order.

    ground: linear light of what they are mostly drawn on: opacities are for blending in sRGB, as programs that show vectors do.
    """
    paints = np.round(255 * encoded(rows[:, PAINT : PAINT + 3])) / 255
    first, second = (_opacity(rows, n, ground, paints) for n in (0, 1))
    tiled = (rows[:, KIND] == BOX) & (rows[:, SOFT] <= 1) & (rows[:, STROKE] == 0) & (rows[:, TWEAK] == 0) & (first == second)
    made: list[Mark] = []
    n = 0
    while n < len(rows):
        row, end = rows[n].astype(float), n + 1
        pair = float(first[n]), float(second[n])
        if row[GROUP] > 0 and row[KIND] == CAPSULE and max(pair) < 0.99:
            band = round(BANDS * pair[0])
            while end < len(rows) and _goes_on(rows[end - 1], rows[end]) and round(BANDS * first[end]) == band:
                end += 1
            made.append(_ribbon(rows[n:end].astype(float), paints[n], float((first[n:end] + second[n:end]).mean() / 2)))
        elif tiled[n]:
            while end < len(rows) and tiled[end]:
                end += 1
            made += _tiles(rows[n:end], paints[n:end], first[n:end])
        elif row[SOFT] > BLURRED and not row[STROKE]:
            made += _blurred(row, paints[n], pair[0])
        elif row[KIND] == BOX and abs(pair[0] - pair[1]) > 0.01:
            made += _shaded(row, paints[n], pair)
        elif row[KIND] == CAPSULE and abs(pair[0] - pair[1]) > 0.01:
            made += _fading(row, paints[n], pair)
        else:
            made.append(_plain(row, paints[n], pair[0]))
        n = end
    return [mark for mark in made if mark.alpha > FAINT]


def _opacity(rows: np.ndarray, end: int, ground: np.ndarray, paints: np.ndarray) -> np.ndarray:
    """Give the opacities that make in sRGB, over the ground, of what those of one end of shapes make in linear light."""
    alpha, under = rows[:, ALPHA + end].astype(float), encoded(ground)
    light = ground + alpha[:, None] * (linear(paints) - ground)
    way, whole = encoded(light) - under, paints - under
    size = (whole**2).sum(axis=1)
    return np.where(size > 0.01, np.clip((way * whole).sum(axis=1) / np.maximum(size, 1e-9), 0, 1), alpha)


def _goes_on(before: np.ndarray, after: np.ndarray) -> bool:
    """Tell whether a capsule goes on where the one before it ends, without a sharp bend."""
    if after[GROUP] != before[GROUP] or np.abs(after[PLACE : PLACE + 2] - before[PLACE + 2 : PLACE + 4]).max() > 0.01:
        return False
    way, next_way = (row[PLACE + 2 : PLACE + 4] - row[PLACE : PLACE + 2] for row in (before, after))
    return bool(way @ next_way >= BEND * np.hypot(*way) * np.hypot(*next_way))


def _ribbon(rows: np.ndarray, paint: np.ndarray, alpha: float) -> Mark:
    """Draw capsules that go on from each other as one band."""
    points = np.concatenate([rows[:1, PLACE : PLACE + 2], rows[:, PLACE + 2 : PLACE + 4]])
    radius = np.append(rows[0, SIZE], rows[:, SIZE + 1])
    way = np.diff(points, axis=0)
    length = np.hypot(*way.T)[:, None]
    way = np.where(length > 1e-9, way / np.maximum(length, 1e-9), (1.0, 0.0))
    ahead = np.concatenate([way[:1], way[:-1] + way[1:], way[-1:]])
    ahead /= np.maximum(np.hypot(*ahead.T)[:, None], 1e-9)
    aside = ahead[:, ::-1] * (-1, 1) * radius[:, None]
    return Mark(*_polygon(np.concatenate([points + aside, (points - aside)[::-1]])), paint, alpha)


def _fading(row: np.ndarray, paint: np.ndarray, pair: tuple[float, float]) -> list[Mark]:
    """Draw a line that fades from one end to the other in pieces."""
    pieces = np.repeat(row[None], BANDS, axis=0)
    for n, (low, high) in enumerate(zip(np.linspace(0, 1, BANDS + 1)[:-1], np.linspace(0, 1, BANDS + 1)[1:], strict=True)):
        a, b = row[PLACE : PLACE + 2], row[PLACE + 2 : PLACE + 4]
        pieces[n, PLACE : PLACE + 4] = *(a + low * (b - a)), *(a + high * (b - a))
        pieces[n, SIZE : SIZE + 2] = row[SIZE] + np.array((low, high)) * (row[SIZE + 1] - row[SIZE])
    shares = (np.arange(BANDS) + 0.5) / BANDS
    alphas = pair[0] + shares * (pair[1] - pair[0])
    return [_ribbon(piece[None], paint, float(alpha)) for piece, alpha in zip(pieces, alphas, strict=True)]


def _tiles(rows: np.ndarray, paints: np.ndarray, alphas: np.ndarray) -> list[Mark]:
    """Draw plain boxes, those of one look as one outline, so that no seam shows between neighbours."""
    looks, which = np.unique(np.column_stack([paints, np.round(alphas, 2)]), axis=0, return_inverse=True)
    which, marks = which.ravel(), []
    for look in dict.fromkeys(which):
        some = rows[which == look].astype(float)
        around = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)])
        points = some[:, None, PLACE : PLACE + 2] + around * some[:, None, SIZE : SIZE + 2]
        codes = np.tile([MOVE, LINE, LINE, LINE, CLOSE], len(some))
        marks.append(Mark(points.reshape(-1, 2), codes, looks[look, :3], float(alphas[which == look].mean())))
    return marks


def _added(levels: np.ndarray) -> np.ndarray:
    """Give the opacities of layers, each above all before it, that together reach rising levels."""
    before = np.append(0.0, levels[:-1])
    return (levels - before) / np.maximum(1 - before, 1e-6)


def _blurred(row: np.ndarray, paint: np.ndarray, alpha: float) -> list[Mark]:
    """Draw a shape with a soft edge as outlines within each other."""
    steps = min(max(round(row[SOFT] / 2), 4), RAMP)
    shares, marks = (np.arange(steps) + 0.5) / steps, []
    for share, layer in zip(shares, _added(alpha * shares), strict=True):
        grown, beyond = row.copy(), (0.5 - share) * row[SOFT]
        grown[SIZE : SIZE + 2] = np.maximum(grown[SIZE : SIZE + 2] + beyond, 0)
        if row[KIND] == BOX:
            grown[TWEAK] = max(grown[TWEAK] + beyond, 0)
        if grown[SIZE : SIZE + 2].max() > 0:
            marks.append(_plain(grown, paint, float(layer)))
    return marks


def _shaded(row: np.ndarray, paint: np.ndarray, pair: tuple[float, float]) -> list[Mark]:
    """Draw a box that fades between top and bottom as boxes within each other."""
    steps, rising, marks = 4 * RAMP, pair[1] > pair[0], []
    levels = min(pair) + (np.arange(steps) + 0.5) / steps * abs(pair[1] - pair[0])
    for n, layer in enumerate(_added(levels)):
        inner = row.copy()
        cut = n / steps * row[SIZE + 1]
        inner[SIZE + 1] -= cut
        inner[PLACE + 1] += cut if rising else -cut
        marks.append(_plain(inner, paint, float(layer)))
    return marks


def _plain(row: np.ndarray, paint: np.ndarray, alpha: float) -> Mark:
    """Draw a shape as it is: a line where it is one all along, else an outline, which is drawn or filled."""
    stroke = 2 * row[STROKE] if row[KIND] != QUAD else 0.0
    a, b = row[PLACE : PLACE + 2], row[PLACE + 2 : PLACE + 4]
    if row[KIND] == CAPSULE and not stroke and row[SIZE] == row[SIZE + 1] and np.abs(a - b).max() > 1e-3:
        return Mark(np.array([a, b]), np.array([MOVE, LINE]), paint, alpha, float(max(2 * row[SIZE], 0.2)))
    if row[KIND] == CAPSULE:
        outline = _capsule(a, b, row[SIZE], row[SIZE + 1])
    elif row[KIND] == DART:
        ahead, aside = b, b[::-1] * (-1, 1)
        length, width, notch = row[SIZE], row[SIZE + 1], row[TWEAK]
        tail = a - length * ahead
        outline = _polygon(np.array([a + length * ahead, tail + width * aside, tail + notch * ahead, tail - width * aside]))
    elif row[KIND] == QUAD:
        outline = _polygon(np.array([a, b, row[SIZE : SIZE + 2], (row[TWEAK], row[STROKE])]))
    else:
        outline = _rounded(a, row[SIZE : SIZE + 2], row[TWEAK])
    return Mark(*outline, paint, alpha, float(stroke))


def _polygon(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    codes = np.full(len(points) + 1, LINE)
    codes[0], codes[-1] = MOVE, CLOSE
    return np.concatenate([points, points[:1]]), codes


def _capsule(a: np.ndarray, b: np.ndarray, ra: float, rb: float) -> tuple[np.ndarray, np.ndarray]:
    """Give the outline of two discs and all between them."""
    length = float(np.hypot(*(b - a)))
    if length <= abs(ra - rb) + 1e-6:
        a, ra, rb, length = (a if ra >= rb else b), max(ra, rb), max(ra, rb), 0.0
    heading = np.arctan2(b[1] - a[1], b[0] - a[0]) if length else 0.0
    side = np.arccos(np.clip((ra - rb) / length, -1, 1)) if length else np.pi / 2
    far = b if length else a
    points = np.concatenate(
        [_arc(a, ra, heading + side, heading + 2 * np.pi - side), _arc(far, rb, heading - side, heading + side)]
    )
    codes = np.array([MOVE, *[CURVE] * (3 * _ARC), LINE, *[CURVE] * (3 * _ARC), CLOSE])
    return np.concatenate([points, points[:1]]), codes


def _arc(centre: np.ndarray, radius: float, start: float, end: float) -> np.ndarray:
    """Give the points of cubic curves along an arc, its start first: [1 + 3 curves, 2]."""
    angle = np.linspace(start, end, _ARC + 1)
    reach = 4 / 3 * np.tan((end - start) / _ARC / 4)
    on = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    along = on[:, ::-1] * (-1, 1) * reach
    pieces = np.stack([on[:-1] + along[:-1], on[1:] - along[1:], on[1:]], axis=1).reshape(-1, 2)
    return centre + radius * np.concatenate([on[:1], pieces])


def _rounded(middle: np.ndarray, half: np.ndarray, corner: float) -> tuple[np.ndarray, np.ndarray]:
    """Give the outline of a box with round corners."""
    if corner < 0.1:
        return _polygon(middle + half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]))
    signs = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
    arcs = [_arc(middle + sign * (half - corner), corner, n * np.pi / 2, (n + 1) * np.pi / 2) for n, sign in enumerate(signs)]
    codes = [MOVE, *[CURVE] * (3 * _ARC)] + [LINE, *[CURVE] * (3 * _ARC)] * 3 + [CLOSE]
    points = np.concatenate(arcs)
    return np.concatenate([points, points[:1]]), np.array(codes)
