"""Progress: a bar with rate and remaining time, on a terminal only; and the places where Ctrl-C is heard for certain."""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

INTERRUPTED = 130
"""Exit code after Ctrl-C."""

_ended: BaseException | None = None
_at_work = False


def listen_for_interrupts() -> None:
    """Hear Ctrl-C, and the signals that ask to end, at any moment.

    Imports swallow an exception that happens to be raised in them: before the work begins and after it, when there is nothing
    to clean up, the process ends at once; meanwhile the interrupt is raised and remembered, too.
    """

    def hear(number: int, _frame: Any) -> None:
        global _ended
        code = 128 + number
        if not _at_work:
            if code == INTERRUPTED:
                os.write(2, b"tiswarm: interrupted; nothing half-written is left\n")
            os._exit(code)
        _ended = KeyboardInterrupt() if code == INTERRUPTED else SystemExit(code)
        raise _ended

    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # not every system has the last
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) != signal.SIG_IGN:  # nohup wants it ignored
            signal.signal(number, hear)


def heed_interrupts() -> None:
    """Raise again what nobody heard: Ctrl-C, or a signal that asked to end."""
    if _ended is not None:
        raise _ended


def begin_work() -> None:
    """Tell that from now on files may be half-written, so that an interrupt must let everybody clean up."""
    global _at_work
    _at_work = True


def end_work() -> None:
    """Tell that nothing is left to clean up, so that an interrupt may end the process at once."""
    global _at_work
    _at_work = False


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
