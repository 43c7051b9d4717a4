"""Replay: recordings as one page that anybody can look into, without a network or anything installed."""

import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from tiswarm.cli.options import (
    Precision,
    Quiet,
    Seed,
    Sets,
    StrategyPath,
    Threads,
    WrongInput,
    load_scenario,
    out,
    plain_name,
    start,
)

MOST = 400
"""Recordings that a gallery shows."""

HEAVY = 60_000_000
"""Pages of more bytes than this take browsers long to open."""


def replay(
    sources: Annotated[
        list[str],
        typer.Argument(
            metavar="RECORDING|PRESET|DIR",
            help="A recording (.npz), a simulation saved by the thesis's simulator (.json), a preset to run, "
            "or a folder or a study's manifest.json for a gallery; two to four recordings are compared.",
        ),
    ],
    trial: Annotated[int, typer.Option("--trial", metavar="K", help="Number of the trial to run.")] = 0,
    versus: Annotated[
        str | None,
        typer.Option("--versus", metavar="A,B[,C,D]", help="Compare the same trial under several prey strategies."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="The page; out/NAME.html when left out.")
    ] = None,
    open_it: Annotated[bool, typer.Option("--open", help="Open the page in a browser.")] = False,
    terms: Annotated[
        bool, typer.Option("--terms", help="Keep what each term adds to every velocity, to be shown as arrows.")
    ] = False,
    exact: Annotated[bool, typer.Option("--exact", help="Keep float32 instead of 16 bits a number.")] = False,
    sets: Sets = None,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Write one self-contained page that plays a trial, compares several, or shows a folder of them."""
    import render

    if output is not None and output.suffix.lower() not in (".html", ".htm"):
        raise WrongInput(f"-o {output}: a page is an .html file; write -o {output.with_suffix('.html')}")
    places = [Path(each) for each in sources]
    gallery = len(places) == 1 and (places[0].is_dir() or _is_manifest(places[0]))
    ran = not gallery and len(sources) == 1 and not _is_file(sources[0])
    if not ran and (sets or versus or seed or terms or (trial and places[0].is_dir())):
        raise WrongInput(
            f"{sources[0]}: is recorded already; replay a preset to use --set, --versus, --terms, --seed or --trial"
        )
    chosen: dict[str, Any] = {"exact": exact}
    if gallery:
        recordings, labels = _shelf(places[0], trial, threads, strategy_path)
        name = (places[0] if places[0].is_dir() else places[0].parent).resolve().name
        chosen |= {"gallery": True, "title": name}
    elif ran:
        start(seed, threads, precision, strategy_path)
        recordings, labels, name = _run(sources[0], sets, trial, seed, versus, terms)
        chosen["fields"] = [_field(each) for each in recordings]
    else:
        for folder in strategy_path or []:
            _add(folder)
        recordings, labels, name = [_loaded(each) for each in places], [each.stem for each in places], places[0].stem
    path = render.replay(recordings, output or Path("out") / f"{name}.html", labels=labels, **chosen)
    if not quiet:
        _tell(path, len(recordings))
    if open_it and not webbrowser.open(path.resolve().as_uri()):
        raise WrongInput(f"--open: no browser found; open {path} yourself")


def _tell(path: Path, count: int) -> None:
    """Say what was written."""
    many = f"{count} recordings, " if count > 1 else ""
    size = path.stat().st_size
    hint = "a film suits so many agents better" if size > HEAVY else "opens in any browser, needs no network"
    out.print(f"{path}  ({many}{size / 1000:.0f} kB; {hint})")


def _add(folder: Path) -> None:
    import tiswarm

    tiswarm.add_path(folder)


def _is_file(source: str) -> bool:
    """Tell whether a source is a recording's file rather than a preset."""
    return source.endswith((".npz", ".json"))


def _is_manifest(path: Path) -> bool:
    from tiswarm.records.saved import is_saved

    return path.suffix == ".json" and path.is_file() and path.name == "manifest.json" and not is_saved(path)


def _loaded(path: Path) -> Any:
    """Read a recording or a saved simulation."""
    import tiswarm
    from tiswarm.records.saved import load_saved

    if not _is_file(path.name):
        raise WrongInput(f"{path}: is no recording; compare two to four .npz or .json files, or use --versus with a preset")
    if not path.is_file():
        raise WrongInput(f"{path}: no such file; record one with tiswarm.record(...).save(...)")
    return load_saved(path) if path.suffix == ".json" else tiswarm.Recording.load(path)


def _shelf(place: Path, trial: int, threads: int | None, strategy_path: Sequence[Path] | None) -> tuple[list[Any], list[str]]:
    """Give the recordings of a folder, by name, or a trial of each cell of a study."""
    from tiswarm.records.saved import is_saved

    if place.is_dir():
        for folder in strategy_path or []:
            _add(folder)
        found = sorted(each for each in place.iterdir() if _is_file(each.name) and each.is_file())
        files = [each for each in found if each.suffix == ".npz" or is_saved(each)]
        if not files and (place / "manifest.json").is_file():
            return _shelf(place / "manifest.json", trial, threads, strategy_path)
        if not files:
            raise WrongInput(f"{place}: holds no recording (.npz) and no saved simulation (.json)")
        if len(files) > MOST:
            raise WrongInput(f"{place}: holds {len(files)} recordings; a gallery shows {MOST}, put some elsewhere")
        return [_loaded(each) for each in files], [each.stem for each in files]
    from tiswarm.cli.rerun import Rebuilt

    study = Rebuilt(place)
    start(0, threads, study.precision, list(strategy_path or []))
    cells = range(study.count)
    return [study.record(cell, trial) for cell in cells], [study.row(cell) for cell in cells]


def _run(
    preset: str, sets: list[str] | None, trial: int, seed: int, versus: str | None, terms: bool
) -> tuple[list[Any], list[str], str]:
    """Run a trial of a preset, or the same under several prey strategies."""
    import tiswarm

    plain = plain_name(preset)
    if versus is None:
        return [tiswarm.record(load_scenario(preset, sets), trial, seed, terms=terms)], [""], f"{plain}-{trial}"
    strategies = [each.strip() for each in versus.split(",") if each.strip()]
    if not 2 <= len(strategies) <= 4:
        raise WrongInput(f"--versus {versus}: name two to four prey strategies, for example --versus evasive,split-evasive")
    scenarios = [load_scenario(preset, [*(sets or []), f"prey.strategy={each}"]) for each in strategies]
    return [tiswarm.record(each, trial, seed, terms=terms) for each in scenarios], strategies, f"{plain}-{trial}-versus"


def _field(recording: Any) -> Any:
    """Sample the field of the avoidance, to be shown as arrows; None where there is none."""
    import render
    from tiswarm.engine.trials.trial import field

    scenario = recording.scenario
    if recording.dim != 2 or not len(recording.obstacle_radius) or scenario.prey.avoidance == "none":
        return None
    return render.Field(*field(recording, 48))
