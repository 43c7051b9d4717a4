"""Run: many trials of one scenario."""

import sys
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from tiswarm.cli.options import (
    Precision,
    Preset,
    Quiet,
    Seed,
    Sets,
    StrategyPath,
    Threads,
    WrongInput,
    begun,
    out,
    plain_name,
)
from tiswarm.system.progress import reporting

SWEEPS = 6
"""Trials whose swept ground is drawn: each runs again, tick by tick."""


def run(
    preset: Preset,
    trials: Annotated[int, typer.Option("--trials", metavar="N", help="Trials to run: numbers 0 to N - 1.")] = 1000,
    sets: Sets = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Write the table of trials, summary.json and manifest.json here."),
    ] = None,
    form: Annotated[
        str | None,
        typer.Option("--format", metavar="F", help="With -o: csv, parquet or netcdf, the table of trials; csv when left out."),
    ] = None,
    plot: Annotated[
        bool,
        typer.Option("--plot", help="Also draw trial 0 against time, as PNGs: into DIR, or out/PRESET when -o is left out."),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON on standard output.")] = False,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Run many trials of a scenario and print what came out."""
    import tiswarm
    from tiswarm.records.tables import checked_form
    from tiswarm.studies import console
    from tiswarm.system.files import check_writable

    if form is not None and output is None:
        raise WrongInput(f"--format {form}: say where to write, with -o DIR")
    written = checked_form(form or "csv")
    (scenario,) = begun([preset], sets, seed, threads, precision, strategy_path)
    plots = _plots_folder(preset, output) if plot else None
    for folder in (output, plots):
        if folder is not None:
            check_writable(folder)  # before the work, not after it
    started = time.perf_counter()
    results = tiswarm.simulate(scenario, trials, seed, progress=not quiet)
    seconds = time.perf_counter() - started
    if output is not None:
        results.save(output, written, preset=preset, wall_time_s=round(seconds, 3))
    if as_json:
        sys.stdout.write(results.summary_json() + "\n")
    else:
        console.print_summary(results, out)
        if not quiet:
            out.print(f"{trials:,} trials in {seconds:.2f} s, seed {seed}" + (f"; written to {output}" if output else ""))
    if plots is not None:
        drawn = _plot(scenario, seed, trials, plots, quiet)
        if not (quiet or as_json):
            out.print("\n".join(map(str, drawn)))


def _plots_folder(preset: str, output: Path | None) -> Path:
    """Say where plots go. Errors: WrongInput when there is nothing to draw them with."""
    from render.plots.time_series import check_matplotlib

    try:
        check_matplotlib()
    except ModuleNotFoundError as error:
        raise WrongInput(f"--plot: {error}") from None
    return output or Path("out") / plain_name(preset)


def _plot(scenario: Any, seed: int, trials: int, folder: Path, quiet: bool) -> list[Path]:
    """Draw trial 0, and the ground that the first trials sweep."""
    import tiswarm
    from render.plots.time_series import draw

    count = min(trials, SWEEPS) if scenario.coverage.cell else 1
    recordings = []
    with reporting(not quiet, count, "trials") as report:
        for trial in range(count):
            recordings.append(tiswarm.record(scenario, trial, seed))
            report(trial + 1)
    return draw(recordings, folder)
