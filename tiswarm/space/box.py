"""Box: the world's size and edge, ways and places in it, in NumPy; box_lanes.py has the same in lanes."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

Boundary = Literal["open", "periodic", "walls"]

# Other code asks these and compares no boundary itself: a new kind of edge answers here first.


def wraps(boundary: str) -> bool:
    """Tell whether who leaves on one side comes back on the other."""
    return boundary == "periodic"


def walled(boundary: str) -> bool:
    """Tell whether there are walls, along which agents slide, with a margin in which they turn away."""
    return boundary == "walls"


def bounded(boundary: str) -> bool:
    """Tell whether nobody is ever outside."""
    return boundary != "open"


def period(size: Sequence[float], boundary: str) -> np.ndarray:
    """Give after which length the world repeats itself along each axis: [dim], m; 0 where it does not."""
    return np.array(size if wraps(boundary) else [0.0] * len(size), float)


def displacement(way: np.ndarray, period: np.ndarray) -> np.ndarray:
    """Take the shortest image of ways [..., dim] in a world that repeats itself; period: [..., dim], m, 0 for never."""
    return way - period * np.floor(way / _length(period) + 0.5)


def wrap(place: np.ndarray, period: np.ndarray) -> np.ndarray:
    """Bring places [..., dim] back to 0 <= place < period, where that is not 0 [m]."""
    inside = place - period * np.floor(place / _length(period))
    return np.where((inside >= period) & (period > 0), 0.0, inside)  # rounding may lift a tiny negative number to the period


def inside(place: np.ndarray, size: Sequence[float]) -> np.ndarray:
    """Tell which places [..., dim] lie in the world, its edge included: [...]."""
    return np.all((place >= 0) & (place <= np.asarray(size)), axis=-1)


def _length(period: np.ndarray) -> np.ndarray:
    """Give a divisor for each period; no number of turns takes anybody around a world that does not repeat itself."""
    return np.where(period > 0, period, np.inf)
