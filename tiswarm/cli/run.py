"""Run: many trials of one scenario, and how fast this machine is."""

import sys
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from tiswarm.cli.options import Precision, Preset, Quiet, Seed, Sets, StrategyPath, Threads, load_scenario, out, start


def run(
    preset: Preset,
    trials: Annotated[int, typer.Option("--trials", metavar="N", help="Trials to run: numbers 0 to N - 1.")] = 1000,
    sets: Sets = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Write trials.csv, summary.json and manifest.json here."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON on standard output.")] = False,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Run many trials of a scenario and print what came out."""
    import tiswarm
    from tiswarm import tables
    from tiswarm.files import check_writable

    start(seed, threads, precision, strategy_path)
    scenario = load_scenario(preset, sets)
    if output is not None:
        check_writable(output)  # before the work, not after it
    started = time.perf_counter()
    results = tiswarm.simulate(scenario, trials, seed, progress=not quiet)
    seconds = time.perf_counter() - started
    if output is not None:
        results.save(output, preset=preset, wall_time_s=round(seconds, 3))
    if as_json:
        sys.stdout.write(results.summary_json() + "\n")
        return
    tables.print_summary(results, out)
    if not quiet:
        out.print(f"{trials:,} trials in {seconds:.2f} s, seed {seed}" + (f"; written to {output}" if output else ""))


def speed(
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Measure this machine's throughput, with the work stated."""
    from tiswarm import results, runtime
    from tiswarm.throughput import WORK, measure

    start(seed, threads, precision)
    table = Table(title=f"{results.processor()}, {runtime.start().threads} threads, {precision}", title_justify="left")
    for head in ("work", "trials", "trials/s", "first call [s]"):
        table.add_column(head, justify="left" if head == "work" else "right")
    for work in WORK:
        if not quiet and sys.stderr.isatty():
            sys.stderr.write(f"\rmeasuring {work.title} ...\033[K\r")
        timing = measure(work, seed)
        table.add_row(work.title, f"{work.trials:,}", f"{timing.rate:,.0f}", f"{timing.first_call:.1f}")
    out.print(table)
