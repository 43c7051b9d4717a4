"""The command line: the only file that knows both tiswarm and render. Heavy imports wait until a verb needs them."""

import math
import signal
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from rich.console import Console
from rich.table import Table

from tiswarm import __version__

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
Size = Annotated[str, typer.Option("--size", metavar="WxH", help="Width and height of the film in pixels, both even.")]
Fps = Annotated[int, typer.Option("--fps", metavar="N", help="Frames per second.")]


INTERRUPTED = 130


class WrongInput(ValueError):
    """Something that the user typed cannot be; the message names the mend."""


def main() -> NoReturn:
    """Run the command line: exit code 0, 2 for wrong input, 1 for a fault, 130 for Ctrl-C; never a traceback."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # an exception, so that half-written files are cleaned up
    try:
        code = app(standalone_mode=False)
        if code == INTERRUPTED:  # some versions of typer turn Ctrl-C into this themselves
            raise KeyboardInterrupt
    except (KeyboardInterrupt, typer.Abort):
        code = _complain("interrupted; nothing half-written is left", INTERRUPTED)
    except (OSError, RuntimeError) as error:
        code = _complain(_fault(error), 1)
    except ValueError as error:
        code = _complain(str(error), 2)
    except typer.Exit as stop:
        code = stop.exit_code
    except Exception as error:
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


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.lower().partition("x")
    if not (width.isdigit() and height.isdigit()):
        raise WrongInput(f"--size {text}: write WIDTHxHEIGHT, for example --size 1280x720")
    return int(width), int(height)


@contextmanager
def _frame_bar(quiet: bool):
    """Give the function that a film reports its frames to: a bar on a terminal."""
    from tiswarm.progress import reporting

    if quiet or not sys.stderr.isatty():
        yield None
        return
    bars: list[Any] = []

    def report(done: int, total: int) -> None:
        if not bars:
            bars.append(reporting(True, total, "frames"))
            bars.append(bars[0].__enter__())
        bars[1](done)

    try:
        yield report
    finally:
        if bars:
            bars[0].__exit__(None, None, None)


@app.command()
def presets() -> None:
    """List presets and studies, with one line each."""
    from tiswarm import registry, scenario

    table = Table(box=None, show_header=False, pad_edge=False)
    for name, file in scenario.presets().items():
        table.add_row(name, scenario.read_toml(file).get("title", ""))
    out.print(table)
    out.print("\nStudies, for 'tiswarm bench':")
    table = Table(box=None, show_header=False, pad_edge=False)
    for name in scenario.study_names():
        table.add_row(name, scenario.read_toml(scenario.preset_folder() / "studies" / f"{name}.toml").get("title", ""))
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

    _start(seed, threads, precision, strategy_path)
    scenario = _scenario(preset, sets)
    started = time.perf_counter()
    results = tiswarm.simulate(scenario, trials, seed, progress=not quiet)
    seconds = time.perf_counter() - started
    if output is not None:
        results.save(output, preset=preset, wall_time_s=round(seconds, 3))
    if as_json:
        sys.stdout.write(results.summary_json() + "\n")
        return
    table = Table(title=scenario.title, title_justify="left")
    for head in ("", "mean", "± stderr", "95 % interval"):
        table.add_column(head, justify="left" if not head else "right")
    for name, each in results.summary().items():
        table.add_row(name, f"{each.mean:.4f}", f"{each.stderr:.4f}", f"{each.low:.4f} … {each.high:.4f}")
    out.print(table)
    if not quiet:
        out.print(f"{trials:,} trials in {seconds:.2f} s, seed {seed}" + (f"; written to {output}" if output else ""))


@app.command()
def film(
    source: Annotated[str, typer.Argument(metavar="PRESET|RECORDING", help="A preset to run, or a recording (.npz).")],
    trial: Annotated[int, typer.Option("--trial", metavar="K", help="Number of the trial to film.")] = 0,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="The film; out/NAME-TRIAL.mp4 when left out.")
    ] = None,
    size: Size = "1280x720",
    fps: Fps = 60,
    sets: Sets = None,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Run one trial and film it, or film a recording."""
    import tiswarm

    pixels = _size(size)
    _start(seed, threads, precision, strategy_path)
    if source.endswith(".npz"):
        if sets:
            raise WrongInput("--set: a recording is what it is; film a preset to change its keys")
        if not Path(source).is_file():
            raise WrongInput(f"{source}: no such file; record one with tiswarm.record(...).save(...)")
        recording = tiswarm.Recording.load(source)
        name = Path(source).stem
    else:
        recording = tiswarm.record(_scenario(source, sets), trial, seed)
        name = f"{Path(source).stem if source.endswith('.toml') else source.replace('/', '-')}-{trial}"
    _film(recording, output or Path("out") / f"{name}.mp4", pixels, fps, quiet)


