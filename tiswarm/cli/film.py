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
    Language,
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
    out,
    pair,
    start,
)
from tiswarm.cli.subjects import FIELDS, again, chosen, counted, field, is_live, longest, middle, names, others, played
from tiswarm.system.files import check_writable
from tiswarm.system.progress import begin_work, reporting


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
        typer.Option(
            "-o", "--output", metavar="FILE", help="The film: .mp4, .webm, .gif or .webp; out/NAME-TRIAL.mp4 by default."
        ),
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
    moment: Annotated[
        tuple[float, Path] | None,
        typer.Option("--moment", metavar="T FILE", help="Write a moment [ticks] as .pdf or .svg; a film only with -o."),
    ] = None,
    sheet: Annotated[Path | None, typer.Option("--sheet", metavar="FILE", help="Also write a contact sheet.")] = None,
    subtitles: Annotated[
        Path | None, typer.Option("--subtitles", metavar="FILE", help="Also write what happens as subtitles (.vtt).")
    ] = None,
    purpose: Annotated[
        str | None,
        typer.Option("--for", metavar="USE", help="slide, square, phone or paper: size, theme and length in one word."),
    ] = None,
    size: Annotated[
        str | None, typer.Option("--size", metavar="WxH", help="Width and height in pixels, both even; 1280x720 when left out.")
    ] = None,
    fps: Fps = None,
    speed: Annotated[
        float | None, typer.Option("--speed", metavar="N", help="Ticks per second of film; 10 when left out.")
    ] = None,
    trail: Annotated[float, typer.Option("--trail", metavar="S", help="Seconds that trails last; 0 for none.")] = 2.5,
    theme: Annotated[str | None, typer.Option("--theme", metavar="NAME", help="dark, light or print.")] = None,
    quality: Annotated[str, typer.Option("--quality", metavar="NAME", help="draft, good or best.")] = "good",
    camera: Annotated[
        str, typer.Option("--camera", metavar="NAME", help="fit, follow, follow:AGENT, orbit, or a box x0,y0,x1,y1.")
    ] = "fit",
    overlay: Annotated[
        str,
        typer.Option("--overlay", metavar="A,B", help="perception, velocity, links, pursuit, density, coverage, field, plan."),
    ] = "",
    label: Annotated[
        str, typer.Option("--label", metavar="K,L", help="Write the numbers of these agents beside them, prey first.")
    ] = "",
    chart: Annotated[
        str | None,
        typer.Option("--chart", metavar="A,B", help="Chart alive, polarisation, ...; none. Where space is left when left out."),
    ] = None,
    among: Annotated[
        int,
        typer.Option(
            "--among", metavar="N", min=0, help="Show what became of prey in N other trials, and where this one stands."
        ),
    ] = 0,
    slow: Annotated[bool, typer.Option("--slow", help="Slow motion around captures.")] = False,
    story: Annotated[
        bool, typer.Option("--story", help="Tell what happens in words, number who took part, and slow down around captures.")
    ] = False,
    cards: Annotated[bool, typer.Option("--cards/--no-cards", help="Begin and end with a card of words.")] = True,
    loop: Annotated[
        bool, typer.Option("--loop", help="Let the end run into the beginning, to be shown again and again; without cards.")
    ] = False,
    language: Language = "en",
    transparent: Annotated[
        bool,
        typer.Option("--transparent", help="Leave out the ground, to be laid over others: .webm, .webp, PNG; without cards."),
    ] = False,
    sets: Sets = None,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Run one trial and film it, or several at once, film a recording, or a trial that a study's table counted."""
    # Long: by its options, of which it has many; a verb's signature is its help.
    import render

    use = _use(purpose)
    overlays = tuple(name for name in names(overlay) if name not in FIELDS)
    printed = theme or (use.theme if use else "print")
    theme = theme or (use.theme if use else "dark")
    look = {"theme": theme, "trail": trail, "camera": _camera(camera), "overlay": overlays}
    look |= {"label": _numbers(label), "language": language, "transparent": transparent}
    look |= {"slow": slow, "story": story, "cards": cards and not (loop or transparent), "loop": loop}
    look["chart"] = None if chart is None else tuple(name for name in names(chart) if name != "none")
    render.Look(speed=10.0 if speed is None else speed, **look)  # wrong choices are told before anything runs
    pixels = use.size if use and not size else pair(size or "1280x720", "--size", "1280x720")
    rate = frame_rate(fps)
    usual = ".webm" if transparent else ".mp4"
    planned = output or Path("out") / f"film{usual}"  # its name is not known yet, its format is
    _, planned_rate = render.check_film(planned, pixels, rate, quality, transparent=transparent)
    for image in (poster, sheet):
        if image is not None:
            render.check_image(image, transparent=transparent)
    if subtitles is not None and subtitles.suffix.lower() != ".vtt":
        raise WrongInput(f"--subtitles {subtitles}: unknown format; name a file that ends in .vtt")
    if moment is not None:
        render.check_moment(moment[1])
    filmed = moment is None or output is not None
    for each in (planned if filmed else None, moment and moment[1], poster, sheet, subtitles):
        if each is not None:
            check_writable(each.parent)
    picks = [pick for pick, wanted in (("worst", worst), ("median", median), ("best", best)) if wanted]
    if source.endswith(".json"):
        if sets or grid or versus or seed:
            raise WrongInput(f"{source}: a study's trials are what they are; drop --set, --grid, --versus and --seed")
        from tiswarm.cli.rerun import Rebuilt

        study = Rebuilt(Path(source))
        start(0, threads, study.precision, strategy_path)
        subject, name = counted(study, cell, trial, picks, quiet)
    elif cell is not None or picks:
        raise WrongInput(f"--cell, --worst, --median, --best: {source} is no manifest; film out/STUDY/manifest.json")
    else:
        start(seed, threads, precision, strategy_path)
        subject, name = chosen(source, sets, trial, seed, grid, versus)
    for option, wanted in (("--subtitles", subtitles is not None), ("--story", story)):
        if wanted and (isinstance(subject, list) or is_live(subject)):
            raise WrongInput(f"{option}: needs one recorded trial; film one, of few agents")
    look["speed"] = speed if speed is not None else max(10.0, longest(subject) / use.seconds) if use else 10.0
    if among:
        look["among"] = others(source, subject, among)
    if subtitles is not None:
        render.subtitles(subject, subtitles, planned_rate, **look)
    for sampled in FIELDS:
        if sampled in names(overlay):
            look["field"] = field(subject, sampled)
    if moment is not None:
        path = render.moment(
            again(subject), moment[1], moment[0], pixels if size or use else None, **{**look, "theme": printed}
        )
        if not quiet:
            out.print(f"{path}  (tick {moment[0]:g})")
    if filmed:
        _film(subject, output or Path("out") / f"{name}{usual}", pixels, rate, quiet, quality=quality, **look)
    if poster is not None:
        render.poster(again(subject), poster, size=pixels, time=middle(subject), **look)
    if sheet is not None:
        render.sheet(again(subject), sheet, **look)


