"""Trials set up by hand, agent by agent, in which no common term acts unless a test asks for it."""

import numpy as np

import tiswarm
from tiswarm.engine.trials.trial import Single

STILL = {f"{kind}.{name}": 0.0 for kind in ("prey", "predators") for name in ("cohesion", "separation", "alignment", "goal")}
"""No term of the common ones acts."""

TARGET = np.array([10.0, 25.0])


def pairs(rows):
    return np.array(rows, float).reshape(-1, 2)


def single(prey, predators=(), obstacles=(), strategy="baseline", avoidance="none", predator="centre", **overrides):
    """Start a trial from rows (x, y, vx, vy) of agents and (x, y, radius) of obstacles."""
    prey, predators = (np.array(rows, float).reshape(-1, 4) for rows in (prey, predators))
    obstacles = np.array(obstacles, float).reshape(-1, 3)
    start = tiswarm.Start(prey[:, :2], prey[:, 2:], predators[:, :2], predators[:, 2:], obstacles[:, :2], obstacles[:, 2])
    chosen = {"prey.strategy": strategy, "prey.avoidance": avoidance, "predators.strategy": predator}
    keys = {key.replace("__", "."): value for key, value in overrides.items()}
    return Single(tiswarm.load("delft/pronav-10", {**chosen, **STILL, **keys}), 0, 0, start)


def stepped(*args, **kwargs):
    trial = single(*args, **kwargs)
    trial.step()
    return trial


FAR_PREDATOR = [(90, 45, 0, 0)]