@app.command()
def demo(
    name: Annotated[str, typer.Argument(metavar="[NAME]", help="A preset under demo/.")] = "chase",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="The film; out/NAME.mp4 when left out.")
    ] = None,
    size: Size = "1280x720",
    fps: Fps = 60,
    seed: Annotated[int | None, typer.Option("--seed", metavar="N", help="Another seed than the showcase's.")] = None,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Simulate and film a showcase into out/."""
    import tiswarm

    pixels = _size(size)
    _start(seed or 0, threads, precision)
    scenario = tiswarm.load(name)
    chosen = scenario.showcase
    recording = tiswarm.record(scenario, chosen.trial, chosen.seed if seed is None else seed)
    _film(recording, output or Path("out") / f"{name.replace('/', '-')}.mp4", pixels, fps, quiet)


def _film(recording: Any, path: Path, size: tuple[int, int], fps: int, quiet: bool) -> None:
    import render

    started = time.perf_counter()
    with _frame_bar(quiet) as report:
        render.film(recording, path, size=size, fps=fps, progress=report)
    if not quiet:
        seconds = time.perf_counter() - started
        out.print(
            f"{path}  ({recording.ticks} ticks, trial {recording.trial}, seed {recording.seed}; filmed in {seconds:.1f} s)"
        )


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
    from tiswarm import studies

    if trials is not None and trials < 1:
        raise WrongInput(f"--trials {trials}: use 1 or more")
    _start(seed, threads, precision)
    report = studies.run_study(study, trials, seed, progress=not quiet)
    folder = output or Path("out") / report.name
    report.save(folder)
    _print_rows(report)
    charts = _charts(report, folder)
    if not quiet:
        runs = sum(row.results.trials for row in report.rows)
        out.print(
            f"{runs:,} trials in {report.seconds:.1f} s, seed {seed}; written to {folder}"
            + ("" if charts else " (no charts: pip install 'tiswarm[plot]')")
        )


def _print_rows(report: Any) -> None:
    from tiswarm.studies import MEASURES

    table = Table(title=f"{report.study.title}\n{report.study.source}", title_justify="left")
    table.add_column("table")
    table.add_column("row")
    for measure in MEASURES:
        for head in (f"{measure} ± stderr", "published", "z"):
            table.add_column(head, justify="right", no_wrap=True)
    last = None
    for row in report.rows:
        if last not in (None, row.table.name):
            table.add_section()
        cells = []
        for measure in MEASURES:
            ours, digits = row.estimate(measure), 4 if measure == "success" else 2
            published = row.published.get(measure)
            cells += [
                f"{ours.mean:.{digits}f} ± {ours.stderr:.{digits}f}",
                "" if published is None else f"{published:.{digits}f}",
            ]
            cells.append("" if published is None else f"{row.z(measure):+.2f}")
        table.add_row("" if row.table.name == last else row.table.name, row.value, *cells)
        last = row.table.name
    out.print(table)
    for name, measures in (("success and time", MEASURES[:2]), ("all three", MEASURES)):
        rms, most = report.z_summary(measures)
        if math.isfinite(rms):
            out.print(f"z over {name}: root mean square {rms:.2f}, largest |z| {most:.2f}")


def _charts(report: Any, folder: Path) -> bool:
    """Draw one chart per table; tell whether matplotlib was there to do it."""
    import importlib.util

    import numpy as np

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
            panels.append(
                Bars(measure.replace("_", " "), axes[measure], [row.value for row in rows], mean, low, high, published)
            )
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
