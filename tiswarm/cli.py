"""The command line: the only file that knows both tiswarm and render. Heavy imports wait until a verb needs them."""

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from rich.console import Console
from rich.table import Table

from tiswarm import __version__
from tiswarm.progress import INTERRUPTED, begin_work, heed_interrupts, listen_for_interrupts, reporting

app = typer.Typer(
    name="tiswarm",
    help="Predator-prey swarms: thousands of trials in parallel, published tables, films.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
out = Console(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else 150)

Preset = Annotated[
    str, typer.Argument(metavar="PRESET", help="A preset's name (see 'tiswarm presets') or the path of a TOML file.")
]
Seed = Annotated[int, typer.Option("--seed", metavar="N", help="Seed of all random numbers.")]
Threads = Annotated[
    int | None, typer.Option("--threads", metavar="N", help="CPU threads; all when left out. No result depends on it.")
]
Precision = Annotated[str, typer.Option("--precision", metavar="f32|f64", help="Precision of the simulation.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress bars, no notes.")]
Sets = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the scenario; repeat for more.")
]
StrategyPath = Annotated[
    list[Path] | None,
    typer.Option("--strategy-path", metavar="DIR", help="Folder with prey/, predators/ or avoidance/ files of your own."),
]
Theme = Annotated[str, typer.Option("--theme", metavar="NAME", help="dark, light or print.")]
Size = Annotated[str, typer.Option("--size", metavar="WxH", help="Width and height of the film in pixels, both even.")]
Fps = Annotated[int | None, typer.Option("--fps", metavar="N", help="Frames per second; 60, or 25 in a GIF, when left out.")]


class WrongInput(ValueError):
    """Something that the user typed cannot be; the message names the mend."""


def main() -> NoReturn:
    """Run the command line: exit code 0, 2 for wrong input, 1 for a fault, 130 for Ctrl-C; never a traceback."""
    listen_for_interrupts()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # an exception, so that half-written files are cleaned up
    try:
        code = app(standalone_mode=False)
        if code == INTERRUPTED:  # some versions of typer turn Ctrl-C into this themselves
            raise KeyboardInterrupt
        heed_interrupts()
    except (KeyboardInterrupt, typer.Abort):
        code = _complain("interrupted; nothing half-written is left", INTERRUPTED)
    except BrokenPipeError:  # the reader, such as head, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    except MemoryError:
        code = _complain("out of memory; run fewer trials or agents at once", 1)
    except RecursionError:
        code = _complain("a value is nested too deeply", 2)
    except (OSError, RuntimeError) as error:
        code = _complain(_fault(error), 1)
    except ValueError as error:
        code = _complain(str(error), 2)
    except typer.Exit as stop:
        code = stop.exit_code
    except Exception as error:
        if type(error).__module__.startswith("taichi"):  # a strategy of the user's that does not compile
            sys.exit(_complain(f"a strategy cannot be compiled: {str(error).splitlines()[-1]}", 2))
        message = getattr(error, "format_message", None)  # wrong options, as typer's own parser finds them
        if message is None:
            raise
        code = _complain(message().replace("\n", " ") or "no command given; see 'tiswarm --help'", 2)
    sys.exit(code if isinstance(code, int) else 0)


def _complain(message: str, code: int) -> int:
    sys.stderr.write(f"tiswarm: {' '.join(message.split())}\n")
    return code


def _fault(error: Exception) -> str:
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return str(error) or type(error).__name__


@app.callback(invoke_without_command=True)
def _about(
    context: typer.Context, version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False
) -> None:
    if context.invoked_subcommand is None and not version:
        out.print(context.get_help())
    if version:
        out.print(f"tiswarm {__version__}")
        raise typer.Exit


def _start(seed: int, threads: int | None, precision: str, strategy_path: list[Path] | None = None) -> None:
    """Check what every verb takes, and start Taichi."""
    import tiswarm
    from tiswarm.rng import seed_words

    for folder in strategy_path or []:
        tiswarm.add_path(folder)
    seed_words(seed)
    tiswarm.init(precision, threads)  # type: ignore[arg-type]


