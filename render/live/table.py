"""Table: how trials come out: those that were watched, and a thousand more with the same numbers."""

from asyncio import AbstractEventLoop, TimerHandle
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import tiswarm
from render.live import trials
from render.live.worker import Worker
from tiswarm.records.recording import FATES

CALM = 0.12
"""Seconds without a change after which the thousand trials begin."""


class Table:
    """Asks the process that runs trials, and tells what it says beside what it said before the last change."""

    def __init__(self, worker: Worker, loop: AbstractEventLoop, tell: Callable[[str, dict[str, Any]], None]) -> None:
        """Begin empty. worker: that runs `trials.run`."""
        self.worker = worker
        self._loop, self._tell = loop, tell
        self._timer: TimerHandle | None = None
        self._asked = trials.Asked(0, "", 0)
        self._rows: dict[str, Any] = {}
        self._before: dict[str, Any] = {}
        self._watched: list[list[float]] = []
        self._serial = 0

    def close(self) -> None:
        """Ask nothing more."""
        if self._timer is not None:
            self._timer.cancel()

    def settle(self, scenario: tiswarm.Scenario, seed: int, serial: int) -> None:
        """Run trials of another scenario once its numbers have come to rest; what was said so far is of before at once.

        serial: of the change, which the readers are told, too.
        """
        self._watched.clear()
        self._serial = serial
        asked = trials.Asked(self._asked.number + 1, trials.measured(scenario).to_json(), seed)
        if (asked.scenario, asked.seed) != (self._asked.scenario, self._asked.seed):  # else the same trials are watched again
            if self._rows.get("trials") == trials.SIZES[-1]:
                self._before = self._rows
            self._asked = asked
            self.close()
            refused = trials.refused(scenario)
            self._rows = {"refused": refused} if refused else {}
            if not refused:
                self._timer = self._loop.call_later(CALM, self.worker.send, "ask", asked)
        self._show()

    def count(self, counts: Sequence[int], seconds: float) -> None:
        """Note how a trial that was watched came out. counts: prey of each fate; seconds: how long it ran."""
        fates = dict(zip(FATES, counts, strict=True))
        self._watched.append([fates["arrived"] / max(sum(counts), 1), fates["captured"], fates["crashed"], seconds])
        self._show()

    def estimated(self, name: str, said: Sequence[Any]) -> None:
        """Hear the process: an estimate, or why there is none."""
        if name in ("trials", "untried") and said[0] != self._asked.number:
            return
        if name == "trials":
            _, count, rows, seconds = said
            self._rows = {"trials": count, "rows": rows, "seconds": seconds}
        else:
            self._rows = {"refused": str(said[-1]) if said else "the process that runs trials has ended"}
        self._show()

    def _show(self) -> None:
        names = ("success", "captured", "crashed", "time")
        rows = dict(zip(names, map(trials.row, np.array(self._watched).T), strict=True)) if self._watched else {}
        watched = {"trials": len(self._watched), "rows": rows}
        self._tell("trials", {"serial": self._serial, "now": self._rows, "before": self._before, "watched": watched})
