"""The caption beside the stage: title, who plays, numbers and a clock, from top to bottom, never over the action."""

import numpy as np

from render.captions.caption import Caption, Counter, fitting, introduced
from render.captions.chart import Charts, height_for
from render.captions.layout import Box, Layout
from render.raster.glyphs import Atlas, width, wrapped
from render.raster.shapes import NONE, Colour, boxes, colour
from render.scene.scene import Scene

INSET = 24
TITLES = (34, 30, 26, 22)
"""Sizes of titles to choose from."""

NOTE, WHO, HOW, NAME, NUMBER, UNIT, CLOCK = 15, 20, 15, 18, 26, 16, 56
"""Sizes of the other words."""

ROW = 44
"""Height of a counter."""

SHRUNK = 0.6
"""Type shrinks at most to this share where a title is long and counters are many."""


class Panel(Caption):
    """The caption of one scene."""

    def __init__(self, scene: Scene, layout: Layout, atlas: Atlas, found: list[Counter], note: str):
        """Place the blocks. The layout must have room for a caption. found, note: what `counters` and `notes` tell."""
        assert layout.panel is not None
        super().__init__(scene, atlas, layout.unit)
        self.shown = True
        self._subject, self._counters, self._panel = scene.subjects[0], found, layout.panel
        self._note = note
        self._still: list[np.ndarray] = []
        self._within(layout.panel.left, layout.panel.right)
        self._told: list[str] = []  # numbers change seldom: their shapes are kept until they do
        self._told_rows: list[np.ndarray] = []
        self._place(layout.panel)

    def _place(self, box: Box) -> None:
        """Place what stands still in the caption's box, in type that shrinks until there is room for all, and for the clock."""
        least, among = SHRUNK * self._unit, height_for(1) if self._scene.look.among else 0.0
        while True:
            top, foot = self._placed(box), self._box.bottom - (CLOCK + 16) * self._unit
            if top + among * self._unit <= foot or self._unit <= least:
                break
            self._unit *= 0.95
        self._chart(Box(self._box.left, top, self._box.right, foot))

    def _placed(self, box: Box) -> float:
        """Place all but charts, and give where it ends."""
        inset = INSET * self._unit
        self._still = []
        self._box = Box(box.left + inset, box.top + inset, box.right - inset, box.bottom - inset)
        y = self._noted(self._titled(self._box.top))
        self._numbers_top = self._peopled(y + 14 * self._unit) + 18 * self._unit
        for n, counter in enumerate(self._counters):
            base = self._numbers_top + (n * ROW + 24) * self._unit
            self._named(counter, self._box.left, base)
            self._still.append(self._bar(n, 1.0, self._theme["line"], 0.16))
        return self._numbers_top + (len(self._counters) * ROW + 12) * self._unit

    def _chart(self, box: Box) -> None:
        """Fill what is left of the caption with charts."""
        self._charts = Charts(self._scene, self._atlas, self._unit, box, self._scene.look.chart)
        self._still += self._charts.ground()

    def _titled(self, y: float) -> float:
        lines, size = fitting(self._words.title(self._subject.scenario), TITLES, self._box.width, 5, self._unit)
        for line in lines:
            y += size * 1.14 * self._unit
            self._still.append(self._write(line, self._box.left, y, size, "ink"))
        return y + 10 * self._unit

    def _noted(self, y: float) -> float:
        for line in wrapped(self._note, self._px(NOTE), int(self._box.width), 4):
            y += 1.3 * NOTE * self._unit
            self._still.append(self._write(line, self._box.left, y, NOTE, "quiet"))
        return y

    def _peopled(self, y: float) -> float:
        """Show prey and predators as they look on the stage, with their strategies."""
        unit = self._unit
        for kind, who, how in introduced(self._scene):
            y += 12 * unit
            self._still.append(self._likeness(kind, self._box.left + 11 * unit, y + 7.5 * unit, 1.1 * unit))
            x, room = self._box.left + 32 * unit, int(self._box.width - 32 * unit)
            self._still.append(self._write(who, x, y + 14 * unit, WHO, "ink"))
            y += 14 * unit
            for line in wrapped(how, self._px(HOW), room, 2) if how else ():
                y += 19 * unit
                self._still.append(self._write(line, x, y, HOW, "quiet"))
        return y

    def _named(self, counter: Counter, x: float, base: float) -> None:
        """Write a counter's name, behind the sign of the fate that it counts."""
        if counter.sign is not None:
            size = 0.34 * self._px(NAME)
            self._still.append(self._sign(counter.sign, x + size, base - 0.36 * self._px(NAME), size))
            x += self._px(NAME)
        self._still.append(self._write(counter.name, x, base, NAME, "quiet"))

    def _bar(self, row: int, share: float, paint: Colour, alpha: float) -> np.ndarray:
        """Draw a counter's bar below its name."""
        box, half = self._box, 1.5 * self._unit
        y = self._numbers_top + (row * ROW + 34) * self._unit
        left, right = self._span(box.left, box.left + share * box.width)
        return boxes((left, y - half), (right, y + half), paint, alpha, corner=half)

    def _number(self, row: int, digits: str, paint: str) -> list[np.ndarray]:
        """Write a counter's number at the end of its name's line."""
        right, base = self._box.right, self._numbers_top + (row * ROW + 24) * self._unit
        unit = self._counters[row].unit
        rows = [self._write(unit, right, base, UNIT, "quiet", "right")] if unit else []
        end = right - (width(" " + unit, self._px(UNIT)) if unit else 0)
        return [*rows, self._write(digits, end, base, NUMBER, paint, "right", tabular=True)]

    def ground(self) -> np.ndarray:
        """Draw what stands still: title, notes, who plays, names of the counters, the track of the progress line."""
        return np.concatenate([*self._still, self._progress(1.0, self._theme["line"], 0.25)])

    def frame(self, time: float) -> np.ndarray:
        """Draw what changes: counters, clock and progress."""
        ticks = self._scene.paths.last
        share = min(time / ticks, 1.0) if ticks else 1.0
        line = self._progress(share, colour(self._theme.prey[0]), 0.9)
        return np.concatenate([*self._numbers(time), *self._charts.frame(time), *self._clock(time), line])

    def _numbers(self, time: float) -> list[np.ndarray]:
        told = [counter.text(time) for counter in self._counters]
        if told != self._told:
            rows = []
            for n, (counter, text) in enumerate(zip(self._counters, told, strict=True)):
                rows += self._number(n, text, "quiet" if text == self._words.whole(0) else "ink")
                share = counter.share(time) if counter.share else 0.0
                if share > 0:
                    rows.append(self._bar(n, min(share, 1.0), counter.paint, 0.95))
            self._told, self._told_rows = told, rows
        return self._told_rows

    def _clock(self, time: float) -> list[np.ndarray]:
        """Write the time in the world."""
        digits = clocked(self._scene, time)
        end = self._box.left + width(digits, self._px(CLOCK), tabular=True)
        base = self._box.bottom - 16 * self._unit
        return [
            self._write(digits, self._box.left, base, CLOCK, "ink", tabular=True),
            self._write(self._words.unit("s"), end + 7 * self._unit, base, 26, "quiet"),
        ]

    def _progress(self, share: float, paint: Colour, alpha: float) -> np.ndarray:
        """Draw the thin line at the caption's foot."""
        if not self.progresses:
            return NONE
        y, half = self._box.bottom + 4 * self._unit, 1.5 * self._unit
        left, right = self._span(self._box.left, self._box.left + self._box.width * share)
        return boxes((left, y - half), (right, y + half), paint, alpha, corner=half)


def clocked(scene: Scene, time: float) -> str:
    """Write the time [ticks] of a scene in seconds of its world."""
    return scene.look.wording.decimal(min(time, scene.paths.last) * scene.subjects[0].scenario.world.dt, 1)
