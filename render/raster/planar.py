"""Planar: packed red, green, blue and opacity as the planes that video with opacity has."""

import numpy as np

LUMA = np.array((0.2126, 0.7152, 0.0722), np.float32)
"""BT.709's weights of red, green and blue."""

BLUE, RED = 1.8556, 1.5748
"""How far blue, and red, can be from luma, both ways together."""

FAINT = 0.01
"""What an opacity [byte] counts more than it is, so that four pixels that show nothing have a colour, too."""


def planar(pixels: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Give Y'CbCr 4:2:0, BT.709, limited range, and the plane of opacity.

    Four pixels share a colour in which each counts by its opacity: what can hardly be seen leaves no rim around what can.

    pixels: bytes of a frame, four to a pixel. size: width, height [px], both even.
    """
    (width, height), count = size, size[0] * size[1]
    out = np.empty(count * 5 // 2, np.uint8)
    whole = pixels.reshape(height, width, 4)
    light = whole[..., :3].astype(np.float32)
    out[:count] = (light @ (LUMA * (219 / 255)) + 16.5).reshape(-1)
    weights = whole[..., 3:] + np.float32(FAINT)
    light *= weights
    shared = _fours(light) / _fours(weights)
    luma = shared @ LUMA
    quarter = count // 4
    for n, (channel, reach) in enumerate(((2, BLUE), (0, RED))):
        plane = (shared[..., channel] - luma) * np.float32(224 / 255 / reach) + np.float32(128.5)
        out[count + n * quarter : count + (n + 1) * quarter] = plane.reshape(-1)
    out[count + 2 * quarter :] = whole[..., 3].reshape(-1)
    return out


def _fours(values: np.ndarray) -> np.ndarray:
    """Add up the values of four pixels each: [y, x, channel]."""
    rows = values[::2] + values[1::2]
    return rows[:, ::2] + rows[:, 1::2]
