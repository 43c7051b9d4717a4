"""How long 1000 trials of the hawk and of the potential take, warm.

Usage: python tests/benchmarks/models.py [ROUNDS]        (less than a minute; writes out/benchmarks/models.csv)
"""

import csv
import sys
import time
from pathlib import Path

import numpy as np

import tiswarm
from tiswarm.simd import runtime
from tiswarm.system.machine import machine

TRIALS = 1000
OUT = Path("out/benchmarks/models.csv")


def _check_hawk(results: tiswarm.Results) -> None:
    assert (results.ticks == 100).all()
    assert (results.alive == 10).all()


def _check_potential(results: tiswarm.Results) -> None:
    """All robots head one way in the end, in nearly all trials."""
    assert (results.ticks == 5000).all()
    assert np.median(results.measures["polarisation"]) > 0.999


def main() -> None:
    """Check, warm up, repeat, print, write."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    rows = []
    for preset, check in (("m20/hawk", _check_hawk), ("sanitation/potential", _check_potential)):
        scenario = tiswarm.load(preset)
        check(tiswarm.simulate(scenario, TRIALS))
        seconds = []
        for _ in range(rounds):
            start = time.perf_counter()
            tiswarm.simulate(scenario, TRIALS)
            seconds.append(time.perf_counter() - start)
        rows.append((preset, TRIALS, round(min(seconds), 4), round(max(seconds), 4)))
        print(f"{preset}: {TRIALS} trials in {min(seconds):.3f} s (worst of {rounds}: {max(seconds):.3f} s)")
    OUT.parent.mkdir(parents=True, exist_ok=True)
    with OUT.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("preset", "trials", "best_s", "worst_s", f"{machine()}, {runtime.start().threads} threads"))
        writer.writerows(rows)


if __name__ == "__main__":
    main()