def _use(name: str | None) -> Any:
    """Give what suits a use."""
    import render

    if name is not None and name not in render.USES:
        raise WrongInput(f"--for: unknown {name!r}; use one of {', '.join(render.USES)}")
    return render.USES[name] if name else None


def _numbers(text: str) -> tuple[int, ...]:
    """Read the numbers of agents."""
    if not all(name.isdecimal() for name in names(text)):
        raise WrongInput(f"--label {text}: write agents' numbers, for example --label 3,7")
    return tuple(int(name) for name in names(text))


def _camera(text: str) -> Any:
    """Read a camera: its name, or a box of four numbers."""
    if "," not in text:
        return text
    try:
        x0, y0, x1, y1 = map(float, text.split(","))
    except ValueError:
        raise WrongInput(f"--camera {text}: write a box as x0,y0,x1,y1, for example --camera 0,0,50,25") from None
    return ((x0, y0), (x1, y1))


def demo(
    name: Annotated[str, typer.Argument(metavar="[NAME]", help="A preset under demo/.")] = "hawk",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="The film; out/NAME.mp4 when left out.")
    ] = None,
    size: Size = "1280x720",
    fps: Fps = None,
    theme: Theme = "dark",
    cards: Annotated[bool, typer.Option("--cards/--no-cards", help="Begin and end with a card of words.")] = True,
    language: Language = "en",
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
    render.Look(theme=theme, language=language)
    path = output or Path("out") / f"{name.replace('/', '-')}.mp4"
    render.check_film(path, pixels, rate)
    check_writable(path.parent)
    start(seed or 0, threads, precision)
    scenario = tiswarm.load(name)
    chosen = scenario.showcase
    subject = played(scenario, chosen.trial, chosen.seed if seed is None else seed)
    _film(subject, path, pixels, rate, quiet, theme=theme, cards=cards, language=language)


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
