"""Throughput: how many trials a second this machine runs, on stated work."""

import time
from dataclasses import dataclass

from tiswarm.engine.run import simulate
from tiswarm.scenario.presets import load


@dataclass(frozen=True)
class Work:
    """What is run, between which bounds its success must lie, so that no wrong result is timed, and README's rate.

    published: trials per second on the machine that README's figures come from, PUBLISHED_ON.
    """

    title: str
    preset: str
    strategy: str
    trials: int
    success: tuple[float, float]
    published: int


@dataclass(frozen=True)
class Timing:
    """rate: trials per second, the best of several runs; first_call: s, with loading or compiling the kernel."""

    rate: float
    first_call: float


PUBLISHED_ON = {"processor": "AMD EPYC", "threads": 2, "vector_bits": 512, "precision": "f32"}
"""The machine of README's figures."""

WORK = (
    Work("figure 11: evasive prey, pronav predators, 10 obstacles", "delft/pronav-10", "evasive", 16_384, (0.32, 0.39), 53_600),
    Work("figure 6: kitchen-sink, 10 obstacles, no predators", "delft/avoidance-10", "baseline", 65_536, (0.93, 0.97), 286_000),
    Work("figure 8: split-evasive prey, centre predators", "delft/centre-0", "split-evasive", 16_384, (0.93, 0.96), 91_100),
)


def measure(work: Work, seed: int = 0, repeats: int = 5) -> Timing:
    """Time a batch: check the result first, then take the best of several runs.

    Errors: RuntimeError when the result is not what this work gives.
    """
    scenario = load(work.preset, {"prey.strategy": work.strategy})
    started = time.perf_counter()
    results = simulate(scenario, work.trials, seed)
    first_call = time.perf_counter() - started
    success = float(results.success.mean())
    if not work.success[0] <= success <= work.success[1]:
        raise RuntimeError(f"{work.title}: success {success:.4f} is outside {work.success}; not timed")
    best = float("inf")
    for _ in range(repeats):
        started = time.perf_counter()
        simulate(scenario, work.trials, seed)
        best = min(best, time.perf_counter() - started)
    return Timing(work.trials / best, first_call)
