"""Bench: studies run, printed, written and drawn."""

import importlib.util
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated

import typer

from tiswarm.cli.options import Precision, Quiet, Sets, StrategyPath, Threads, WrongInput, assignment, out, start


def bench(
    study: Annotated[
        str, typer.Argument(metavar="STUDY", help="A study's name (see 'tiswarm presets') or the path of its TOML file.")
    ],
    trials: Annotated[
        int | None, typer.Option("--trials", metavar="N", help="Trials per cell; the study's own number when left out.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Where to write; out/STUDY when left out.")
    ] = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Throw away what the folder holds, instead of going on with it.")
    ] = False,
    per_trial: Annotated[bool, typer.Option("--per-trial", help="Also write trials.csv, a line for every trial.")] = False,
    parquet: Annotated[bool, typer.Option("--parquet", help="Also write the tables as Parquet.")] = False,
    figures: Annotated[
        str | None,
        typer.Option("--figures", metavar="A,B", help="Any of bars, heat, pairs, scatter; none; the study's when left out."),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            "--cluster", metavar="ADDRESS", help="Run on the workers of a Dask scheduler; local or local:N starts N here."
        ),
    ] = None,
    sets: Sets = None,
    strategy_path: StrategyPath = None,
    seed: Annotated[int | None, typer.Option("--seed", metavar="N", help="Seed; the study's own when left out.")] = None,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Run a study, all its cells: text, CSV, manifest, figures. A run that was cut short goes on where it stopped."""
    from tiswarm.cli import figures as charts
    from tiswarm.cli import race
    from tiswarm.cli.progress_table import watching
    from tiswarm.learning import race_rules
    from tiswarm.studies import console, design, export, run
    from tiswarm.studies.payoffs import contest
    from tiswarm.system.files import write_text
    from tiswarm.system.owner import locked

    if trials is not None and trials < 1:
        raise WrongInput(f"--trials {trials}: use 1 or more")
    if parquet:
        export.check_parquet()
    drawn = charts.chosen(figures)
    start(seed or 0, threads, precision, strategy_path)
    folder = output or Path("out") / Path(study).stem
    rules = race_rules.rules_of(study)
    if rules is not None:
        if sets or figures or per_trial or cluster:
            told = "--set, --figures, --per-trial, --parquet and --cluster"
            raise WrongInput(f"{study}: an arms race; drop {told}, or change its file")
        race.run(rules, folder, seed, trials, fresh, quiet)
        return
    stated = design.load_study(study)
    overrides = dict(assignment(each) for each in sets or [])
    with locked(folder):
        with ExitStack() as held:
            workers = None
            if cluster is not None:
                from tiswarm.cluster.client import Cluster

                workers = held.enter_context(Cluster(cluster, threads, [str(each.resolve()) for each in strategy_path or []]))
            report_trials, finished = held.enter_context(watching(not quiet, stated.measures, workers))
            run_cells = workers.run if workers is not None else None
            report = run.run_study(study, trials, seed, report_trials, folder, fresh, overrides, finished, drawn, run_cells)
        export.write(report, folder, per_trial, parquet)
        played = contest(report)
        if played is not None:
            write_text(folder / "game.json", played.to_json())
        can_draw = importlib.util.find_spec("matplotlib") is not None
        if can_draw:
            charts.draw(report, folder, played)
    console.print_report(report, out, played)  # last: a reader such as head may have seen enough
    if not quiet:
        runs = sum(row.trials for row in report.rows)
        there = len(report.rows) - report.ran
        note = f" ({there:,} of {len(report.rows):,} cells were there)" if there else ""
        missing = "" if can_draw else " (no figures: pip install 'tiswarm[plot]')"
        on = f" on {workers.most} workers" if workers is not None else ""
        out.print(f"{runs:,} trials in {report.seconds:.1f} s{on}{note}, seed {report.seed}; written to {folder}{missing}")