def _scenario(preset: str, sets: list[str] | None) -> Any:
    import tiswarm

    return tiswarm.load(preset, dict(_assignment(each) for each in sets or []))


def _assignment(text: str) -> tuple[str, Any]:
    """Read KEY=VALUE: the value as TOML, or a bare word as text."""
    import tomllib

    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise WrongInput(f"--set {text}: write KEY=VALUE, for example --set prey.strategy=evasive")
    try:
        return key.strip(), tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return key.strip(), value.strip()


def _pair(text: str, option: str, example: str) -> tuple[int, int]:
    """Read two whole numbers, written AxB."""
    first, _, second = text.lower().partition("x")
    if not (first.isdigit() and second.isdigit()):
        raise WrongInput(f"{option} {text}: write two whole numbers, for example {option} {example}")
    return int(first), int(second)


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


@app.command()
def presets(
    strategy_path: StrategyPath = None,
    seed: Seed = 0,  # noqa: ARG001 - every verb takes the same four
    threads: Threads = None,  # noqa: ARG001
    precision: Precision = "f32",  # noqa: ARG001
    quiet: Quiet = False,  # noqa: ARG001
) -> None:
    """List presets, studies and strategies, with one line each."""
    from tiswarm import presets as shelf
    from tiswarm import registry

    for folder in strategy_path or []:
        registry.add_path(folder)
    table = Table(box=None, show_header=False, pad_edge=False)
    for name, file in shelf.presets().items():
        table.add_row(name, shelf.read_toml(file).get("title", ""))
    out.print(table)
    out.print("\nStudies, for 'tiswarm bench':")
    table = Table(box=None, show_header=False, pad_edge=False)
    for name in shelf.study_names():
        table.add_row(name, shelf.read_toml(shelf.preset_folder() / "studies" / f"{name}.toml").get("title", ""))
    out.print(table)
    for kind in registry.KINDS:
        key = "prey.avoidance" if kind == "avoidance" else f"{kind}.strategy"
        out.print(f"\n{kind.capitalize()}, for '--set {key}=...':")
        table = Table(box=None, show_header=False, pad_edge=False)
        for name, line in registry.described(kind).items():
            table.add_row(name, line)
        out.print(table)


@app.command()
def show(
    preset: Annotated[
        str | None, typer.Argument(metavar="[PRESET]", help="A preset's name or the path of a TOML file.")
    ] = None,
    sets: Sets = None,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema of a scenario instead.")] = False,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,  # noqa: ARG001 - every verb takes the same four
    threads: Threads = None,  # noqa: ARG001
    precision: Precision = "f32",  # noqa: ARG001
    quiet: Quiet = False,  # noqa: ARG001
) -> None:
    """Print a scenario as TOML, defaults filled in."""
    import json

    from tiswarm import registry
    from tiswarm.scenario import Scenario

    for folder in strategy_path or []:
        registry.add_path(folder)
    if schema:
        sys.stdout.write(json.dumps(Scenario.model_json_schema(), indent=2) + "\n")
    elif preset is None:
        raise WrongInput("show: name a preset, for example 'tiswarm show delft/pronav-10', or use --schema")
    else:
        sys.stdout.write(_scenario(preset, sets).to_toml())


@app.command()
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

    _start(seed, threads, precision, strategy_path)
    scenario = _scenario(preset, sets)
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


