"""Tune: numbers of a scenario found by search, printed, written and drawn."""

import importlib.util
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from tiswarm.cli.options import (
    Precision,
    Preset,
    Quiet,
    Seed,
    Sets,
    StrategyPath,
    Threads,
    WrongInput,
    load_scenario,
    out,
    start,
)
from tiswarm.system.words import safe


def tune(
    preset: Preset,
    over: Annotated[
        list[str] | None,
        typer.Option(
            "--over",
            metavar="KEY=LOW:HIGH",
            help="A number to find; KEY=LOW:HIGH:log on a log scale, KEY=A,B,C one of several by a race. Repeat for more.",
        ),
    ] = None,
    maximise: Annotated[
        str | None,
        typer.Option("--maximise", metavar="SUM", help="What to make large: success when left out, or 'success - 0.001 time'."),
    ] = None,
    minimise: Annotated[
        str | None,
        typer.Option("--minimise", metavar="MEASURE", help="A measure to make small instead: success for predators."),
    ] = None,
    network: Annotated[
        str,
        typer.Option("--network", metavar="SIDE", help="Train the network of the prey or the predators."),
    ] = "",
    also: Annotated[
        list[str] | None,
        typer.Option("--also", metavar="PRESET", help="Count this scenario, too, with the same --set; repeat for more."),
    ] = None,
    across: Annotated[str, typer.Option("--across", metavar="mean|worst", help="How scenarios count together.")] = "mean",
    budget: Annotated[int, typer.Option("--budget", metavar="TRIALS", help="Trials that the search may take.")] = 1_280_000,
    candidates: Annotated[int, typer.Option("--candidates", metavar="N", help="Candidates of a generation.")] = 32,
    trials: Annotated[
        int, typer.Option("--trials", metavar="N", help="Trials of each candidate; all of a generation meet the same ones.")
    ] = 200,
    checks: Annotated[int, typer.Option("--checks", metavar="N", help="Trials that tell which generation was best.")] = 2000,
    validation: Annotated[
        int, typer.Option("--validation", metavar="N", help="Trials that no search saw, on which alone the result is told.")
    ] = 10_000,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Where to write; out/tune-PRESET when left out.")
    ] = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Throw away what the folder holds, instead of going on with it.")
    ] = False,
    film: Annotated[
        bool, typer.Option("--film", help="Also film start and found side by side, trial 0, as DIR/film.mp4.")
    ] = False,
    sets: Sets = None,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Find numbers that make an objective large, validated on new trials. A search cut short goes on where it stopped."""
    # Long by its options: a verb's signature is its help.
    from tiswarm.cli import tune_figures
    from tiswarm.cli.tune_table import watching
    from tiswarm.learning import keys
    from tiswarm.learning.tune import tune as search
    from tiswarm.system.owner import locked

    if maximise is not None and minimise is not None:
        raise WrongInput("--maximise, --minimise: use one of them")
    if not over and not network:
        raise WrongInput("tune: nothing to change; name a key, for example --over prey.weights.evade=0:0.1")
    ranges = dict(keys.read(each) for each in over or [])
    if len(ranges) < len(over or []):
        raise WrongInput("--over: a key is named twice; give it one range")
    objective = negated(minimise) if minimise is not None else maximise or "success"
    start(seed, threads, precision, strategy_path)
    scenarios = [load_scenario(each, sets) for each in (preset, *(also or []))]
    folder = output or Path("out") / f"tune-{Path(preset).stem if preset.endswith('.toml') else preset.replace('/', '-')}"
    with locked(folder), watching(not quiet) as (report, finished):
        tuned = search(
            scenarios,
            ranges,
            budget,
            objective,
            across,  # type: ignore[arg-type]
            candidates,
            trials,
            checks,
            validation,
            seed,
            folder,
            fresh,
            network,
            progress=report,
            finished=finished,
        )
    can_draw = importlib.util.find_spec("matplotlib") is not None
    if can_draw:
        tune_figures.draw(tuned, folder)
    if film:
        _film(tuned, folder)
    print_tuned(tuned)
    if not quiet:
        missing = "" if can_draw else " (no figures: pip install 'tiswarm[plot]')"
        count = sum(len(made.scores) * trials for made in tuned.history)
        out.print(f"{count:,} trials searched, {tuned.seconds:.1f} s, seed {seed}; written to {folder}{missing}")


def _film(tuned: Any, folder: Path) -> None:
    """Film one trial as it was and as it is, under the same luck."""
    import render
    import tiswarm

    both = [tiswarm.record(each, 0, tuned.seed) for each in (tuned.starts[0], tuned.scenario)]
    render.film(both, folder / "film.mp4", labels=["start", "found"])


def negated(text: str) -> str:
    """Turn an objective's signs round: what to make small becomes what to make large."""
    from dataclasses import replace

    from tiswarm.learning.objective import Objective

    return str(Objective(tuple(replace(each, factor=-each.factor) for each in Objective.read(text).terms)))


def print_tuned(tuned: Any) -> None:
    """Print what was found, and how it fares on trials that no search saw."""
    if not tuned.improved:
        out.print("no generation's check was better than the start: the start stays")
    table = Table("key", "start", "found", title="Found", title_justify="left")
    for path, (old, new) in tuned.changes.items():
        table.add_row(
            path, *("–" if each is None else f"{each:g}" if isinstance(each, float) else str(each) for each in (old, new))
        )
    if tuned.changes:
        out.print(table)
    head = f"{tuned.objective}, {tuned.trials:,} validation trials, ± half a 95 % interval"
    table = Table("scenario", "start", "found", "paired difference", title=head, title_justify="left")
    for each in tuned.validations:
        cells = [f"{e.mean:.4f} ± {(e.high - e.low) / 2:.4f}" for e in (each.start, each.tuned)]
        away = each.difference
        table.add_row(escape(safe(each.title)), *cells, f"{away.mean:+.4f} ± {(away.high - away.low) / 2:.4f}")
    out.print(table)
