"""Entry: the verbs put together, run, and every fault told in one line."""

import os
import sys
import warnings
from contextlib import suppress
from typing import Annotated, Any, NoReturn

import typer

from tiswarm import __version__
from tiswarm.cli.bench import bench
from tiswarm.cli.catalogue import presets, show
from tiswarm.cli.film import demo, film
from tiswarm.cli.live import live
from tiswarm.cli.options import out
from tiswarm.cli.replay import replay
from tiswarm.cli.run import run
from tiswarm.cli.speed import speed
from tiswarm.cli.tune import tune
from tiswarm.simd.backend import BACKENDS, MissingBackend
from tiswarm.simd.backend import version as backend_version
from tiswarm.system.progress import INTERRUPTED, end_work, heed_interrupts, listen_for_interrupts
from tiswarm.system.words import fault, safe

app = typer.Typer(
    name="tiswarm",
    help="Predator-prey swarms: thousands of trials in parallel, published tables, films.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
for _verb in (presets, show, run, film, replay, live, demo, bench, tune, speed):
    app.command()(_verb)


def main() -> NoReturn:
    """Run the command line: exit code 0, 2 for wrong input, 1 for a fault, 130 for Ctrl-C; never a traceback."""
    listen_for_interrupts()
    warnings.showwarning = _note
    try:
        code = app(standalone_mode=False)
        if code == INTERRUPTED:  # some versions of typer turn Ctrl-C into this themselves
            raise KeyboardInterrupt
        heed_interrupts()
        sys.stdout.flush()
    except (KeyboardInterrupt, typer.Abort):
        code = _complain("interrupted; nothing half-written is left", INTERRUPTED)
    except BrokenPipeError:  # the reader, such as head, has seen enough
        _close_output()
        code = 0
    except MemoryError:
        code = _complain("out of memory; run fewer trials or agents at once", 1)
    except RecursionError:
        code = _complain("a value is nested too deeply", 2)
    except OSError as error:
        told = fault(error, "standard output")  # all else that is written has a name
        _close_output()
        code = _complain(told, 1)
    except RuntimeError as error:
        code = _complain(str(error) or type(error).__name__, 1)
    except (ValueError, MissingBackend) as error:
        code = _complain(str(error), 2)
    except typer.Exit as stop:
        code = stop.exit_code
    except Exception as error:
        if type(error).__module__.startswith(BACKENDS):  # a strategy of the user's that does not compile
            sys.exit(_complain(f"a strategy cannot be compiled: {(str(error).splitlines() or [type(error).__name__])[-1]}", 2))
        message = getattr(error, "format_message", None)  # wrong options, as typer's own parser finds them
        if message is None:
            raise
        code = _complain(message().replace("\n", " ") or "no command given; see 'tiswarm --help'", 2)
    end_work()
    sys.exit(code if isinstance(code, int) else 0)


def _complain(message: str, code: int) -> int:
    with suppress(OSError, ValueError):  # who could be told?
        sys.stderr.write(f"tiswarm: {safe(message)}\n")
    return code


def _note(message: Warning | str, *_: Any, **__: Any) -> None:
    """Tell a warning, of NumPy or of ours, in one line; where in the code it arose helps nobody here."""
    if not isinstance(message, DeprecationWarning):  # Taichi lets its own through
        _complain(f"warning: {message}", 0)


def _close_output() -> None:
    """Let nothing more be written to a standard output that takes no more."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@app.callback(invoke_without_command=True)
def _about(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", help="Print the versions of tiswarm, Taichi and ffmpeg, and stop.")
    ] = False,
) -> None:
    if context.invoked_subcommand is None and not version:
        out.print(context.get_help())
    if version:
        out.print("\n".join(_versions()))
        raise typer.Exit


def _versions() -> list[str]:
    """Tell the versions that a report of a fault needs: ours, and of what does the work."""
    import platform

    from render.encoder import version_of_ffmpeg

    return [
        f"tiswarm {__version__}",
        f"Python {platform.python_version()} on {platform.platform()}",
        f"Taichi {backend_version()}",
        f"ffmpeg {version_of_ffmpeg()}",
    ]
