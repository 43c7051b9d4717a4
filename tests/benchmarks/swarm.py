"""Nanoseconds per agent-step of large swarms, by size, dimensions and number of trials.

Usage: python tests/benchmarks/swarm.py [PROTOTYPE]         (two minutes; writes out/benchmarks/swarm.csv)

Boids in a periodic world, 12.6 neighbours on average: separation, cohesion, alignment, cap. One move is checked against all
pairs in NumPy before anything is timed. Times are the best of many ticks, by the clock and by the processor: on a machine with
other work the clock measures that work too; both cores free, a tick takes half its processor time. PROTOTYPE is a script that
takes AGENTS LANES MODE and prints its own figures; it runs in the same minutes.
"""

import csv
import math
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import tiswarm
from tiswarm.engine.swarms.simulation import Swarm
from tiswarm.scenario.model import Scenario, validated
from tiswarm.system.machine import machine

OUT = Path("out/benchmarks/swarm.csv")
SECONDS = 6.0
DENSITY = {2: 4.0, 3: 3.0}  # agents per m² or m³: 12.6 within 1 m
CASES = [
    (10_000, 2, 1),
    (100_000, 2, 1),
    (1_000_000, 2, 1),
    (10_000, 3, 1),
    (100_000, 3, 1),
    (1_000_000, 3, 1),
    (128_000, 2, 1),
    (2_000, 2, 64),
]


def boids(count: int, dim: int) -> Scenario:
    """Give a periodic world with room for so many boids."""
    side = (count / DENSITY[dim]) ** (1 / dim)
    prey = {"perception": 1.0, "spacing": 0.3, "max_speed": 0.1, "cohesion": 0.005, "separation": 0.05, "alignment": 0.05}
    prey["spawn"] = {"region": [[0.0] * dim, [side] * dim], "velocity": [[-0.1] * dim, [0.1] * dim]}
    world = {"size": [side] * dim, "boundary": "periodic", "contact": "none"}
    return validated({"world": world, "target": {"present": False}, "prey": prey})


def started(count: int, dim: int, trials: int) -> Swarm:
    """Give a swarm that is spread evenly at random."""
    scenario, rng = boids(count, dim), np.random.default_rng(0)
    shape = (trials, count, dim)
    return Swarm(scenario, start=(rng.random(shape) * scenario.world.size, rng.uniform(-0.1, 0.1, shape)))


def moved(scenario: Scenario, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Give the next positions of one trial by comparing all pairs."""
    prey, size = scenario.prey, np.asarray(scenario.world.size)
    away = position[:, None] - position[None]
    away -= size * np.round(away / size)
    distance = np.linalg.norm(away, axis=-1)
    near = (distance <= prey.perception) & ~np.eye(len(position), dtype=bool)
    close = near & (distance <= prey.spacing)
    share = 1.0 / np.maximum(near.sum(axis=1), 1)[:, None]
    lone = ~near.any(axis=1)[:, None]
    pull = prey.separation * np.einsum("ij,ijk->ik", close, away)
    pull -= prey.cohesion * (share * np.einsum("ij,ijk->ik", near, away) + lone * position)
    pull += prey.alignment * (share * (near @ velocity) - velocity)
    course = velocity + pull
    course *= prey.max_speed / np.maximum(np.linalg.norm(course, axis=1, keepdims=True), prey.max_speed)
    return (position + course) % size


def checked(dim: int) -> float:
    """Compare one move of 2000 boids with all pairs; give the largest difference [m]."""
    swarm = started(2_000, dim, 2)
    before = swarm.position(), swarm.velocity()
    swarm.step()
    size = np.asarray(swarm.scenario.world.size)
    worst = 0.0
    for trial in range(2):
        off = swarm.position()[trial] - moved(swarm.scenario, before[0][trial], before[1][trial])
        worst = max(worst, float(np.abs(off - size * np.round(off / size)).max()))
    assert worst < 1e-5, f"{dim}-D: off by {worst} m"
    return worst


def measured(count: int, dim: int, trials: int) -> dict[str, float]:
    """Time ticks: ns per agent-step by the clock and by the processor, of them those for the grid; bytes per agent."""
    swarm = started(count, dim, trials)
    for _ in range(5):
        swarm.step()
    best = dict.fromkeys(("clock", "processor", "grid, clock", "grid, processor"), math.inf)
    ends = time.perf_counter() + SECONDS
    while time.perf_counter() < ends:
        clock, cpu = time.perf_counter(), time.process_time()
        swarm.step()
        best["clock"] = min(best["clock"], time.perf_counter() - clock)
        best["processor"] = min(best["processor"], time.process_time() - cpu)
        clock, cpu = time.perf_counter(), time.process_time()
        swarm.grid.sort()  # the moved agents once more
        best["grid, clock"] = min(best["grid, clock"], time.perf_counter() - clock)
        best["grid, processor"] = min(best["grid, processor"], time.process_time() - cpu)
    total = count * trials
    return {name: round(value / total * 1e9, 1) for name, value in best.items()} | {
        "bytes per agent": round(swarm.grid.nbytes / total, 1)
    }


def main() -> None:
    """Check, measure, print, write."""
    tiswarm.init("f32")
    for dim in (2, 3):
        print(f"one move against all pairs, {dim}-D: off by at most {checked(dim):.1e} m")
    rows = []
    for count, dim, trials in CASES:
        figures = measured(count, dim, trials)
        rows += [(f"{trials} × {count:,}", dim, name, value) for name, value in figures.items()]
        print(f"{trials:3} × {count:9,}  {dim}-D ", "  ".join(f"{name} {value}" for name, value in figures.items()), flush=True)
        if len(sys.argv) > 1 and dim == 2 and trials == 1:
            done = subprocess.run(
                [sys.executable, sys.argv[1], str(count), "8", "x"], capture_output=True, text=True, check=True
            )
            print("    prototype:", done.stdout.strip().splitlines()[-1], flush=True)
    of = {(count, dim): value for count, dim, name, value in rows if name == "clock"}
    exponent = 1 + math.log(of["1 × 1,000,000", 2] / of["1 × 10,000", 2]) / math.log(100)
    share = of["1 × 128,000", 2] / of["64 × 2,000", 2]
    rows += [("10⁴ to 10⁶", 2, "exponent of time", round(exponent, 3)), ("64 × 2,000", 2, "rate against one", round(share, 3))]
    print(f"exponent of time against number {exponent:.3f}; 64 trials of 2,000 at {share:.3f} of the rate of one of 128,000")
    OUT.parent.mkdir(parents=True, exist_ok=True)
    with OUT.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["swarm", "dimensions", "figure", "value", "machine"])
        writer.writerows([*row, machine()] for row in rows)


if __name__ == "__main__":
    main()
