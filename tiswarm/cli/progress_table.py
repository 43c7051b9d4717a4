"""Progress table: a study while it runs, as a table that grows on the terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from tiswarm.system.progress import begin_work

FRAME = 7
"""Lines of the terminal that are not rows of the table."""


@contextmanager
def watching(
    wanted: bool, measures: tuple[str, ...], cluster: Any = None
) -> Iterator[tuple[Any, Callable[[Any], None] | None]]:
    """Give the functions that a study reports its trials and its finished rows to; quiet where there is no terminal.

    cluster: whose number of workers is shown, if it runs on one.
    """
    if not wanted or not sys.stderr.isatty():
        yield False, None
        return
    from rich.console import Console, Group
    from rich.live import Live
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from tiswarm.studies.console import fitting

    console = Console(stderr=True)
    bar = Progress(
        TextColumn("  {task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), console=console
    )
    task = bar.add_task("trials", total=None)
    rows: list[Any] = []

    def picture() -> Group:
        shown = rows[-max(console.height - FRAME, 3) :]
        keys = list(dict.fromkeys(key for row in shown for key in row.cell.table.shown))
        named = len({row.cell.table.name for row in rows}) > 1
        return Group(fitting(shown, keys, measures, named, console), bar)

    begin_work()
    with Live(bar, console=console, transient=True, refresh_per_second=8) as live:

        def report(done: int, total: int) -> None:
            on = "" if cluster is None else f" on {cluster.workers} workers"
            bar.update(task, completed=done, total=total, description=f"trials{on}")

        def finished(row: Any) -> None:
            rows.append(row)
            live.update(picture())

        yield report, finished
