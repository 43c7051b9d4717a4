"""Ways to search, on one budget: CMA-ES plain and halved for six weights, CMA-ES and OpenAI-ES for a network.

python tests/benchmarks/searches.py weights|network [FOLDER] [SEEDS]

Each line is told on 10 000 trials that no search saw; given again, what the folder holds is not searched again.
"""

import sys
from pathlib import Path

import tiswarm
from tiswarm.simd import runtime
from tiswarm.system.machine import machine

GAINS = {f"prey.{name}": (0.0005, 0.5, "log") for name in ("cohesion", "separation", "alignment")}
OVER = {**GAINS, "prey.goal": (0.01, 1.0, "log"), "prey.weights.reach": (0.5, 6.0), "prey.weights.evade": (0.0005, 0.1, "log")}
EVASIVE = {"prey.strategy": "evasive", "prey.avoidance": "kitchen-sink"}
LED = {"prey.strategy": "neural", "prey.avoidance": "kitchen-sink", "prey.weights.network": "networks/own-velocity.npz"}
WAYS = {
    "weights": {
        f"{name}, {trials} trials{', halved' if halve else ''}": (
            name,
            EVASIVE,
            {"over": OVER, "budget": 48_000, "candidates": 24, "trials": trials, "checks": 1000, "halve": halve},
        )
        for name in ("delft/pronav-10", "delft/centre-10")
        for trials, halve in ((80, False), (80, True), (160, True), (40, False))
    },
    "network": {
        f"{name}, {method}, {trials} trials{', halved' if halve else ''}": (
            name,
            LED,
            {
                "network": "prey",
                "budget": 192_000,
                "candidates": 48,
                "trials": trials,
                "checks": 1000,
                "halve": halve,
                "method": method,
            },
        )
        for name in ("delft/pronav-10", "delft/centre-10")
        for method, trials, halve in (
            ("cma-es", 40, False),
            ("cma-es", 40, True),
            ("cma-es", 10, False),
            ("openai-es", 40, False),
            ("openai-es", 10, False),
        )
    },
}


def main(what: str, folder: Path, seeds: int) -> None:
    """Print success on validation trials, a column a seed."""
    print(f"{machine()}, {runtime.start().threads} threads; {', '.join(f'seed {seed}' for seed in range(seeds))}")
    for title, (world, changes, asked) in WAYS[what].items():
        start = tiswarm.load(world, changes)
        cells = []
        for seed in range(seeds):
            place = folder / what / title.replace("/", "-").replace(", ", "-").replace(" ", "-") / str(seed)
            told = tiswarm.tune(start, seed=seed, folder=place, **asked).validations[0]
            cells.append(f"{told.tuned.mean:.4f} ({told.difference.mean:+.4f})")
            print(f"  {title}, seed {seed}: {cells[-1]}", file=sys.stderr, flush=True)
        print(f"{title} | {' | '.join(cells)}", flush=True)


if __name__ == "__main__":
    given = sys.argv[1:]
    main(given[0], Path(given[1] if len(given) > 1 else "out/searches"), int(given[2]) if len(given) > 2 else 3)
