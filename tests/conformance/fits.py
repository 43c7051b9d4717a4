"""300 trials by the rule of the thesis's simulator, each predator with fits of its own, for the conformance test of `cluster`.

Usage: python tests/conformance/fits.py [TRIALS]     (four minutes, two processes; writes fits.npz beside this file)

`reference = true` asks scikit-learn for 72 fits a tick, which takes half a minute a trial. Here is the same algorithm, greedy
k-means++ and Lloyd, the best of ten starts, in NumPy for all starts of all predators at once: a third of a second.
"""

import sys
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from unittest.mock import patch

import numpy as np

FILE = Path(__file__).with_name("fits.npz")
PREY = ("baseline", "explode", "split", "jump")
STARTS = 10


def fit(points, clusters, predators, random):
    """Fit K-means for each predator: [predator] inertia, [predator, point] place of its centre in the fit's order."""
    apart = ((points[:, None] - points) ** 2).sum(axis=2)
    starts = predators * STARTS
    rows = np.arange(starts)
    seeds = [random.integers(len(points), size=starts)]
    left = apart[seeds[0]]
    for _ in range(1, clusters):
        passed = left.cumsum(axis=1)
        shares = random.random((starts, 2 + int(np.log(clusters)))) * passed[:, -1:]
        tried = np.minimum((passed[:, None] < shares[:, :, None]).sum(axis=2), len(points) - 1)
        after = np.minimum(left[:, None], apart[tried])
        best = after.sum(axis=2).argmin(axis=1)
        seeds.append(tried[rows, best])
        left = after[rows, best]
    centres, label = points[np.stack(seeds, axis=1)], None
    while True:
        away = ((points[None, None] - centres[:, :, None]) ** 2).sum(axis=3)
        before, label = label, away.argmin(axis=1)
        if before is not None and (label == before).all():
            break
        own = label[:, None] == np.arange(clusters)[None, :, None]
        size = own.sum(axis=2)[:, :, None]
        centres = np.where(size > 0, (own[..., None] * points[None, None]).sum(axis=2) / np.maximum(size, 1), centres)
    inertia = away.min(axis=1).sum(axis=1).reshape(predators, STARTS)
    best = inertia.argmin(axis=1) + np.arange(predators) * STARTS
    return inertia.min(axis=1), label[best]


@cache
def knee(inertias):
    from tiswarm.strategies.clustering import reference

    return reference._knee(np.array(inertias))


def chased(position, most, predators, key):
    """Do what `reference.chased` does."""
    here = np.isfinite(position[:, 0])
    points = position[here]
    mine = np.zeros((predators, len(position)), bool)
    if not len(points):
        return np.ones(predators, int), mine, np.zeros((predators, position.shape[1]))
    random = np.random.default_rng(key)
    inertias = np.zeros((predators, most))
    for k in range(1, min(most, len(points) - 1) + 1):
        inertias[:, k - 1], _ = fit(points, k, predators, random)
    count = np.array([knee(tuple(each)) for each in inertias])
    for k in set(count):
        _, label = fit(points, k, predators, random)
        place = np.arange(1, predators + 1) % count
        mine[:, here] |= (label == place[:, None]) & (count == k)[:, None]
    return count, mine, np.array([position[each].mean(axis=0) for each in mine])


def trials(prey, numbers):
    """Run trials: [trial], arrived and ticks."""
    import tiswarm
    from tiswarm.engine.trials.trial import Single

    tiswarm.init("f64", 1)
    scenario = tiswarm.load("delft/cluster-10", {"prey.strategy": prey, "predators.weights.reference": True})

    def nowhere(position, most):
        return 1, np.zeros(len(position), int), np.zeros((1, 2))

    found = []
    with patch.multiple("tiswarm.strategies.clustering.reference", chased=chased, sub_swarms=nowhere):
        for number in numbers:
            single = Single(scenario, 0, number)
            while not single.ended:
                single.step()
            found.append(((single.fate("prey") == "arrived").sum(), single.age))
    return np.array(found)


def main() -> None:
    """Run, write."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    jobs = [(prey, range(half, count, 2)) for prey in PREY for half in (0, 1)]
    with get_context("spawn").Pool(2) as pool:
        found = pool.starmap(trials, jobs, chunksize=1)
    kept = {}
    for k, prey in enumerate(PREY):
        kept[prey] = np.zeros((count, 2), np.int16)
        kept[prey][0::2], kept[prey][1::2] = found[2 * k], found[2 * k + 1]
    np.savez_compressed(FILE, **kept)


if __name__ == "__main__":
    main()
