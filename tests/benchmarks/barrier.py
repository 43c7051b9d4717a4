"""How long 1000 trials of robots under barrier certificates take, warm.

Usage: python tests/benchmarks/barrier.py [ROUNDS]        (two minutes; writes out/benchmarks/barrier.csv)
       python tests/benchmarks/barrier.py million         (minutes: a million ticks of 2 to 20 robots who press to one point)

Checked before anything is timed: points under a certificate never come nearer than its radius, and robots cover the arena.
Seconds of the processor tell more than those of the clock where other programs run.
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
OUT = Path("out/benchmarks/barrier.csv")
UNSWEPT = {"measures.names": ["least-distance"], "coverage.cell": 0}
CASES = {
    "joint": {},
    "shared": {"barrier.form": "shared"},
    "without": {"prey.safety": "none"},
    "joint, nothing swept": UNSWEPT,
    "shared, nothing swept": UNSWEPT | {"barrier.form": "shared"},
    "without, nothing swept": UNSWEPT | {"prey.safety": "none"},
}


def _check() -> None:
    points = {"prey.drive": "point", "world.ticks": 1000}
    for form in ("joint", "shared"):
        results = tiswarm.simulate(tiswarm.load("sanitation/arena-safe", {**points, "barrier.form": form}), 100)
        assert results.measures["least-distance"].min() > 0.15 - 1e-6, "robots came too near each other"
        assert results.measures["corrected"].min() > 0.05, "nothing was corrected"
        assert results.measures["coverage"].min() > 0.5, "robots stood still"


def _press() -> None:
    """Run a million ticks with each form, and tell how near any two came."""
    still = {f"prey.{name}": 0 for name in ("separation", "alignment", "min_speed", "goal")}
    crowding = {
        "prey.strategy": "baseline",
        "prey.cohesion": 30,
        "prey.perception": 10,
        "prey.drive": "point",
        "world.ticks": 500,
    }
    for form in ("joint", "shared"):
        changes = {**still, **crowding, **UNSWEPT, "world.turn_factor": 0, "barrier.form": form}
        scenario = tiswarm.load("sanitation/arena-safe", changes)
        start = time.process_time()
        results = tiswarm.simulate(scenario, 2000, weights={"prey.count": np.resize(np.arange(2, 21), 2000)})
        least, ticks = results.measures["least-distance"].min(), int(results.ticks.sum())
        print(f"{form}: {ticks:,} ticks, least distance {least:.7f} m, {time.process_time() - start:.1f} s of all processors")
        assert least > 0.15 - 1e-6, "robots came too near each other"


def main() -> None:
    """Check, warm up, repeat in turns, print, write."""
    if sys.argv[1:] == ["million"]:
        _press()
        return
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    _check()
    scenarios = {name: tiswarm.load("sanitation/arena-safe", changes) for name, changes in CASES.items()}
    for scenario in scenarios.values():
        tiswarm.simulate(scenario, 16)
    spent: dict[str, list[tuple[float, float]]] = {name: [] for name in CASES}
    for _ in range(rounds):
        for name, scenario in scenarios.items():
            start, busy = time.perf_counter(), time.process_time()
            tiswarm.simulate(scenario, TRIALS)
            spent[name].append((time.perf_counter() - start, time.process_time() - busy))
    rows = []
    for name, each in spent.items():
        clock, busy = (min(times) for times in zip(*each, strict=True))
        rows.append((name, TRIALS, round(clock, 3), round(busy, 3)))
        print(f"{name}: {TRIALS} trials in {clock:.2f} s, {busy:.2f} s of all threads' processors (best of {rounds})")
    OUT.parent.mkdir(parents=True, exist_ok=True)
    with OUT.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("case", "trials", "best_s", "processor_s", f"{machine()}, {runtime.start().threads} threads"))
        writer.writerows(rows)


if __name__ == "__main__":
    main()
