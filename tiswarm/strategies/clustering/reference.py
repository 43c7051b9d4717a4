"""Reference: sub-swarms of prey by scikit-learn's K-means and kneed's Kneedle, outside of kernels."""

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from tiswarm.strategies.clustering.lloyd import STARTS

CAREFUL = 20
"""Starts where one fit serves all predators."""


def sub_swarms(position: np.ndarray, most: int) -> tuple[int, np.ndarray, np.ndarray]:
    """Split prey into 1 to `most` sub-swarms at the knee of the inertia.

    position: [prey, dim], m, NaN for those who are gone.

    Returns their count, [prey] the sub-swarm of each, numbered by their first prey, -1 for those who are gone, and
    [sub-swarm, dim] their centres.
    """
    here = np.isfinite(position[:, 0])
    points = position[here].astype(np.float64)
    inertias, labels = np.zeros(most), [np.arange(len(points))] * most
    for k in range(1, min(most, len(points) - 1) + 1):
        inertias[k - 1], labels[k - 1] = _fit(points, k, CAREFUL, k)
    count = _knee(inertias)
    chosen = labels[count - 1] if len(points) > 1 else np.zeros(len(points), int)
    _, first, chosen = np.unique(chosen, return_index=True, return_inverse=True)
    chosen = np.argsort(np.argsort(first))[chosen]
    label = np.full(len(position), -1)
    label[here] = chosen
    centres = [points[chosen == c].mean(axis=0) if (chosen == c).any() else np.zeros(position.shape[1]) for c in range(count)]
    return count, label, np.array(centres)


def chased(position: np.ndarray, most: int, predators: int, key: Sequence[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Choose the prey that each predator chases, as the thesis's simulator does: by fits of its own, all of them drawn anew.

    position: [prey, dim], m, NaN for those who are gone; predators: how many; key: whole numbers to draw by.

    Returns [predator] how many sub-swarms each found, [predator, prey] whether it is in centre j mod that, j = 1, 2, ..., and
    [predator, dim] that centre.
    """
    here = np.isfinite(position[:, 0])
    points = position[here].astype(np.float64)
    count, mine = np.ones(predators, int), np.zeros((predators, len(position)), bool)
    centre = np.zeros((predators, position.shape[1]))
    for j in range(predators if len(points) else 0):
        random = np.random.RandomState(np.random.SeedSequence([*key, j]).generate_state(4))
        inertias = np.zeros(most)
        for k in range(1, min(most, len(points)) + 1):
            inertias[k - 1], _ = _fit(points, k, STARTS, random)
        count[j] = _knee(inertias)
        _, label = _fit(points, count[j], STARTS, random)
        mine[j, here] = label == (j + 1) % count[j]
        centre[j] = position[mine[j]].mean(axis=0)
    return count, mine, centre


def _fit(points: np.ndarray, clusters: int, starts: int, random: Any) -> tuple[float, np.ndarray]:
    """Fit K-means; give its inertia [m²] and [point] the place of each one's centre in the fit's order."""
    from sklearn.cluster import KMeans

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # fewer different points than clusters
        fitted = KMeans(clusters, n_init=starts, random_state=random).fit(points)
    return fitted.inertia_, fitted.labels_


def _knee(inertias: np.ndarray) -> int:
    """Give the number of clusters at the knee of [k - 1] inertias, 1 where kneed finds none."""
    from kneed import KneeLocator

    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # a curve that is flat
        knee = KneeLocator(np.arange(1, len(inertias) + 1), inertias, curve="convex", direction="decreasing").knee
    return int(knee or 1)
