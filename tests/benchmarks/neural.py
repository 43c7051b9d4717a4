"""Networks beside the strategies of the thesis, in its worlds with predators, on trials that no search saw.

python tests/benchmarks/neural.py [TRIALS] [NETWORK ...]
"""

import sys
import time

import numpy as np

import tiswarm
from tiswarm.engine.trials.candidates import Candidates
from tiswarm.simd import runtime
from tiswarm.system.machine import machine

WORLDS = ("delft/centre-0", "delft/centre-10", "delft/pronav-0", "delft/pronav-10", "delft/cluster-0", "delft/cluster-10")
BY_HAND = ("baseline", "evasive", "explode", "explode-evasive", "split", "split-evasive", "jump")


def main(trials: int, networks: list[str]) -> None:
    """Print success with half a 95 % interval, a row each."""
    print(f"{machine()}, {runtime.start().threads} threads; {trials:,} trials a cell, seed 0")
    print("prey | " + " | ".join(world.removeprefix("delft/") for world in WORLDS))
    for name in (*BY_HAND, *networks):
        chosen = {"prey.strategy": "neural", "prey.weights.network": name} if name.endswith(".npz") else {"prey.strategy": name}
        cells = []
        for world in WORLDS:
            scenario = tiswarm.load(world, {"prey.avoidance": "kitchen-sink", **chosen})
            success = tiswarm.simulate(scenario, trials).summary()["success"]
            cells.append(f"{success.mean:.4f} ± {(success.high - success.low) / 2:.4f}")
        print(f"{name} | " + " | ".join(cells), flush=True)
    rate()


def rate() -> None:
    """Print how fast a thousand networks run in twenty trials each of delft/neural, beside the hand-made strategy."""
    led = tiswarm.load("delft/neural")
    network = led.network("prey")
    assert network is not None
    every = network.weights + np.random.default_rng(0).normal(0.0, 0.01, (1000, network.shape.size))
    crowd, plain = Candidates(led, {}), Candidates(led.replaced({"prey.strategy": "baseline"}), {})
    none, trials = np.zeros((1000, 0)), np.arange(20)
    runs = {
        "1,000 networks": lambda: crowd.run(none, trials, 0, {"prey": every}),
        "baseline": lambda: plain.run(none[:1], np.arange(20_000), 0),
    }
    for name, run in runs.items():
        run()
        best = np.inf
        for _ in range(5):
            began = time.perf_counter()
            run()
            best = min(best, time.perf_counter() - began)
        print(f"delft/neural with {name}: {20_000 / best:,.0f} trials/s")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000, sys.argv[2:] or ["networks/runner.npz"])
