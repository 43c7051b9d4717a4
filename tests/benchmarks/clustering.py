"""Trials per second with clustering predators, beside centre steering in the same world, and with many prey.

Usage: python tests/benchmarks/clustering.py            (about a minute; writes out/benchmarks/clustering.csv)

Each figure is the best of several, after a run that compiles the kernel and whose counts must add up; works take turns.
"""

import csv
import time
from pathlib import Path

from tiswarm import load, simulate
from tiswarm.simd import runtime
from tiswarm.system.machine import machine

ROUNDS = 5
OUT = Path("out/benchmarks/clustering.csv")
WORKS = {
    "delft/cluster-10": ("delft/cluster-10", {}, 4000),
    "the same, kept labels": ("delft/cluster-10", {"predators.weights.labels": "kept"}, 4000),
    "the same, centre steering": ("delft/cluster-10", {"predators.strategy": "centre"}, 4000),
    "the same, 8 prey": ("delft/cluster-10", {"prey.count": 8}, 4000),
    "the same, 16 prey": ("delft/cluster-10", {"prey.count": 16}, 16),
}


def main() -> None:
    """Measure, print, write."""
    scenarios = {title: load(preset, overrides) for title, (preset, overrides, _) in WORKS.items()}
    best = dict.fromkeys(WORKS, 0.0)
    for scenario in scenarios.values():
        results = simulate(scenario, 16)
        assert (results.alive + results.captured + results.crashed + results.arrived == results.spawned).all()
    for _ in range(ROUNDS):
        for title, (_, _, count) in WORKS.items():
            begin = time.perf_counter()
            simulate(scenarios[title], count, seed=1)
            best[title] = max(best[title], count / (time.perf_counter() - begin))
    OUT.parent.mkdir(parents=True, exist_ok=True)
    with OUT.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["work", "trials/s", "threads", "machine"])
        for title, rate in best.items():
            writer.writerow([title, round(rate), runtime.start().threads, machine()])
            print(f"{title:28} {rate:8.0f} trials/s")


if __name__ == "__main__":
    main()
