"""From how many prey on a grid of neighbours is faster than comparing all pairs, in three kinds of world.

Usage: python tests/benchmarks/crossover.py         (three minutes; writes out/benchmarks/crossover.csv)

A flock sees little of its world, a hunted one is chased by hawks as well, Delft's prey see nearly all of theirs. Both ways must
agree on who is alive in the end to a few in a hundred before their times count: paths differ by rounding.
"""

import csv
import time
from pathlib import Path

import tiswarm
from tiswarm.scenario.model import Scenario, validated
from tiswarm.system.machine import machine

OUT = Path("out/benchmarks/crossover.csv")
COUNTS = (100, 200, 400, 800, 1600)
AGENTS = 12_800  # of all trials together
TICKS = 50


def flock(count: int, hunters: int = 0) -> Scenario:
    """Give boids in a periodic world, four a square metre, seen within one metre."""
    side = (count / 4) ** 0.5
    box = [[0.0, 0.0], [side, side]]
    prey = {"count": count, "perception": 1.0, "spacing": 0.3, "max_speed": 0.1, "radius": 0.05}
    hawks = {"count": hunters, "strategy": "hawk", "perception": 1.0, "radius": 0.05, "max_speed": 0.1}
    hawks["spawn"] = {"region": box, "velocity": [[0.0, 0.0], [0.0, 0.0]]}
    prey["spawn"] = {"region": box, "velocity": [[-0.1, -0.1], [0.1, 0.1]]}
    prey["strategy"] = "evasive" if hunters else "baseline"
    world = {"size": [side, side], "boundary": "periodic", "contact": "eaten", "ticks": TICKS}
    return validated({"world": world, "target": {"present": False}, "prey": prey, "predators": hawks})


def delft(count: int) -> Scenario:
    """Give the thesis's world with more prey and predators."""
    changes = {"prey.count": count, "predators.count": count // 3, "world.ticks": TICKS}
    return tiswarm.load("delft/pronav-10", changes)


WORLDS = {"flock": flock, "hunted": lambda count: flock(count, max(2, count // 50)), "delft": delft}


def measured(scenario: Scenario, trials: int) -> tuple[float, float]:
    """Give ns per agent-step and the mean number of prey alive in the end."""
    best, alive = float("inf"), 0.0
    for run in range(3):
        start = time.perf_counter()
        results = tiswarm.simulate(scenario, trials)
        if run:  # the first one compiles
            best = min(best, time.perf_counter() - start)
        alive = float(results.alive.mean())
    return best / (trials * scenario.prey.count * TICKS) * 1e9, alive


def main() -> None:
    """Measure, print, write."""
    rows = []
    for name, world in WORLDS.items():
        for count in COUNTS:
            trials = max(AGENTS // count, 8)
            ways = [measured(world(count).replaced({"world.neighbours": how}), trials) for how in ("all-pairs", "grid")]
            (pairs, alive), (grid, also) = ways
            assert abs(alive - also) <= 0.03 * count, f"{name}, {count} prey: {alive} and {also} are alive in the end"
            rows.append((name, count, round(pairs), round(grid)))
            print(f"{name:>7} {count:5}: all pairs {pairs:6.0f}, grid {grid:6.0f} ns per agent-step", flush=True)
    OUT.parent.mkdir(parents=True, exist_ok=True)
    with OUT.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["world", "prey", "all_pairs_ns", "grid_ns", "machine"])
        writer.writerows([*row, machine()] for row in rows)


if __name__ == "__main__":
    main()
