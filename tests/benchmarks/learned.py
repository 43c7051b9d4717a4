"""Weights of each strategy of the thesis, found over all six of its worlds with predators: the tuned rows of `delft-learned`.

python tests/benchmarks/learned.py [FOLDER] [STRATEGY ...]

Prints the rows as presets/studies/delft-learned.toml has them; given again, what the folder holds is not searched again.
"""

import sys
from pathlib import Path

import tiswarm
from tiswarm.simd import runtime
from tiswarm.system.machine import machine

WORLDS = ("delft/centre-0", "delft/centre-10", "delft/pronav-0", "delft/pronav-10", "delft/cluster-0", "delft/cluster-10")
BY_HAND = ("baseline", "evasive", "explode", "explode-evasive", "split", "split-evasive", "jump")
GAINS = {f"prey.{name}": (0.0005, 0.5, "log") for name in ("cohesion", "separation", "alignment")}
OVER = {**GAINS, "prey.goal": (0.01, 1.0, "log"), "prey.weights.reach": (0.5, 6.0), "prey.weights.evade": (0.0005, 0.1, "log")}


def main(folder: Path, names: list[str]) -> None:
    """Print a row for each strategy, and what it gains on trials that no search saw, the mean of all worlds."""
    print(f"# {machine()}, {runtime.start().threads} threads; 96 000 trials a search in each world, seed 0")
    for name in names:
        worlds = [tiswarm.load(world, {"prey.strategy": name, "prey.avoidance": "kitchen-sink"}) for world in WORLDS]
        over = {path: ends for path, ends in OVER.items() if path in worlds[0].numbers()}
        tuned = tiswarm.tune(worlds, over, 96_000, candidates=24, trials=80, checks=1000, folder=folder / name)
        found = tuned.scenario.numbers()
        numbers = ", ".join(f'"{path}" = {found[path]:.6g}' for path in OVER if path in found)
        gains = " ".join(f"{each.difference.mean:+.3f}" for each in tuned.validations)
        print(f'    {{ name = "{name}, tuned", "prey.strategy" = "{name}", {numbers} }},  # {gains}', flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/learned"), sys.argv[2:] or list(BY_HAND))
