"""Recordings made by hand."""

import numpy as np

from tiswarm.records.recording import Recording, Swarm
from tiswarm.scenario.model import Scenario


def recorded_prey(position, velocity=None, obstacles=(), **overrides) -> Recording:
    """Record prey that nobody hunts; position: [tick, agent, dim] or [agent, dim]; obstacles: (*centre, radius) each."""
    position = np.array(position, np.float64)
    position = position if position.ndim == 3 else position[None]
    velocity = np.zeros_like(position) if velocity is None else np.broadcast_to(np.asarray(velocity, float), position.shape)
    rows, count, dim = position.shape
    settings = {"prey.count": count, "obstacles.contact": "count", "target.present": False, "prey.spacing": 1.0}
    if dim == 3:
        settings |= {"world.size": [20, 20, 20], "prey.spawn.region": [[0, 0, 0], [1, 1, 1]], "obstacles.count": 0}
        settings |= {"prey.strategy": "lookout", "prey.spawn.velocity": [[0, 0, 0], [1, 1, 1]]}
    scenario = Scenario().replaced({**settings, **overrides})
    velocity = np.where(np.isfinite(position), velocity, np.nan)
    group = np.full((rows, count), -1)
    prey = Swarm(position, velocity, np.full(count, "alive"), np.full((rows, count), "calm"), group)
    nobody = Swarm(*np.zeros((2, rows, 0, dim)), np.zeros(0, str), np.zeros((rows, 0), str), np.zeros((rows, 0), int))
    stones = np.array(obstacles, float).reshape(-1, dim + 1)
    recording = Recording(scenario, 0, 0, prey, nobody, stones[:, :-1], stones[:, -1])
    recording.check()
    return recording
