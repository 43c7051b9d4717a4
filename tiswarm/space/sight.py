"""Sight: who notices whom, for arrays of agents as pictures and labels need it; kernels have vision.py."""

import math
from typing import Literal

import numpy as np


def in_view(way: np.ndarray, velocity: np.ndarray, field_of_view: float) -> np.ndarray:
    """Tell who is in whose field of view: [agent, other], bool. Who stands has no behind.

    way: [agent, other, dim], m, from each agent to each other; velocity: [agent, dim], m/s; field_of_view: degrees.
    """
    if field_of_view >= 360:
        return np.ones(way.shape[:2], bool)
    ahead = np.einsum("aod,ad->ao", way, velocity)
    far = np.linalg.norm(way, axis=2) * np.linalg.norm(velocity, axis=1)[:, None]
    return np.asarray(ahead >= math.cos(math.radians(field_of_view) / 2) * far)


def nearest_of(distance: np.ndarray, counts: np.ndarray, nearest: int | Literal["all"]) -> np.ndarray:
    """Tell which of those that count are among each agent's nearest, those equally far with them: [agent, other], bool.

    distance: [agent, other], m; counts: [agent, other], bool.
    """
    if nearest == "all" or nearest >= distance.shape[1]:
        return counts
    ranked = np.where(counts, distance, np.inf)
    return counts & (distance <= np.partition(ranked, nearest - 1, axis=1)[:, nearest - 1 : nearest])
