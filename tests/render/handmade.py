"""Worlds made by hand for tests of what is drawn."""

import numpy as np

import tiswarm
from render.composition import Composition
from render.style import Look
from tiswarm.records.recording import Recording, Swarm

SIZE = (400, 240)
NOBODY = Swarm(
    np.zeros((1, 0, 2)), np.zeros((1, 0, 2)), np.zeros(0, "<U8"), np.zeros((1, 0), "<U12"), np.zeros((1, 0), np.int32)
)


def path(position: np.ndarray, step: np.ndarray, group: int = -1) -> Swarm:
    """Give a swarm from places [tick, agent, dim] and one velocity for all."""
    rows, count, _ = position.shape
    state, fate = np.full((rows, count), "calm", dtype="<U12"), np.full(count, "alive", dtype="<U8")
    return Swarm(position, np.broadcast_to(step, position.shape).copy(), fate, state, np.full((rows, count), group, np.int32))


def world(prey: Swarm, predators: Swarm | None = None, obstacles: int = 0, **changes: object) -> Recording:
    rows, dim = prey.position.shape[0], prey.position.shape[2]
    if predators is None:
        predators = path(np.zeros((rows, 0, dim)), np.zeros(dim))
    size = [40, 20, 12][:dim]
    box = {"region": [[0] * dim, size], "velocity": [[0] * dim, [1] * dim]}
    plain = {
        "world.size": size,
        "world.areas": [],
        "prey.spawn": box,
        "predators.spawn": box,
        "prey.avoidance": "none",
        "obstacles.count": 0,
        "obstacles.region": box["region"],
        "target.present": False,
        "target.position": [s / 2 for s in size],
    }
    scenario = tiswarm.load("delft/pronav-0", plain | {"predators.count": 0} | changes)
    at = np.random.default_rng(3).uniform(3, 9, (obstacles, dim))
    return Recording(scenario, 0, 0, prey, predators, at, np.full(obstacles, 1.5))


def picture(recording: Recording, time: float, size=SIZE, **look: object) -> tuple[Composition, np.ndarray]:
    stage = Composition(recording, size, Look(**look), yuv=False)  # type: ignore[arg-type]
    return stage, stage.frame(time, stage.canvas.blank()).reshape(size[1], size[0], 3).astype(int)
