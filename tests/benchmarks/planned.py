"""What planned ways cost on top of the plain trial: 4000 trials among ten obstacles, warm, in turns.

Usage: python tests/benchmarks/planned.py [ROUNDS]        (less than a minute)

Plain: the straight line with the outward field, the same map, the same limit. Best of the rounds.
"""

import sys
import time

import tiswarm

TRIALS = 4000
LIMIT = {"world.ticks": 250}


def main() -> None:
    """Check, warm up, repeat in turns, print."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    planned = tiswarm.load("delft/planned-10", LIMIT)
    cases = {
        "line": planned.replaced({"prey.goal_by": "line", "prey.goal": 0.1}),
        "field": planned,
        "list": planned.replaced({"planning.plan": "list"}),
    }
    least, ticks = dict.fromkeys(cases, float("inf")), dict.fromkeys(cases, 0.0)
    for name, scenario in cases.items():
        results = tiswarm.simulate(scenario, TRIALS)
        ticks[name] = float(results.ticks.mean())
        assert results.success.mean() > (0.8 if name == "line" else 0.99)
    for _ in range(rounds):
        for name, scenario in cases.items():
            begin = time.perf_counter()
            tiswarm.simulate(scenario, TRIALS)
            least[name] = min(least[name], time.perf_counter() - begin)
    for name in cases:
        share = least[name] / least["line"] - 1
        print(f"{name}: {least[name]:.3f} s for {TRIALS} trials of {ticks[name]:.0f} ticks on average ({share:+.0%})")


if __name__ == "__main__":
    main()
