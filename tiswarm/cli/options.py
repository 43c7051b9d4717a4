"""Options: what the verbs of the command line take, and how it is read."""

import re
import sys
from collections.abc import Callable
from fractions import Fraction
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console


class _Output(Console):
    """Standard output, whose reader may go away: rich would end the process with 1."""

    def on_broken_pipe(self) -> None:
        """Leave it to the caller."""
        raise BrokenPipeError


out = _Output(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else 150)


def _beginning_with(start: str) -> list[str]:
    """List the presets that a shell may complete to."""
    from tiswarm.scenario import presets

    return [name for name in presets.presets() if name.startswith(start)]


Preset = Annotated[
    str,
    typer.Argument(
        metavar="PRESET",
        help="A preset's name (see 'tiswarm presets') or the path of a TOML file.",
        autocompletion=_beginning_with,
    ),
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
Language = Annotated[str, typer.Option("--language", metavar="CODE", help="What captions are written in: en, de or ar.")]
Size = Annotated[str, typer.Option("--size", metavar="WxH", help="Width and height of the film in pixels, both even.")]
Fps = Annotated[
    str | None, typer.Option("--fps", metavar="N", help="Frames per second, such as 29.97 or 30000/1001; 60, or 25 in a GIF.")
]


_COMMON: dict[str, tuple[Any, Any]] = {
    "seed": (Seed, 0),
    "threads": (Threads, None),
    "precision": (Precision, "f32"),
    "quiet": (Quiet, False),
}
"""Option -> its type and default: every verb takes these four."""


def with_common_options(verb: Callable[..., None]) -> Callable[..., None]:
    """Let a verb take the four options of all verbs that needs none of them."""
    own = signature(verb)
    common = [
        Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=of) for name, (of, default) in _COMMON.items()
    ]

    @wraps(verb)
    def wrapped(**given: Any) -> None:
        verb(**{name: given[name] for name in own.parameters})

    wrapped.__signature__ = own.replace(parameters=[*own.parameters.values(), *common])  # type: ignore[attr-defined]
    wrapped.__annotations__ = verb.__annotations__ | {name: of for name, (of, _) in _COMMON.items()}
    return wrapped


class WrongInput(ValueError):
    """Something that the user typed cannot be; the message names the mend."""


def start(seed: int, threads: int | None, precision: str, strategy_path: list[Path] | None = None) -> None:
    """Check what every verb takes, and start Taichi."""
    import tiswarm

    prepare(seed, strategy_path)
    tiswarm.init(precision, threads)  # type: ignore[arg-type]


def prepare(seed: int, strategy_path: list[Path] | None) -> None:
    """Find strategies of the user's, and check the seed."""
    import tiswarm
    from tiswarm.simd.philox import seed_words

    for folder in strategy_path or []:
        tiswarm.add_path(folder)
    seed_words(seed)


def load_scenario(preset: str, sets: list[str] | None) -> Any:
    """Load a preset with what --set changes."""
    import tiswarm

    return tiswarm.load(preset, dict(assignment(each) for each in sets or []))


def begun(
    presets: list[str],
    sets: list[str] | None,
    seed: int,
    threads: int | None,
    precision: str,
    strategy_path: list[Path] | None,
) -> list[Any]:
    """Check what every verb takes, start Taichi, and load presets with what --set changes."""
    start(seed, threads, precision, strategy_path)
    return [load_scenario(each, sets) for each in presets]


def plain_name(preset: str) -> str:
    """Give a preset's name as part of a file's name."""
    return Path(preset).stem if preset.endswith(".toml") else preset.replace("/", "-")


def assignment(text: str) -> tuple[str, Any]:
    """Read KEY=VALUE: the value as TOML, or a bare word as text."""
    import tomllib

    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise WrongInput(f"--set {text}: write KEY=VALUE, for example --set prey.strategy=evasive")
    try:
        return key.strip(), tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return key.strip(), value.strip()


def frame_rate(text: str | None) -> Fraction | None:
    """Read frames per second: a whole number, a decimal or a fraction."""
    if text is None:
        return None
    try:
        if re.fullmatch(r"\d{1,9}([.]\d{1,9})?|\d{1,9}/\d{1,9}", text.strip(), re.ASCII):
            return Fraction(text.strip())
    except ZeroDivisionError:
        pass
    raise WrongInput(f"--fps {text}: write a number, for example --fps 60, --fps 29.97 or --fps 30000/1001")


def pair(text: str, option: str, example: str) -> tuple[int, int]:
    """Read two whole numbers, written AxB."""
    first, _, second = text.lower().partition("x")
    if not (first.isdigit() and second.isdigit()):
        raise WrongInput(f"{option} {text}: write two whole numbers, for example {option} {example}")
    return int(first), int(second)
