"""The thesis's rows with ten obstacles and predators, each beside the same strategy with weights that were tuned for it.

python tests/benchmarks/tuned_rows.py [BUDGET] [VALIDATION]
"""

import sys

import tiswarm
from tiswarm.simd import runtime
from tiswarm.system.machine import machine

WORLDS = ("delft/centre-10", "delft/pronav-10")
PREY = ("baseline", "evasive", "explode", "explode-evasive", "jump", "split", "split-evasive")
GAINS = {f"prey.{name}": (0.0005, 0.5, "log") for name in ("cohesion", "separation", "alignment")}
OVER = {**GAINS, "prey.goal": (0.01, 1.0, "log"), "prey.weights.reach": (0.5, 6.0), "prey.weights.evade": (0.0005, 0.1, "log")}


def main(budget: int, validation: int) -> None:
    """Print success before and after, and the paired difference in standard errors."""
    print(f"{machine()}, {runtime.start().threads} threads; {budget:,} trials a search, {validation:,} for validation, seed 0")
    print("world | prey | thesis | tuned | difference | standard errors")
    sure = 0
    for world in WORLDS:
        for name in PREY:
            scenario = tiswarm.load(world, {"prey.strategy": name, "prey.avoidance": "kitchen-sink"})
            over = {path: ends for path, ends in OVER.items() if path in scenario.numbers()}
            tuned = tiswarm.tune(scenario, over, budget, candidates=24, trials=80, checks=1000, validation=validation)
            told = tuned.validations[0]
            errors = told.difference.mean / told.difference.stderr if told.difference.stderr else 0.0
            sure += errors > 3
            cells = (f"{told.start.mean:.4f}", f"{told.tuned.mean:.4f}", f"{told.difference.mean:+.4f}", f"{errors:.1f}")
            print(f"{world} | {name} | {' | '.join(cells)}", flush=True)
    print(f"better by more than three standard errors: {sure} of {len(WORLDS) * len(PREY)}")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:3]) if len(sys.argv) > 2 else (96_000, 10_000))
