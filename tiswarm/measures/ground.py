"""Ground: which cells can be swept, and how evenly they were, in NumPy."""

from math import ceil

import numpy as np


def free_cells(cell: float, size: tuple[float, ...], centre: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Tell which cells' centres lie inside a flat world and outside obstacles: [row, column].

    cell: side of a cell [m]; centre: [obstacle, 2], radius: [obstacle], m.
    """
    x, y = ((np.arange(ceil(length / cell)) + 0.5) * cell for length in size)
    free = (x <= size[0]) & (y <= size[1])[:, None]
    for (cx, cy), r in zip(centre, radius, strict=True):
        free &= (x - cx) ** 2 + ((y - cy) ** 2)[:, None] >= r**2
    return free


def variation(total: np.ndarray, squares: np.ndarray, count: int) -> np.ndarray:
    """Give the coefficient of variation of `count` cells' visits from their sum and sum of squares, NaN before the first."""
    mean = total / count
    spread = np.sqrt(np.maximum(squares / count - mean**2, 0.0))
    return np.divide(spread, mean, out=np.full(np.shape(mean), np.nan), where=mean > 0)
