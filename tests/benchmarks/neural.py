"""Networks beside the strategies of the thesis, in its worlds with predators, on trials that no search saw.

python tests/benchmarks/neural.py [TRIALS] [NETWORK ...]
"""

import sys
import time

import tiswarm
from tiswarm.records.manifest import processor
from tiswarm.simd import runtime

WORLDS = ("delft/centre-0", "delft/centre-10", "delft/pronav-0", "delft/pronav-10", "delft/cluster-0", "delft/cluster-10")
BY_HAND = ("baseline", "evasive", "explode", "explode-evasive", "split", "split-evasive", "jump")


def main(trials: int, networks: list[str]) -> None:
    """Print success with half a 95 % interval, a row each."""
    print(f"{processor()}, {runtime.start().threads} threads; {trials:,} trials a cell, seed 0")
    print("prey | " + " | ".join(world.removeprefix("delft/") for world in WORLDS))
    for name in (*BY_HAND, *networks):
        chosen = {"prey.strategy": "neural", "prey.weights.network": name} if name.endswith(".npz") else {"prey.strategy": name}
        cells = []
        for world in WORLDS:
            scenario = tiswarm.load(world, {"prey.avoidance": "kitchen-sink", **chosen})
            success = tiswarm.simulate(scenario, trials).summary()["success"]
            cells.append(f"{success.mean:.4f} ± {(success.high - success.low) / 2:.4f}")
        print(f"{name} | " + " | ".join(cells), flush=True)
    rate(trials)


def rate(trials: int) -> None:
    """Print how many trials a second run with the networks of delft/neural, and without."""
    for strategy in ("neural", "baseline"):
        scenario = tiswarm.load("delft/neural", {"prey.strategy": strategy})
        tiswarm.simulate(scenario, 64)
        best = 0.0
        for _ in range(3):
            began = time.perf_counter()
            tiswarm.simulate(scenario, trials)
            best = max(best, trials / (time.perf_counter() - began))
        print(f"delft/neural with {strategy}: {best:,.0f} trials/s")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000, sys.argv[2:] or ["networks/runner.npz"])
