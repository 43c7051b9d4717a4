"""Trials on workers of this machine against one process, and what a trial costs the client of a cluster.

Usage: python tests/benchmarks/cluster.py            (two minutes; prints)

1. `delft/pronav-10` (figure 11) in one process with all threads, and on as many workers of one thread each: outcomes are
   compared bit by bit, then timed in turns, kernels warm.
2. What the client does with a trial, by itself: a slice's outcomes travel from a worker, and a cell is put together and written
   to disk. Workers draw them here, in the shapes and ranges of real ones, so that the client is what is measured.
"""

import tempfile
import time
from pathlib import Path

import numpy as np

import tiswarm
from tiswarm.cluster.client import Cluster
from tiswarm.cluster.slices import MOST_TRIALS, Gathered
from tiswarm.engine.trials.kernel import OUTCOMES
from tiswarm.records.results import Results
from tiswarm.simd import runtime
from tiswarm.simd.threads import available_threads
from tiswarm.studies.design import cells, load_study
from tiswarm.studies.run import columns_of, outcomes_of, run_study
from tiswarm.studies.store import Ledger

ROUNDS = 3
TRIALS = 400_000
STUDY = f"""
title = "Figure 11, one row"
base = "delft/pronav-10"
trials = {TRIALS}
[[axes]]
key = "prey.strategy"
values = ["evasive"]
"""


def drawn(trials: int, seed: int) -> dict[str, np.ndarray]:
    """Draw outcomes as a worker sends them: name -> [trial]."""
    rng = np.random.default_rng(seed)
    return {name: rng.integers(0, 250 if "arrival" in name or name == "ticks" else 9, trials, np.int32) for name in OUTCOMES}


def rates(study: Path) -> None:
    """Compare, then time one process and workers in turns."""
    workers = available_threads()
    best = {"one process": 0.0, "workers": 0.0}
    with Cluster(f"local:{workers}", threads=1) as cluster:
        ours, theirs = (run_study(str(study), runner=runner).rows[0].outcomes for runner in (None, cluster.run))
        assert all(np.array_equal(ours[name], theirs[name]) for name in ours)
        for _ in range(ROUNDS):
            for name, runner in (("one process", None), ("workers", cluster.run)):
                begin = time.perf_counter()
                run_study(str(study), runner=runner)
                best[name] = max(best[name], TRIALS / (time.perf_counter() - begin))
    print(
        f"figure 11, {TRIALS:,} trials, the same bits: one process of {workers} threads {best['one process']:,.0f} trials/s, ",
        end="",
    )
    print(f"{workers} workers of one thread {best['workers']:,.0f} trials/s")


def costs(study: Path) -> None:
    """Time the client's part of many slices, and of a cell."""
    with Cluster("local:1", threads=1) as cluster:
        client = cluster._client
        futures = [client.submit(drawn, MOST_TRIALS, seed) for seed in range(8)]
        while any(each.status == "pending" for each in futures):
            time.sleep(0.05)
        begin = time.perf_counter()
        parts = [each.result() for each in futures]
        travel = (time.perf_counter() - begin) / (8 * MOST_TRIALS)
    count = 8 * MOST_TRIALS
    stated = load_study(str(study))
    cell = cells(str(study), stated, 0)[0]
    begin, gathered, whole = time.perf_counter(), Gathered(count), None
    for k, part in enumerate(parts):
        whole = gathered.put(cell, (k * MOST_TRIALS, (k + 1) * MOST_TRIALS), (part, {}))
    assert whole is not None
    outcomes = outcomes_of(Results.of(cell.scenario, 0, runtime.start(), *whole, None), stated.measures)
    joined = (time.perf_counter() - begin) / count
    assert list(outcomes) == columns_of(stated.measures)
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        ledger = Ledger(Path(folder), "s", [cell], 0, count, stated.measures, runtime.start())
        ledger.open()
        ledger.keep(cell, outcomes)
        ledger.close()
        written = (time.perf_counter() - begin) / count
        size = next((Path(folder) / "cells").glob("*.npz")).stat().st_size / count
    print(f"a trial costs the client {travel * 1e9:.0f} ns to fetch, {joined * 1e9:.0f} ns to join, ", end="")
    print(f"{written * 1e9:.0f} ns of one thread to write ({size:.1f} bytes on disk)")


def main() -> None:
    """Measure both."""
    tiswarm.init("f32")
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder) / "s.toml"
        study.write_text(STUDY, encoding="utf-8")
        costs(study)
        rates(study)


if __name__ == "__main__":
    main()
