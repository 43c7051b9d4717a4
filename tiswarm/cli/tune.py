"""Tune: numbers of a scenario found by search, printed, written and drawn."""

import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
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
    begun,
    out,
    plain_name,
)
from tiswarm.system.words import safe


def _option(name: str, metavar: str | None, told: str) -> Any:
    return typer.Option(*name.split(), metavar=metavar, help=told)


_OVER = _option(
    "--over",
    "KEY=LOW:HIGH",
    "A number to find; KEY=LOW:HIGH:log on a log scale, KEY=A,B,C one of several by a race. Repeat for more.",
)
_MAXIMISE = _option("--maximise", "SUM", "What to make large: success when left out, or 'success - 0.001 time'.")
_MINIMISE = _option("--minimise", "MEASURE", "A measure to make small instead: success for predators.")
_NETWORK = _option("--network", "SIDE", "Train the network of the prey or the predators.")
_METHOD = _option("--method", "cma-es|openai-es", "How to search; openai-es, for networks when left out: in pairs.")
_ALSO = _option("--also", "PRESET", "Count this scenario, too, with the same --set; repeat for more.")
_ACROSS = _option("--across", "mean|worst", "How scenarios count together.")
_BUDGET = _option("--budget", "TRIALS", "Trials that the search may take.")
_CANDIDATES = _option("--candidates", "N", "Candidates of a generation.")
_TRIALS = _option("--trials", "N", "Trials of each candidate, the same for all; 200, or 10 for openai-es, when left out.")
_HALVE = _option("--halve", None, "Let the worse half leave after a quarter of a generation's trials, and again after half.")
_CHECKS = _option("--checks", "N", "Trials that tell which generation was best.")
_VALIDATION = _option("--validation", "N", "Trials that no search saw, on which alone the result is told.")
_OUTPUT = _option("-o --output", "DIR", "Where to write; out/tune-PRESET when left out.")
_FRESH = _option("--fresh", None, "Throw away what the folder holds, instead of going on with it.")
_CLUSTER = _option("--cluster", "ADDRESS", "Run candidates on the workers of a Dask scheduler; local or local:N starts N here.")
_FILM = _option("--film", None, "Also film start and found side by side, trial 0, as DIR/film.mp4.")


def tune(
    preset: Preset,
    over: Annotated[list[str] | None, _OVER] = None,
    maximise: Annotated[str | None, _MAXIMISE] = None,
    minimise: Annotated[str | None, _MINIMISE] = None,
    network: Annotated[str, _NETWORK] = "",
    method: Annotated[str | None, _METHOD] = None,
    also: Annotated[list[str] | None, _ALSO] = None,
    across: Annotated[str, _ACROSS] = "mean",
    budget: Annotated[int, _BUDGET] = 1_280_000,
    candidates: Annotated[int, _CANDIDATES] = 32,
    trials: Annotated[int | None, _TRIALS] = None,
    halve: Annotated[bool, _HALVE] = False,
    checks: Annotated[int, _CHECKS] = 2000,
    validation: Annotated[int, _VALIDATION] = 10_000,
    output: Annotated[Path | None, _OUTPUT] = None,
    fresh: Annotated[bool, _FRESH] = False,
    film: Annotated[bool, _FILM] = False,
    cluster: Annotated[str | None, _CLUSTER] = None,
    sets: Sets = None,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Find numbers that make an objective large, validated on new trials. A search cut short goes on where it stopped."""
    from tiswarm.cli.tune_table import watching
    from tiswarm.learning.tune import tune as search
    from tiswarm.system.owner import locked

    ranges = _ranges(over, network)
    aim = _aim(maximise, minimise)
    scenarios = begun([preset, *(also or [])], sets, seed, threads, precision, strategy_path)
    folder = output or Path("out") / f"tune-{plain_name(preset)}"
    with locked(folder), _world(cluster, threads, strategy_path) as world, watching(not quiet) as (report, finished):
        tuned = search(
            scenarios,
            ranges,
            budget,
            aim,
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
            method=method,  # type: ignore[arg-type]
            halve=halve,
            world=world,
        )
    _show(tuned, folder, film, quiet)


@contextmanager
def _world(cluster: str | None, threads: int | None, folders: list[Path] | None) -> Iterator[Any]:
    """Give what runs candidates: this process, or a cluster while it is open. Errors: as Cluster."""
    from tiswarm.engine.trials.candidates import Candidates

    if cluster is None:
        yield Candidates
        return
    from tiswarm.cluster.candidates import SharedCandidates
    from tiswarm.cluster.client import Cluster

    with Cluster(cluster, threads, [str(each.resolve()) for each in folders or []]) as workers:
        yield partial(SharedCandidates, workers)


def _ranges(over: list[str] | None, network: str) -> dict[str, Any]:
    """Read --over. Errors: WrongInput."""
    from tiswarm.learning import keys

    if not over and not network:
        raise WrongInput("tune: nothing to change; name a key, for example --over prey.weights.evade=0:0.1")
    ranges = dict(keys.read(each) for each in over or [])
    if len(ranges) < len(over or []):
        raise WrongInput("--over: a key is named twice; give it one range")
    return ranges


def _aim(maximise: str | None, minimise: str | None) -> str:
    """Say what is made large. Errors: WrongInput."""
    if maximise is not None and minimise is not None:
        raise WrongInput("--maximise, --minimise: use one of them")
    return negated(minimise) if minimise is not None else maximise or "success"


def _show(tuned: Any, folder: Path, film: bool, quiet: bool) -> None:
    """Draw, film and print what was found."""
    from tiswarm.cli import tune_figures

    can_draw = importlib.util.find_spec("matplotlib") is not None
    if can_draw:
        tune_figures.draw(tuned, folder)
    if film:
        _film(tuned, folder)
    print_tuned(tuned)
    if not quiet:
        missing = "" if can_draw else " (no figures: pip install 'tiswarm[plot]')"
        count = sum(int(made.met.sum()) for made in tuned.history)
        out.print(f"{count:,} trials searched, {tuned.seconds:.1f} s, seed {tuned.seed}; written to {folder}{missing}")


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
