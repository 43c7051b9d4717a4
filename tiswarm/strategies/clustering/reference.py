"""Reference: sub-swarms of prey by scikit-learn's K-means and kneed's Kneedle, outside of kernels."""

import warnings

import numpy as np

STARTS = 20


def sub_swarms(position: np.ndarray, most: int) -> tuple[int, np.ndarray, np.ndarray]:
    """Split prey into 1 to `most` sub-swarms at the knee of the inertia.

    position: [prey, dim], m, NaN for those who are gone.

    Returns their count, [prey] the sub-swarm of each, numbered by their first prey, -1 for those who are gone, and
    [sub-swarm, dim] their centres.
    """
    from kneed import KneeLocator
    from sklearn.cluster import KMeans

    here = np.isfinite(position[:, 0])
    points = position[here].astype(np.float64)
    inertias, labels = np.zeros(most), [np.arange(len(points))] * most
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # fewer different points than clusters; a curve that is flat
        for k in range(1, min(most, len(points) - 1) + 1):
            fitted = KMeans(k, n_init=STARTS, random_state=k).fit(points)
            inertias[k - 1], labels[k - 1] = fitted.inertia_, fitted.labels_
        knee = KneeLocator(np.arange(1, most + 1), inertias, curve="convex", direction="decreasing").knee
    count = int(knee or 1)
    chosen = labels[count - 1] if len(points) > 1 else np.zeros(len(points), int)
    _, first, chosen = np.unique(chosen, return_index=True, return_inverse=True)
    chosen = np.argsort(np.argsort(first))[chosen]
    label = np.full(len(position), -1)
    label[here] = chosen
    centres = [points[chosen == c].mean(axis=0) if (chosen == c).any() else np.zeros(position.shape[1]) for c in range(count)]
    return count, label, np.array(centres)
