"""Tune table: a search while it runs, as a table on the terminal."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from tiswarm.system.progress import begin_work

FRAME = 7
"""Lines of the terminal that are not rows of the table."""


@contextmanager
def watching(wanted: bool) -> Iterator[tuple[Any, Callable[[Any], None] | None]]:
    """Give the functions that a search reports its trials and its generations to; quiet where there is no terminal."""
    if not wanted or not sys.stderr.isatty():
        yield False, None
        return
    from rich.console import Console, Group
    from rich.live import Live
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    bar = Progress(
        TextColumn("  trials"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
        console=console,
    )
    task = bar.add_task("trials", total=None, rate="")
    checked: list[Any] = []
    latest: list[Any] = []
    started = time.perf_counter()

    def picture() -> Group:
        shown = checked[-max(console.height - FRAME, 3) :]
        return Group(table([*shown, *(each for each in latest if each.check is None)]), bar)

    begin_work()
    with Live(bar, console=console, transient=True, refresh_per_second=8) as live:

        def report(done: int, total: int) -> None:
            rate = done / max(time.perf_counter() - started, 1e-9)
            bar.update(task, completed=done, total=total, rate=f"{rate:,.0f}/s")

        def finished(made: Any) -> None:
            latest[:] = [made]
            if made.check is not None:
                checked.append(made)
            live.update(picture())

        yield report, finished


def table(rows: list[Any]) -> Any:
    """Lay generations out: the best candidate on its own trials, and the middle on those aside, against the start."""
    from rich.table import Table

    raced = any(row.arm.name for row in rows)
    found = Table(box=None, pad_edge=False)
    for head in ("generation", *(["choice"] if raced else []), "best", "mean", "check", "gain to start"):
        found.add_column(head, justify="left" if head == "choice" else "right")
    for row in rows:
        cells = [f"{row.number + 1} of {row.of}", *([row.arm.name] if raced else [])]
        cells += [f"{row.best:.4f}", f"{row.scores.mean():.4f}"]
        gain = row.check.gain if row.check else None
        cells += [f"{row.check.score:.4f}", f"{gain.mean:+.4f} ± {(gain.high - gain.low) / 2:.4f}"] if gain else ["", ""]
        found.add_row(*cells)
    return found
