"""The caption: title, who plays, counters and a clock, beside or below the stage, never over the action."""

from itertools import pairwise

import numpy as np

from render.captions.caption import Caption, counters, introduced
from render.captions.layout import ROW, Box, Layout
from render.raster.glyphs import Atlas, width, wrapped
from render.raster.shapes import Colour, boxes, capsules, colour, darts
from render.scene.scene import Scene
from tiswarm.system.words import grouped

INSET = 28
COLUMNS = {"side": (1.0,), "stack": (1.0,), "pair": (0.5, 0.5)}
"""Shares of the panel's width; title, legend, counters and clock are dealt to the columns in this order."""


class Panel(Caption):
    """The caption of one scene."""

    def __init__(self, scene: Scene, layout: Layout, atlas: Atlas):
        """Place the blocks. The layout must have room for a panel."""
        assert layout.panel is not None
        super().__init__(scene, atlas, layout.unit)
        self._layout, self._subject, self._counters = layout, scene.subjects[0], counters(scene)
        self._still: list[np.ndarray] = []
        self._counted: list[int] = []  # numbers change seldom: their shapes are kept until they do
        self._counter_rows: list[np.ndarray] = []
        self._place(layout.panel)

    def _place(self, box: Box) -> None:
        """Place what stands still in the panel's box."""
        layout, inset = self._layout, INSET * self._unit
        right = box.right - (inset / 2 if layout.form == "side" else inset)
        self._box = Box(box.left + inset, box.top + (inset if layout.form == "side" else inset / 2), right, box.bottom - inset)
        shares = COLUMNS[layout.form]
        gap = inset if len(shares) > 1 else 0
        edges = self._box.left + np.concatenate([[0], np.cumsum(shares)]) * (self._box.width + gap)
        self._columns = [Box(float(a), self._box.top, float(b) - gap, self._box.bottom) for a, b in pairwise(edges)]
        pens = [self._box.top] * len(shares)
        for n, block in enumerate((self._title, self._legend, self._counter_names)):
            column = n * len(shares) // 4
            pens[column] = block(self._columns[column], pens[column])

    def ground(self) -> np.ndarray:
        """Draw what stands still: title, source, legend, names of the counters, the track of the progress line."""
        return np.concatenate([*self._still, self._progress(1.0, self._theme["line"], 0.25)])

    def frame(self, time: float) -> np.ndarray:
        """Draw what changes: counters, clock and progress."""
        ticks = self._scene.paths.last
        share = min(time / ticks, 1.0) if ticks else 1.0
        return np.concatenate(
            [*self._numbers(time), *self._clock(time), self._progress(share, colour(self._theme.prey[0]), 0.9)]
        )

    def _title(self, box: Box, y: float) -> float:
        scenario = self._subject.scenario
        size = 21
        for line in wrapped(scenario.title, self._px(size), int(box.width), 5):
            y += size * 1.22 * self._unit
            self._still.append(self._write(line, box.left, y, size, "ink"))
        y += 6 * self._unit
        for line in wrapped(scenario.source, self._px(12), int(box.width), 2) if scenario.source else ():
            y += 19 * self._unit
            self._still.append(self._write(line, box.left, y, 12, "quiet"))
        y += 18 * self._unit
        self._still.append(self._write(f"trial {self._subject.trial} · seed {self._subject.seed}", box.left, y, 12, "quiet"))
        return y + 22 * self._unit

    def _legend(self, box: Box, y: float) -> float:
        """Show prey and predators as they look on the stage, with their strategies."""
        unit = self._unit
        for name, who, strategy, avoidance in introduced(self._scene):
            self._still.append(self._likeness(name, box.left + 10 * unit, y + 15 * unit, unit))
            x, room = box.left + 28 * unit, int(box.width - 28 * unit)
            how = f"{strategy} · {avoidance}" if avoidance else strategy
            self._still.append(self._write(who, x, y + 13 * unit, 15, "ink"))
            self._still.append(self._write(wrapped(how, self._px(12), room, 1)[0], x, y + 30 * unit, 12, "quiet"))
            y += 44 * unit
        return y + 8 * unit

    def _likeness(self, name: str, x: float, y: float, unit: float) -> np.ndarray:
        """Draw a prey or a predator as it looks on the stage."""
        middle, right, hue = (
            np.array([[x, y]]),
            np.array([[unit, 0.0]]),
            colour(self._theme.prey[0] if name == "prey" else self._theme.predator),
        )
        if name == "prey":
            return capsules(middle + 3 * right, middle - 8 * right, 6 * unit, 1.3 * unit, hue)
        return darts(middle, right / unit, 9 * unit, 6.5 * unit, 6.5 * unit, hue)

    def _counter_names(self, box: Box, y: float) -> float:
        self._counter_box = Box(box.left, y, box.right, box.bottom)
        for n, counter in enumerate(self._counters):
            base = y + (n * ROW + 14) * self._unit
            self._still.append(self._write(counter.name, box.left, base, 13, "quiet"))
            self._still.append(self._bar(n, 1.0, self._theme["line"], 0.16))
        return y + len(self._counters) * ROW * self._unit

    def _bar(self, row: int, share: float, paint: Colour, alpha: float) -> np.ndarray:
        """Draw a counter's bar below its name."""
        box, unit = self._counter_box, self._unit
        y = box.top + (row * ROW + 20) * unit
        return boxes((box.left, y - unit), (box.left + share * box.width, y + unit), paint, alpha, corner=unit)

    def _number(self, row: int, digits: str, paint: str) -> np.ndarray:
        """Write a counter's number at the end of its name's line."""
        box, unit = self._counter_box, self._unit
        return self._write(digits, box.right, box.top + (row * ROW + 14) * unit, 14, paint, "right", tabular=True)

    def _numbers(self, time: float) -> list[np.ndarray]:
        numbers = [counter.number(time) for counter in self._counters]
        if numbers != self._counted:
            rows = []
            for n, (counter, number) in enumerate(zip(self._counters, numbers, strict=True)):
                rows.append(self._number(n, grouped(number) + counter.unit, "ink" if number else "quiet"))
                if number:
                    rows.append(self._bar(n, number / counter.total, counter.paint, 0.95))
            self._counted, self._counter_rows = numbers, rows
        return self._counter_rows

    def _clock(self, time: float) -> list[np.ndarray]:
        """Write the time in the world, and below it the tick."""
        scenario, unit, ticks = self._subject.scenario, self._unit, self._scene.paths.last
        now = min(time, ticks)
        box = self._columns[-1]
        base = box.bottom - 30 * unit
        digits = f"{now * scenario.world.dt:.1f}"
        size = 40
        end = box.left + width(digits, self._px(size), tabular=True)
        return [
            self._write(digits, box.left, base, size, "ink", tabular=True),
            self._write("s", end + 6 * unit, base, 18, "quiet"),
            self._write(f"tick {int(now)} of {ticks}", box.left, base + 20 * unit, 12, "quiet", tabular=True),
        ]

    def _progress(self, share: float, paint: Colour, alpha: float) -> np.ndarray:
        """Draw the thin line at the panel's foot."""
        y, half = self._box.bottom + 6 * self._unit, self._unit
        left, right = self._columns[0].left, self._columns[-1].right
        return boxes((left, y - half), (left + (right - left) * share, y + half), paint, alpha, corner=half)