@app.command()
def film(
    source: Annotated[str, typer.Argument(metavar="PRESET|RECORDING", help="A preset to run, or a recording (.npz).")],
    trial: Annotated[int, typer.Option("--trial", metavar="K", help="Number of the trial to film.")] = 0,
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
        str, typer.Option("--overlay", metavar="A,B", help="Any of perception, velocity, links, density, coverage.")
    ] = "",
    slow: Annotated[bool, typer.Option("--slow", help="Slow motion around captures.")] = False,
    sets: Sets = None,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Run one trial and film it, or several at once, or film a recording."""
    import render

    look = {"theme": theme, "speed": speed, "trail": trail, "camera": _camera(camera), "overlay": _names(overlay), "slow": slow}
    render.Look(**look)  # wrong choices are told before anything runs
    pixels = _pair(size, "--size", "1280x720")
    _start(seed, threads, precision, strategy_path)
    subject, name = _subject(source, sets, trial, seed, grid, versus)
    _film(subject, output or Path("out") / f"{name}.mp4", pixels, fps, quiet, quality=quality, **look)
    if poster is not None:
        render.poster(subject, poster, size=pixels, **look)
    if sheet is not None:
        render.sheet(subject, sheet, **look)


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
    plain = Path(source).stem if source.endswith(".toml") else source.replace("/", "-")
    if versus:
        strategies = _names(versus)
        if len(strategies) < 2:
            raise WrongInput(f"--versus {versus}: name two prey strategies or more, for example --versus evasive,split-evasive")
        scenarios = [_scenario(source, [*(sets or []), f"prey.strategy={name}"]) for name in strategies]
        return [tiswarm.record(scenario, trial, seed) for scenario in scenarios], f"{plain}-{trial}-versus"
    scenario = _scenario(source, sets)
    if grid:
        columns, rows = _pair(grid, "--grid", "4x4")
        if not 1 <= columns * rows <= 100:
            raise WrongInput(f"--grid {grid}: film 1 to 100 trials at once")
        return [tiswarm.record(scenario, trial + k, seed) for k in range(columns * rows)], f"{plain}-{trial}-grid"
    return tiswarm.record(scenario, trial, seed), f"{plain}-{trial}"


@app.command()
def demo(
    name: Annotated[str, typer.Argument(metavar="[NAME]", help="A preset under demo/.")] = "chase",
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
    import tiswarm

    pixels = _pair(size, "--size", "1280x720")
    _start(seed or 0, threads, precision)
    scenario = tiswarm.load(name)
    chosen = scenario.showcase
    recording = tiswarm.record(scenario, chosen.trial, chosen.seed if seed is None else seed)
    _film(recording, output or Path("out") / f"{name.replace('/', '-')}.mp4", pixels, fps, quiet, theme=theme)


def _film(subject: Any, path: Path, size: tuple[int, int], fps: int | None, quiet: bool, **look: Any) -> None:
    import render

    started = time.perf_counter()
    with _frame_report(quiet) as report:
        film = render.film(subject, path, size=size, fps=fps, progress=report, **look)
    if quiet:
        return
    first, *others = subject if isinstance(subject, list) else [subject]
    what = f"{len(others) + 1} trials" if others else f"trial {first.trial}, {first.ticks} ticks"
    seconds = time.perf_counter() - started
    out.print(f"{path}  ({what}, seed {first.seed}; {film.frames / film.fps:.1f} s of film in {seconds:.1f} s)")


@app.command()
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
    _start(seed, threads, precision)
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


@app.command()
def speed(
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Measure this machine's throughput, with the work stated."""
    from tiswarm import results, runtime
    from tiswarm.throughput import WORK, measure

    _start(seed, threads, precision)
    table = Table(title=f"{results.processor()}, {runtime.start().threads} threads, {precision}", title_justify="left")
    for head in ("work", "trials", "trials/s", "first call [s]"):
        table.add_column(head, justify="left" if head == "work" else "right")
    for work in WORK:
        if not quiet and sys.stderr.isatty():
            sys.stderr.write(f"\rmeasuring {work.title} ...\033[K\r")
        timing = measure(work, seed)
        table.add_row(work.title, f"{work.trials:,}", f"{timing.rate:,.0f}", f"{timing.first_call:.1f}")
    out.print(table)
