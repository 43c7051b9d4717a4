"""Trials per second by work, threads and lanes, memory of long batches, and what common random numbers gain.

Usage: python tests/benchmarks/trials.py            (three to four minutes; writes out/benchmarks/trials.csv)

Each figure comes from a process of its own, since a process has one Taichi runtime. Results are checked before they are
timed (tiswarm/engine/throughput.py); runs with different threads, and with eight lanes and sixteen, take turns, so that a busy
machine hits all alike.
"""

import csv
import json
import math
import os
import subprocess
import sys
from pathlib import Path

from tiswarm import load, simulate
from tiswarm.records.results import compare
from tiswarm.simd import width
from tiswarm.simd.runtime import LANES
from tiswarm.system.machine import machine

ROUNDS = 3
OUT = Path("out/benchmarks/trials.csv")

RATES = """
import json, sys
from tiswarm.simd import runtime
runtime.LANES = int(sys.argv[2])
import tiswarm
from tiswarm.engine.throughput import WORK, measure
tiswarm.init("f32", int(sys.argv[1]))
print(json.dumps({work.title: measure(work).rate for work in WORK}))
"""

MEMORY = """
import json, resource, sys, tiswarm
scenario = tiswarm.load("delft/avoidance-10")
tiswarm.simulate(scenario, 20_000)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
results = tiswarm.simulate(scenario, int(sys.argv[1]))
print(json.dumps((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024 / len(results.ticks)))
"""


def _measured(code: str, *arguments: int):
    done = subprocess.run([sys.executable, "-c", code, *map(str, arguments)], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def main() -> None:
    """Measure, print, write."""
    threads = [1, 2] if (os.cpu_count() or 1) > 1 else [1]
    best: dict[tuple[str, int], float] = {}
    other = width.WIDE + width.USUAL - LANES
    otherwise: dict[str, float] = {}
    for _ in range(ROUNDS):
        for count in threads:
            for title, rate in _measured(RATES, count, LANES).items():
                best[title, count] = max(rate, best.get((title, count), 0.0))
        for title, rate in _measured(RATES, threads[-1], other).items():
            otherwise[title] = max(rate, otherwise.get(title, 0.0))
    rows = [("trials/s", title, count, round(rate)) for (title, count), rate in best.items()]
    rows += [
        (f"{LANES} lanes / {other}", title, threads[-1], round(best[title, threads[-1]] / rate, 3))
        for title, rate in otherwise.items()
    ]
    for title in {title for title, _ in best}:
        if len(threads) > 1:
            rows.append(("two threads / one", title, 2, round(best[title, 2] / best[title, 1], 3)))
    rows += [
        ("bytes per trial kept", f"{count:,} trials of delft/avoidance-10", "", round(_measured(MEMORY, count), 1))
        for count in (250_000, 1_000_000)
    ]
    base = load("delft/avoidance-10")
    a = simulate(base, 10_000)
    b = simulate(base.replaced({"prey.avoidance": "directed-spiral", "prey.weights": {}}), 10_000)
    alone = math.hypot(a.summary()["success"].stderr, b.summary()["success"].stderr)
    paired = compare(a, b)["success"].stderr
    rows.append(
        ("interval, paired / independent", "kitchen-sink against directed-spiral, success", "", round(paired / alone, 3))
    )
    OUT.parent.mkdir(parents=True, exist_ok=True)
    with OUT.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["figure", "work", "threads", "value", "machine"])
        for row in rows:
            writer.writerow([*row, machine()])
            print(*row, sep="  ")


if __name__ == "__main__":
    main()
