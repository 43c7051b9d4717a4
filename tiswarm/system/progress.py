"""Progress: a bar with rate and remaining time, on a terminal only; and the places where Ctrl-C is heard for certain."""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

INTERRUPTED = 130
"""Exit code after Ctrl-C."""

_interrupted = False
_at_work = False


def listen_for_interrupts() -> None:
    """Hear Ctrl-C at any moment.

    Imports swallow an exception that happens to be raised in them: before the work begins, when there is nothing to clean
    up, the process ends at once; later the interrupt is raised and remembered, too.
    """

    def hear(_signal: int, _frame: Any) -> None:
        global _interrupted
        if not _at_work:
            sys.stderr.write("tiswarm: interrupted before anything was written\n")
            sys.stderr.flush()
            os._exit(INTERRUPTED)
        _interrupted = True
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, hear)


def heed_interrupts() -> None:
    """Raise KeyboardInterrupt if there was one that nobody heard."""
    if _interrupted:
        raise KeyboardInterrupt


def begin_work() -> None:
    """Tell that from now on files may be half-written, so that an interrupt must let everybody clean up."""
    global _at_work
    _at_work = True


@contextmanager
def reporting(progress: bool | Callable[[int, int], None], total: int, unit: str) -> Iterator[Callable[[int], None]]:
    """Give a function that takes how much is done of `total`, and that hears Ctrl-C.

    progress: True draws a bar on standard error if that is a terminal; a function is called with (done, total).
    """
    begin_work()
    with _shown(progress, total, unit) as show:

        def report(done: int) -> None:
            heed_interrupts()
            show(done)

        heed_interrupts()
        yield report


@contextmanager
def _shown(progress: bool | Callable[[int, int], None], total: int, unit: str) -> Iterator[Callable[[int], None]]:
    if callable(progress):
        yield lambda done: progress(done, total)
    elif progress and sys.stderr.isatty():
        with _bar(total, unit) as update:
            yield update
    else:
        yield lambda _done: None


@contextmanager
def _bar(total: int, unit: str) -> Iterator[Callable[[int], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn, TimeRemainingColumn
    from rich.text import Text

    class Rate(ProgressColumn):
        """Units per second so far."""

        def render(self, task: Task) -> Text:
            speed = task.finished_speed or task.speed
            return Text(f"{speed:,.0f} {unit}/s" if speed else f"– {unit}/s", style="progress.data.speed")

    columns = (TextColumn(f"{unit:>8}"), BarColumn(), MofNCompleteColumn(), Rate(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(unit, total=total)
        yield lambda done: bar.update(task, completed=done)
