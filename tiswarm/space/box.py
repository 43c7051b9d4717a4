"""Box: the world's size and edge, ways and places in it, in NumPy; box_lanes.py has the same in lanes."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

Boundary = Literal["open", "periodic", "walls", "disc"]

# Other code asks these and compares no boundary itself: a new kind of edge answers here first.


def wraps(boundary: str) -> bool:
    """Tell whether who leaves on one side comes back on the other."""
    return boundary == "periodic"


def walled(boundary: str) -> bool:
    """Tell whether there are walls, along which agents slide, with a margin in which they turn away."""
    return boundary == "walls"


def rounded(boundary: str) -> bool:
    """Tell whether agents are reflected at the largest circle, or sphere, that the world's box holds."""
    return boundary == "disc"


def solid(boundary: str) -> bool:
    """Tell whether something stands at the edge of the world that stops agents, and that films show."""
    return walled(boundary) or rounded(boundary)


def bounded(boundary: str) -> bool:
    """Tell whether nobody is ever outside."""
    return boundary != "open"


def period(size: Sequence[float], boundary: str) -> np.ndarray:
    """Give after which length the world repeats itself along each axis: [dim], m; 0 where it does not."""
    return np.array(size if wraps(boundary) else [0.0] * len(size), float)


def displacement(way: np.ndarray, period: np.ndarray) -> np.ndarray:
    """Take the shortest image of ways [..., dim] in a world that repeats itself; period: [..., dim], m, 0 for never."""
    return way - period * np.floor(way / _length(period) + 0.5)


def about_first(place: np.ndarray, period: np.ndarray) -> np.ndarray:
    """Move places [..., agent, dim] to the images nearest to the first agent that is there; NaN for those who are gone.

    The plain mean of what this gives is the mean place of a swarm that an edge may cut: about one of its own, not by angles
    around the world, so that a swarm in one piece has the mean that it has without edges, to the bit.
    """
    first = np.isfinite(place).all(axis=-1).argmax(axis=-1)[..., None, None]
    origin = np.take_along_axis(place, np.broadcast_to(first, (*first.shape[:-1], place.shape[-1])), axis=-2)
    return np.where(period > 0, origin + displacement(place - origin, period), place)


def images(place: np.ndarray, period: np.ndarray) -> np.ndarray:
    """Give places [point, dim] with all their images one world further: [image, dim], those of the world itself first."""
    turns = np.stack(np.meshgrid(*[(0, 1, -1) if each > 0 else (0,) for each in period], indexing="ij"), axis=-1)
    return (turns.reshape(-1, 1, len(period)) * period + place).reshape(-1, len(period))


def wrap(place: np.ndarray, period: np.ndarray) -> np.ndarray:
    """Bring places [..., dim] back to 0 <= place < period, where that is not 0 [m]."""
    inside = place - period * np.floor(place / _length(period))
    return np.where((inside >= period) & (period > 0), 0.0, inside)  # rounding may lift a tiny negative number to the period


def disc(size: Sequence[float]) -> tuple[np.ndarray, float]:
    """Give centre [dim] and radius of the largest disc, or ball, in a box [m]."""
    return np.asarray(size, float) / 2, min(size) / 2


def inside(place: np.ndarray, size: Sequence[float], boundary: str) -> np.ndarray:
    """Tell which places [..., dim] lie in the world, its edge included: [...]."""
    if rounded(boundary):
        centre, radius = disc(size)
        return ((place - centre) ** 2).sum(axis=-1) <= radius**2
    return np.all((place >= 0) & (place <= np.asarray(size)), axis=-1)


def _length(period: np.ndarray) -> np.ndarray:
    """Give a divisor for each period; no number of turns takes anybody around a world that does not repeat itself."""
    return np.where(period > 0, period, np.inf)
