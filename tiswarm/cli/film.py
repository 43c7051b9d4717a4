"""Film: one trial or several as a film, and the showcases."""

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any

import typer

from tiswarm.cli.options import (
    Fps,
    Precision,
    Quiet,
    Seed,
    Sets,
    Size,
    StrategyPath,
    Theme,
    Threads,
    WrongInput,
    frame_rate,
    load_scenario,
    out,
    pair,
    plain_name,
    start,
)
from tiswarm.system.files import check_writable
from tiswarm.system.progress import begin_work, reporting

FIELDS = ("field", "plan")
"""Overlays that are sampled before a film begins."""


def film(
    source: Annotated[
        str,
        typer.Argument(
            metavar="PRESET|RECORDING|MANIFEST", help="A preset to run, a recording (.npz), or a study's manifest.json."
        ),
    ],
    trial: Annotated[int, typer.Option("--trial", metavar="K", help="Number of the trial to film.")] = 0,
    cell: Annotated[
        int | None, typer.Option("--cell", metavar="N", help="With a manifest: the cell to film a trial of.")
    ] = None,
    worst: Annotated[bool, typer.Option("--worst", help="With a manifest: the cell's trial with the worst outcome.")] = False,
    median: Annotated[
        bool, typer.Option("--median", help="With a manifest: the cell's trial with the median outcome.")
    ] = False,
    best: Annotated[bool, typer.Option("--best", help="With a manifest: the cell's trial with the best outcome.")] = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="The film: .mp4, .webm or .gif; out/NAME-TRIAL.mp4 when left out."),
    ] = None,
    grid: Annotated[
        str | None, typer.Option("--grid", metavar="CxR", help="Film C x R trials at once, from --trial on.")
    ] = None,
    versus: Annotated[
        str | None,
        typer.Option("--versus", metavar="A,B[,C]", help="Film the same trial under several prey strategies, side by side."),
    ] = None,
    poster: Annotated[
        Path | None, typer.Option("--poster", metavar="FILE", help="Also write the liveliest frame as an image.")
    ] = None,
    sheet: Annotated[Path | None, typer.Option("--sheet", metavar="FILE", help="Also write a contact sheet.")] = None,
    size: Size = "1280x720",
    fps: Fps = None,
    speed: Annotated[float, typer.Option("--speed", metavar="N", help="Ticks per second of film.")] = 10.0,
    trail: Annotated[float, typer.Option("--trail", metavar="S", help="Seconds that trails last; 0 for none.")] = 2.5,
    theme: Theme = "dark",
    quality: Annotated[str, typer.Option("--quality", metavar="NAME", help="draft, good or best.")] = "good",
    camera: Annotated[
        str, typer.Option("--camera", metavar="NAME", help="fit, follow, follow:AGENT, orbit, or a box x0,y0,x1,y1.")
    ] = "fit",
    overlay: Annotated[
        str,
        typer.Option("--overlay", metavar="A,B", help="Any of perception, velocity, links, density, coverage, field, plan."),
    ] = "",
    slow: Annotated[bool, typer.Option("--slow", help="Slow motion around captures.")] = False,
    sets: Sets = None,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Run one trial and film it, or several at once, film a recording, or a trial that a study's table counted."""
    # Long by its options, of which it has many: a verb's signature is its help.
    import render

    overlays = tuple(name for name in _names(overlay) if name not in FIELDS)
    look = {"theme": theme, "speed": speed, "trail": trail, "camera": _camera(camera), "overlay": overlays, "slow": slow}
    render.Look(**look)  # wrong choices are told before anything runs
    pixels = pair(size, "--size", "1280x720")
    rate = frame_rate(fps)
    planned = output or Path("out") / "film.mp4"  # its name is not known yet, its format is
    render.check_film(planned, pixels, rate, quality)
    for image in (poster, sheet):
        if image is not None:
            render.check_image(image)
    for each in (planned, poster, sheet):
        if each is not None:
            check_writable(each.parent)
    picks = [pick for pick, wanted in (("worst", worst), ("median", median), ("best", best)) if wanted]
    if source.endswith(".json"):
        if sets or grid or versus or seed:
            raise WrongInput(f"{source}: a study's trials are what they are; drop --set, --grid, --versus and --seed")
        from tiswarm.cli.rerun import Rebuilt

        study = Rebuilt(Path(source))
        start(0, threads, study.precision, strategy_path)
        subject, name = _counted(study, cell, trial, picks, quiet)
    elif cell is not None or picks:
        raise WrongInput(f"--cell, --worst, --median, --best: {source} is no manifest; film out/STUDY/manifest.json")
    else:
        start(seed, threads, precision, strategy_path)
        subject, name = _subject(source, sets, trial, seed, grid, versus)
    for name in FIELDS:
        if name in _names(overlay):
            look["field"] = _field(subject, name)
    _film(subject, output or Path("out") / f"{name}.mp4", pixels, rate, quiet, quality=quality, **look)
    if poster is not None:
        render.poster(_again(subject), poster, size=pixels, time=_middle(subject), **look)
    if sheet is not None:
        render.sheet(_again(subject), sheet, **look)


def _played(scenario: Any, trial: int, seed: int) -> Any:
    """Give a trial to film: a recording, or a large swarm that runs while it is filmed."""
    import tiswarm
    from tiswarm.engine.choice import engine_of

    if engine_of(scenario) == "grid":
        return tiswarm.Simulation(scenario, seed, trial)
    return tiswarm.record(scenario, trial, seed)


