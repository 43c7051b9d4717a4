"""The caption of a wide world: a strip below the stage, in one line of sight."""

import numpy as np

from render.captions.caption import introduced
from render.captions.layout import Box
from render.captions.panel import INSET, Panel
from render.raster.glyphs import width, wrapped
from render.raster.shapes import Colour, boxes
from tiswarm.system.words import grouped

LINE, TOP = 5, 24
"""How far below the stage the progress line runs, and the words begin."""

FOOT = 55
"""Baseline of the last line of words, below the first one's top."""

COLUMN, GAP, CLOCK = 66, 16, 124
"""Widths of a counter, at least, of the gaps between counters, and of the clock."""

DIGITS = 22
"""Size of the counters' numbers."""

APART = 44
"""Gap between title, counters and clock."""


class Strip(Panel):
    """Title and strategies on the left, counters in the middle, the clock on the right, under a thin progress line."""

    def _place(self, box: Box) -> None:
        unit = self._unit
        self._box = Box(box.left + INSET * unit, box.top + TOP * unit, box.right - INSET * unit, box.bottom)
        longest = [grouped(counter.total) + counter.unit for counter in self._counters]
        widths = [width(each, self._px(DIGITS), tabular=True) / unit for each in longest]
        self._column = max(COLUMN, *widths) if widths else COLUMN
        wide = len(self._counters) * (self._column + GAP) - GAP
        self._first = self._box.right - (CLOCK + APART + wide) * unit
        room = int(self._first - APART * unit - self._box.left)
        self._headed(room)
        self._peopled(room)
        self._counter_labels()
        right, which = self._box.right, f"trial {self._subject.trial} · seed {self._subject.seed}"
        self._still.append(self._write("s", right, self._box.top + 29 * unit, 16, "quiet", "right"))
        self._still.append(self._write(which, right, self._box.top + FOOT * unit, 13, "quiet", "right"))

    def _headed(self, room: int) -> None:
        """Write the title on one line, or smaller on two, and the source behind it where there is room."""
        scenario, unit = self._subject.scenario, self._unit
        size, y, lines = 22, [23], wrapped(scenario.title, self._px(22), room, 1)
        if lines[0].endswith("…"):
            size, y, lines = 18, [12, 33], _evenly(scenario.title, self._px(18), room)
        if len(lines) == 1:
            y = [23]
        for line, down in zip(lines, y, strict=True):
            self._still.append(self._write(line, self._box.left, self._box.top + down * unit, size, "ink"))
        start = width(lines[-1], self._px(size)) + 14 * unit
        if scenario.source and start + width(scenario.source, self._px(12)) <= room:
            base = self._box.top + y[-1] * unit
            self._still.append(self._write(scenario.source, self._box.left + start, base, 12, "quiet"))

    def _peopled(self, room: int) -> None:
        """Write who plays, in as many words as there is room for."""
        words = [
            (name, who, [f"{strategy} · {avoidance}"] * bool(avoidance) + [strategy, ""])
            for name, who, strategy, avoidance in introduced(self._scene)
        ]
        small, icon, gap = self._px(13), 26 * self._unit, 26 * self._unit
        for short in range(3):
            chosen = [(name, who, ways[min(short, len(ways) - 1)]) for name, who, ways in words]
            widths = [icon + width(who, small) + 8 * self._unit + width(how, small) for _, who, how in chosen]
            if sum(widths) + gap <= room:
                break
        x, base = self._box.left, self._box.top + FOOT * self._unit
        for (name, who, how), wide in zip(chosen, widths, strict=True):
            self._still.append(self._likeness(name, x + 9 * self._unit, base - 4.5 * self._unit, 0.85 * self._unit))
            self._still.append(self._write(who, x + icon, base, 13, "ink"))
            self._still.append(self._write(how, x + icon + width(who, small) + 8 * self._unit, base, 13, "quiet"))
            x += wide + gap

    def _counter_labels(self) -> None:
        for n, counter in enumerate(self._counters):
            self._still.append(self._write(counter.name, self._counter(n), self._box.top + 41 * self._unit, 13, "quiet"))
            self._still.append(self._bar(n, 1.0, self._theme["line"], 0.16))

    def _counter(self, n: int) -> float:
        """Give the left edge of a counter."""
        return self._first + n * (self._column + GAP) * self._unit

    def _bar(self, row: int, share: float, paint: Colour, alpha: float) -> np.ndarray:
        x, y, half = self._counter(row), self._box.top + 53 * self._unit, 1.75 * self._unit
        return boxes((x, y - half), (x + share * self._column * self._unit, y + half), paint, alpha, corner=half)

    def _number(self, row: int, digits: str, paint: str) -> np.ndarray:
        return self._write(digits, self._counter(row), self._box.top + 21 * self._unit, DIGITS, paint, tabular=True)

    def _clock(self, time: float) -> list[np.ndarray]:
        digits = f"{min(time, self._scene.paths.last) * self._subject.scenario.world.dt:.1f}"
        end = self._box.right - width("s", self._px(16)) - 5 * self._unit
        return [self._write(digits, end, self._box.top + 29 * self._unit, 38, "ink", "right", tabular=True)]

    def _progress(self, share: float, paint: Colour, alpha: float) -> np.ndarray:
        y, half = self._box.top - (TOP - LINE) * self._unit, self._unit
        end = self._box.left + self._box.width * share
        return boxes((self._box.left, y - half), (end, y + half), paint, alpha, corner=half)


def _evenly(title: str, size: int, room: int) -> list[str]:
    """Break a title into two lines of about the same length, so that no word stands alone."""
    lines = wrapped(title, size, room, 2)
    if len(lines) < 2 or lines[1].endswith("…"):
        return lines
    for narrow in range(room // 2, room, max(room // 40, 1)):
        even = wrapped(title, size, narrow, 2)
        if len(even) == 2 and not any(line.endswith("…") for line in even):
            return even
    return lines
