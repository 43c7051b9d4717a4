"""Whole commands, from an empty kernel cache and warm: wall time as a user waits for it.

Usage: python tests/benchmarks/commands.py          (about three minutes; writes out/benchmarks/commands.csv)
"""

import csv
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tiswarm.system.machine import machine

COMMANDS = (("--help",), ("presets",), ("bench", "delft", "--fresh", "--quiet"), ("demo", "--quiet"))
WARM_ROUNDS = 3
OUT = Path("out/benchmarks/commands.csv")


def _seconds(command: tuple[str, ...], folder: str, cache: str) -> float:
    started = time.perf_counter()
    environment = {**os.environ, "TI_OFFLINE_CACHE_FILE_PATH": cache}
    subprocess.run([sys.executable, "-m", "tiswarm", *command], check=True, cwd=folder, env=environment, capture_output=True)
    return time.perf_counter() - started


def main() -> None:
    """Measure, print, write."""
    rows = []
    for command in COMMANDS:
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as cache:
            cold = _seconds(command, folder, cache)
            warm = min(_seconds(command, folder, cache) for _ in range(WARM_ROUNDS))
            rows.append(("tiswarm " + " ".join(command), round(cold, 2), round(warm, 2)))
            print(*rows[-1], sep="  ")
    OUT.parent.mkdir(parents=True, exist_ok=True)
    with OUT.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["command", "empty_cache_s", "warm_s", "machine"])
        writer.writerows((*row, machine()) for row in rows)


if __name__ == "__main__":
    main()
