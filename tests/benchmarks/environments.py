"""How fast environments step, beside PettingZoo's simple_tag in as many processes as we have threads, and beside VMAS's.

python tests/benchmarks/environments.py [SECONDS]; the second part needs: pip install mpe2; the third: pip install torch vmas

Ours: delft/pronav-10, 6 prey and 15 predators among 10 obstacles, capture, crash and arrival judged where moves end, actions
of all 21 given by NumPy, 54 numbers shown to each. simple_tag: 3 predators, 1 prey, 2 obstacles, soft contacts of discs, 14
or 16 numbers shown. VMAS's simple_tag: as many trials and agents as ours (15 predators, 6 prey, 10 obstacles), soft contacts,
forces given by PyTorch, places and velocities of all shown.
"""

import importlib.util
import multiprocessing
import sys
import time

import numpy as np

import tiswarm
from tiswarm.simd import runtime
from tiswarm.system.machine import machine

TRIALS = 1024


def check() -> None:
    """Check that the trials of a large environment are those of a small one."""
    many, few = (tiswarm.env("delft/pronav-10", trials, control="both") for trials in (TRIALS, 3))
    shown, other = many.reset(seed=0), few.reset(seed=0)
    generator = np.random.default_rng(0)
    for _ in range(30):
        actions = generator.uniform(-1, 1, (TRIALS, 21, 2))
        shown, paid, *_ = many.step(actions)
        other, own, *_ = few.step(actions[:3])
        if not (np.array_equal(shown[:3], other) and np.array_equal(paid[:3], own)):
            raise SystemExit("trials differ with their number; not timed")


def ours(seconds: float) -> float:
    """Step for so long; give agent-steps a second."""
    environment = tiswarm.env("delft/pronav-10", TRIALS, control="both")
    actions = np.random.default_rng(0).uniform(-1, 1, (TRIALS, 21, 2)).astype(np.float32)
    environment.reset(seed=0)
    environment.step(actions)
    steps, began = 0, time.perf_counter()
    while time.perf_counter() - began < seconds:
        environment.step(actions)
        steps += 1
    return steps * actions.shape[0] * actions.shape[1] / (time.perf_counter() - began)


def tag(seconds: float, rates: "multiprocessing.Queue[float]") -> None:
    """Step simple_tag for so long; put agent-steps a second."""
    from mpe2 import simple_tag_v3

    environment = simple_tag_v3.parallel_env(max_cycles=100)
    environment.reset(seed=0)
    generator = np.random.default_rng(0)
    steps, began = 0, time.perf_counter()
    while time.perf_counter() - began < seconds:
        if not environment.agents:
            environment.reset()
        steps += len(environment.agents)
        environment.step(dict(zip(environment.agents, generator.integers(0, 5, len(environment.agents)), strict=True)))
    rates.put(steps / (time.perf_counter() - began))


def vectorised(seconds: float) -> float:
    """Step VMAS's simple_tag, all trials in each call; give agent-steps a second."""
    import torch
    from vmas import make_env

    environment = make_env("simple_tag", TRIALS, "cpu", seed=0, num_good_agents=6, num_adversaries=15, num_landmarks=10)
    agents = len(environment.agents)
    actions = [torch.rand(TRIALS, 2) * 2 - 1 for _ in range(agents)]
    environment.reset()
    environment.step(actions)
    steps, began = 0, time.perf_counter()
    while time.perf_counter() - began < seconds:
        environment.step(actions)
        steps += 1
    return steps * TRIALS * agents / (time.perf_counter() - began)


def has(name: str) -> bool:
    """Tell whether a package is installed."""
    return importlib.util.find_spec(name) is not None


def main(seconds: float) -> None:
    """Check, then time in turns, the best of three."""
    check()
    threads = runtime.start().threads
    print(f"{machine()}, {threads} threads, {TRIALS} trials")
    own, others, batched = [], [], []
    for _ in range(3):
        own.append(ours(seconds))
        if has("vmas"):
            batched.append(vectorised(seconds))
        if not has("mpe2"):
            continue
        spawn = multiprocessing.get_context("spawn")
        rates: multiprocessing.Queue[float] = spawn.Queue()
        workers = [spawn.Process(target=tag, args=(seconds, rates)) for _ in range(threads)]
        for worker in workers:
            worker.start()
        others.append(sum(rates.get() for _ in workers))
        for worker in workers:
            worker.join()
    print("delft/pronav-10:", ", ".join(f"{rate / 1e6:.2f}" for rate in own), "million agent-steps/s")
    for name, rates_of in ((f"simple_tag of PettingZoo in {threads} processes", others), ("simple_tag of VMAS", batched)):
        if rates_of:
            told = ", ".join(f"{rate:,.0f}" for rate in rates_of)
            print(f"{name}: {told} agent-steps/s; ratio of the best: {max(own) / max(rates_of):.0f}")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 5.0)
