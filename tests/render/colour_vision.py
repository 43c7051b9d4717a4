"""How colours look: contrast of luminance, difference, and what those without green cones see."""

import numpy as np

from render.raster.shapes import colour

DEUTERANOPIA = np.array([[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]])
"""Linear RGB as those without green cones see it: Machado, Oliveira and Fernandes 2009, table 1, severity 1."""

_TO_XYZ = np.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]])
_WHITE = np.array([0.95047, 1.0, 1.08883])


def luminance(light) -> float:
    """Give the relative luminance of linear light, as WCAG 2 does."""
    return float(np.dot((0.2126, 0.7152, 0.0722), light))


def contrast(a, b) -> float:
    """Give the contrast of two colours in linear light, 1 to 21 (WCAG 2)."""
    low, high = sorted((luminance(a), luminance(b)))
    return (high + 0.05) / (low + 0.05)


def over(paint, alpha: float, ground) -> np.ndarray:
    """Lay a colour over another, in linear light."""
    return np.asarray(ground) * (1 - alpha) + np.asarray(paint) * alpha


def lab(light) -> np.ndarray:
    """Turn linear light into CIELAB under D65."""
    ratio = _TO_XYZ @ np.clip(light, 0, 1) / _WHITE
    f = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def difference(one, other) -> float:
    """Give the CIEDE2000 difference of two colours in CIELAB (Sharma, Wu and Dalal 2005)."""
    chroma = (np.hypot(*one[1:]) + np.hypot(*other[1:])) / 2
    g = 0.5 * (1 - np.sqrt(chroma**7 / (chroma**7 + 25.0**7)))
    (a1, b1), (a2, b2) = ((each[1] * (1 + g), each[2]) for each in (one, other))
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = (np.degrees(np.arctan2(b, a)) % 360 for a, b in ((a1, b1), (a2, b2)))
    turn = (h2 - h1 + 180) % 360 - 180 if c1 * c2 else 0.0
    apart = 2 * np.sqrt(c1 * c2) * np.sin(np.radians(turn) / 2)
    light, c, h = (one[0] + other[0]) / 2, (c1 + c2) / 2, h1 + turn / 2 if c1 * c2 else h1 + h2
    t = (
        1
        - 0.17 * np.cos(np.radians(h - 30))
        + 0.24 * np.cos(np.radians(2 * h))
        + 0.32 * np.cos(np.radians(3 * h + 6))
        - 0.20 * np.cos(np.radians(4 * h - 63))
    )
    s_l = 1 + 0.015 * (light - 50) ** 2 / np.sqrt(20 + (light - 50) ** 2)
    s_c, s_h = 1 + 0.045 * c, 1 + 0.015 * c * t
    around = np.exp(-((((h % 360) - 275) / 25) ** 2))
    r = -2 * np.sqrt(c**7 / (c**7 + 25.0**7)) * np.sin(np.radians(60 * around))
    lighter, c, h = (other[0] - one[0]) / s_l, (c2 - c1) / s_c, apart / s_h
    return float(np.sqrt(lighter**2 + c * c + h * h + r * c * h))


def seen_apart(one: str, other: str, eyes: np.ndarray) -> float:
    """Give the difference of two colours "#rrggbb" as dichromats see them."""
    a, b = (lab(eyes @ np.array(colour(code))) for code in (one, other))
    return difference(a, b)
