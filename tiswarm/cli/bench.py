"""Bench: studies run, printed, written and drawn."""

from pathlib import Path
from typing import Annotated, Any

import typer

from tiswarm.cli.options import Precision, Quiet, Seed, Threads, WrongInput, out, start


def bench(
    study: Annotated[
        str, typer.Argument(metavar="STUDY", help="A study's name (see 'tiswarm presets') or the path of its TOML file.")
    ],
    trials: Annotated[
        int | None, typer.Option("--trials", metavar="N", help="Trials per row; the study's own number when left out.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Where to write; out/STUDY when left out.")
    ] = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Run a table against published figures: text, CSV, manifest, bar charts."""
    from tiswarm import studies, tables

    if trials is not None and trials < 1:
        raise WrongInput(f"--trials {trials}: use 1 or more")
    start(seed, threads, precision)
    report = studies.run_study(study, trials, seed, progress=not quiet)
    folder = output or Path("out") / report.name
    report.save(folder)
    tables.print_rows(report, out)
    charts = _charts(report, folder)
    if not quiet:
        runs = sum(row.results.trials for row in report.rows)
        out.print(
            f"{runs:,} trials in {report.seconds:.1f} s, seed {seed}; written to {folder}"
            + ("" if charts else " (no charts: pip install 'tiswarm[plot]')")
        )


def _charts(report: Any, folder: Path) -> bool:
    """Draw one chart per table; tell whether matplotlib was there to do it."""
    import importlib.util

    import numpy as np

    from tiswarm.results import Z95
    from tiswarm.studies import MEASURES

    if importlib.util.find_spec("matplotlib") is None:
        return False
    from render.figures import Bars, bars

    axes = {"success": "share of prey that arrive", "time": "trial time [s]", "impact_spread": "last minus first arrival [s]"}
    for table in report.study.tables:
        rows = [row for row in report.rows if row.table.name == table.name]
        panels = []
        for measure in MEASURES:
            each = [row.estimate(measure) for row in rows]
            mean, low, high = (np.array([getattr(e, end) for e in each]) for end in ("mean", "low", "high"))
            published = np.array([row.published.get(measure, np.nan) for row in rows])
            away = np.array([Z95 * row.published_stderr(measure) for row in rows])
            names = [row.value for row in rows]
            panels.append(Bars(measure.replace("_", " "), axes[measure], names, mean, low, high, published, away))
        note = f"{table.name}: {rows[0].results.trials:,} trials a row, seed {report.seed}"
        bars(panels, folder / f"{table.name}.png", table.title, note)
    return True
