"""How long 10 000 ticks of 4 000 particles of Vicsek take, warm.

Usage: python tests/benchmarks/vicsek.py         (half a minute)

One tick without noise is checked against all pairs in NumPy before anything is timed. Best and worst of five runs.
"""

import time

import numpy as np

import tiswarm
from tiswarm.engine.swarms.simulation import Swarm

TICKS = 10_000
LONG = {"measures.names": [], "world.ticks": 1_000_000}


def _check() -> None:
    swarm = Swarm(tiswarm.load("vicsek/flock", LONG | {"prey.weights.noise": 0.0}))
    side = swarm.scenario.world.size[0]
    place, rate = swarm.position()[0], swarm.velocity()[0]
    away = place[:, None] - place[None]
    away -= side * np.round(away / side)
    total = ((away**2).sum(axis=2) <= 1.0) @ rate
    swarm.step()
    expected = 0.03 * total / np.linalg.norm(total, axis=1)[:, None]
    off = np.linalg.norm(swarm.velocity()[0] - expected, axis=1)
    assert np.median(off) < 1e-7, "a tick is not the mean direction of neighbours"
    assert (off > 1e-4).mean() < 1e-2  # single precision may take a neighbour at the very edge for one outside


def main() -> None:
    """Check, time and print."""
    _check()
    for noise in (0.1, 1.0, 3.0):
        swarm = Swarm(tiswarm.load("vicsek/flock", LONG | {"prey.weights.noise": noise}))
        swarm.step(TICKS)  # particles gather
        spent = []
        for _ in range(5):
            begin = time.perf_counter()
            swarm.step(TICKS)
            spent.append(time.perf_counter() - begin)
        print(f"noise {noise:g}: {min(spent):.2f} to {max(spent):.2f} s for {TICKS:,} ticks of {swarm.grid.count:,} particles")


if __name__ == "__main__":
    main()
