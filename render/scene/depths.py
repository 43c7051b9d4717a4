"""Depths: an open 3-D world without a ground: water or air, with motes that stand still in it, by which motion is seen."""

import numpy as np

from render.raster.shapes import boxes, colour, discs
from render.scene.camera import Orbit
from render.theme import Theme

SEEN = 0.8
"""How far from the middle motes are seen, as a share of the eye's distance from it."""

ACROSS = 7
"""Motes stand in cells, one in each; so many cells, rounded to a power of two of metres, make the eye's distance."""

SIZE, STRENGTH = 1.5, 0.65
"""Radius [units of type] and opacity of a mote in the middle."""

PRIMES = np.array([73856093, 19349663, 83492791])
"""A mote's place in its cell follows from the cell's numbers, multiplied by these: the same whenever one comes by."""


def depths(theme: Theme, unit: float, camera: Orbit, window: np.ndarray) -> np.ndarray:
    """Fill a window (x0, y0, x1, y1, px) with sky, and with motes that fade with distance. unit: pixels per unit of type."""
    overhead, horizon = (colour(each) for each in theme.sky)
    low, high = window[:2], window[2:]
    edge = 2.0 ** np.round(np.log2(camera.away / ACROSS))
    reach = int(np.ceil(SEEN * camera.away / edge)) + 1
    steps = np.arange(-reach, reach + 1)
    cells = np.floor(camera.centre / edge).astype(int) + np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    spots = (cells + _scattered(cells)) * edge
    gone = np.linalg.norm(spots - camera.centre, axis=1) / (SEEN * camera.away)
    spots, gone = spots[gone < 1], gone[gone < 1]
    motes = discs(camera.place(spots), SIZE * unit * camera.nearness(spots), theme["line"], STRENGTH * (1 - gone))
    seen = theme.ground_alpha
    return np.concatenate([boxes(low, high, overhead, seen), boxes(low, high, horizon, 0.0, seen), motes])


def _scattered(cells: np.ndarray) -> np.ndarray:
    """Give three shares of one, 0 to 1, that follow from a cell's numbers [cell, 3] and look random."""
    mixed = np.bitwise_xor.reduce(cells * PRIMES, axis=1)[:, None] + np.arange(3) * 0x9E3779B9
    for shift, factor in ((16, 0x45D9F3B), (15, 0x2C1B3C6D), (16, 1)):
        mixed = ((mixed ^ (mixed >> shift)) * factor) & 0xFFFFFFFF
    return mixed / 2.0**32