def _again(subject: Any) -> Any:
    """Start simulations anew, which a film has used up."""
    if isinstance(subject, list):
        return [_again(each) for each in subject]
    return _played(subject.scenario, subject.trial, subject.seed) if _is_live(subject) else subject


def _is_live(subject: Any) -> bool:
    import tiswarm

    return isinstance(subject, tiswarm.Simulation)


def _middle(subject: Any) -> float | None:
    """Give the time of a live simulation's poster; a recording knows its liveliest moment."""
    subjects = subject if isinstance(subject, list) else [subject]
    return max(each.ticks for each in subjects) / 2 if any(_is_live(each) for each in subjects) else None


def _field(subject: Any, name: str) -> Any:
    """Sample the field of the obstacles of one recording, or its planned ways, to be drawn as arrows."""
    import render
    from tiswarm.engine.trials.trial import field
    from tiswarm.engine.trials.ways import planned

    if isinstance(subject, list) or _is_live(subject):
        raise WrongInput(f"--overlay {name}: needs one recorded trial; film one, of few agents")
    return render.Field(*(field if name == "field" else planned)(subject))


def _counted(study: Any, cell: int | None, trial: int, picks: list[str], quiet: bool) -> tuple[Any, str]:
    """Give a recording of a trial that a study counted, and a name for the file."""
    if cell is None:
        raise WrongInput("--cell: missing; name a cell by its number in cells.csv, for example --cell 0")
    if len(picks) + bool(trial) > 1:
        raise WrongInput("--trial, --worst, --median, --best: use one of them")
    if picks:
        trial = study.picked(cell, picks[0])
    recording = study.record(cell, trial)
    if not quiet:
        out.print(study.described(cell, trial))
    return recording, study.name(cell, trial)


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _camera(text: str) -> Any:
    """Read a camera: its name, or a box of four numbers."""
    if "," not in text:
        return text
    try:
        x0, y0, x1, y1 = map(float, text.split(","))
    except ValueError:
        raise WrongInput(f"--camera {text}: write a box as x0,y0,x1,y1, for example --camera 0,0,50,25") from None
    return ((x0, y0), (x1, y1))


def _subject(
    source: str, sets: list[str] | None, trial: int, seed: int, grid: str | None, versus: str | None
) -> tuple[Any, str]:
    """Give what to film, one recording or several, and a name for the file."""
    import tiswarm

    if source.endswith(".npz"):
        if sets or grid or versus:
            raise WrongInput(f"{source}: a recording is what it is; film a preset to use --set, --grid or --versus")
        if not Path(source).is_file():
            raise WrongInput(f"{source}: no such file; record one with tiswarm.record(...).save(...)")
        return tiswarm.Recording.load(source), Path(source).stem
    if grid and versus:
        raise WrongInput("--grid, --versus: use one of them")
    plain = plain_name(source)
    if versus:
        strategies = _names(versus)
        if len(strategies) < 2:
            raise WrongInput(f"--versus {versus}: name two prey strategies or more, for example --versus evasive,split-evasive")
        scenarios = [load_scenario(source, [*(sets or []), f"prey.strategy={name}"]) for name in strategies]
        return [_played(scenario, trial, seed) for scenario in scenarios], f"{plain}-{trial}-versus"
    scenario = load_scenario(source, sets)
    if grid:
        columns, rows = pair(grid, "--grid", "4x4")
        if not 1 <= columns * rows <= 100:
            raise WrongInput(f"--grid {grid}: film 1 to 100 trials at once")
        return [_played(scenario, trial + k, seed) for k in range(columns * rows)], f"{plain}-{trial}-grid"
    return _played(scenario, trial, seed), f"{plain}-{trial}"


def demo(
    name: Annotated[str, typer.Argument(metavar="[NAME]", help="A preset under demo/.")] = "hawk",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="The film; out/NAME.mp4 when left out.")
    ] = None,
    size: Size = "1280x720",
    fps: Fps = None,
    theme: Theme = "dark",
    seed: Annotated[int | None, typer.Option("--seed", metavar="N", help="Another seed than the showcase's.")] = None,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Simulate and film a showcase into out/."""
    import render
    import tiswarm

    pixels = pair(size, "--size", "1280x720")
    rate = frame_rate(fps)
    path = output or Path("out") / f"{name.replace('/', '-')}.mp4"
    render.check_film(path, pixels, rate)
    check_writable(path.parent)
    start(seed or 0, threads, precision)
    scenario = tiswarm.load(name)
    chosen = scenario.showcase
    subject = _played(scenario, chosen.trial, chosen.seed if seed is None else seed)
    _film(subject, path, pixels, rate, quiet, theme=theme)


def _film(subject: Any, path: Path, size: tuple[int, int], rate: Fraction | None, quiet: bool, **look: Any) -> None:
    import render

    started = time.perf_counter()
    with _frame_report(quiet) as report:
        film = render.film(subject, path, size=size, fps=rate, progress=report, **look)
    if quiet:
        return
    first, *others = subject if isinstance(subject, list) else [subject]
    what = f"{len(others) + 1} trials" if others else f"trial {first.trial}, {first.ticks} ticks"
    seconds = time.perf_counter() - started
    out.print(f"{path}  ({what}, seed {first.seed}; {film.frames / film.fps:.1f} s of film in {seconds:.1f} s)")


@contextmanager
def _frame_report(quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """Give the function that a film reports its frames to: a bar on a terminal, opened when their number is known."""
    begin_work()
    with ExitStack() as bars:
        shown: list[Callable[[int], None]] = []

        def report(done: int, total: int) -> None:
            if not shown:
                shown.append(bars.enter_context(reporting(not quiet, total, "frames")))
            shown[0](done)

        yield report
