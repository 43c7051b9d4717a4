"""How long a tuning of six weights takes, and how much of it is not the kernel: 200 generations x 32 candidates x 200 trials.

python tests/benchmarks/tune.py [GENERATIONS]
"""

import sys
import tempfile
import time

import tiswarm
from tiswarm.engine.trials.batch import Blocks
from tiswarm.simd import runtime
from tiswarm.system.machine import machine

TUNED = {"prey.strategy": "evasive", "prey.avoidance": "kitchen-sink"}
OVER = {
    "prey.weights.evade": (0.001, 0.1, "log"),
    "prey.cohesion": (0.0, 0.05),
    "prey.separation": (0.0, 0.5),
    "prey.alignment": (0.0, 0.5),
    "prey.goal": (0.01, 1.0, "log"),
    "prey.weights.reach": (0.5, 6.0),
}
CANDIDATES, TRIALS = 32, 200


def main(generations: int) -> None:
    """Tune, check the result, and print where the time went."""
    scenario = tiswarm.load("delft/pronav-10", TUNED)
    tiswarm.tune(scenario, OVER, budget=CANDIDATES * TRIALS, checks=200, validation=200)  # builds the kernels
    inside = 0.0
    launch = Blocks.advance

    def timed(*arguments: object) -> None:
        nonlocal inside
        began = time.perf_counter()
        launch(*arguments)  # type: ignore[arg-type]
        inside += time.perf_counter() - began

    Blocks.advance = timed  # type: ignore[method-assign, assignment]
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        tuned = tiswarm.tune(scenario, OVER, budget=generations * CANDIDATES * TRIALS, folder=folder)
        seconds = time.perf_counter() - began
    Blocks.advance = launch  # type: ignore[method-assign]
    told = tuned.validations[0]
    if told.difference.low <= 0:
        raise SystemExit(f"the tuned weights are not better: {told.difference}; not timed")
    searched = generations * CANDIDATES * TRIALS
    checked = sum(made.check is not None for made in tuned.history) + 1
    print(f"{machine()}, {runtime.start().threads} threads")
    print(f"{searched:,} trials searched, {checked} checks, validation: {seconds:.1f} s, {searched / seconds:,.0f} trials/s")
    print(f"in kernels {inside:.1f} s; beside them {seconds / inside - 1:.1%}")
    print(f"success {told.start.mean:.4f} to {told.tuned.mean:.4f}, paired difference {told.difference}")
    print({path: new for path, (_, new) in tuned.changes.items()})


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
