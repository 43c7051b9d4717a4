"""Prey sets for the clustering's conformance test, and the yardstick: what scikit-learn's KMeans makes of them.

Usage: python tests/conformance/clusters.py     (a quarter of an hour; writes clusters.npz beside this file)
"""

import warnings
from pathlib import Path

import numpy as np

SIZES = range(3, 31)
EACH = 180
MOST = 5
FILE = Path(__file__).with_name("clusters.npz")


def prey_sets() -> list[np.ndarray]:
    """Draw the sets: as many of each size, every other one uniform in the map of the thesis, the rest in clumps; m."""
    random = np.random.RandomState(20221)  # whose stream NumPy has frozen
    sets = []
    for count in SIZES:
        for number in range(EACH):
            if number % 2:
                sets.append(random.uniform(0, [100, 50], (count, 2)))
            else:
                middles = random.uniform(0, [100, 50], (random.randint(1, 7), 2))
                chosen = middles[random.randint(len(middles), size=count)]
                sets.append(chosen + random.normal(0, random.uniform(0.2, 5), (count, 2)))
    return sets


def inertias(points: np.ndarray) -> np.ndarray:
    """Give the inertia of K-means with 50 starts for k = 1 to MOST, 0 from as many clusters as points on [m²]."""
    from sklearn.cluster import KMeans

    found = np.zeros(MOST)
    for k in range(1, min(MOST, len(points) - 1) + 1):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # fewer different points than clusters
            found[k - 1] = KMeans(k, n_init=50 if k > 1 else 1, random_state=k).fit(points).inertia_
    return found


if __name__ == "__main__":
    np.savez_compressed(FILE, inertia=np.stack([inertias(points) for points in prey_sets()]))
