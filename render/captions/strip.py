"""The caption below the stage: in one line of sight where the frame is wide, else in rows."""

from collections.abc import Callable

import numpy as np

from render.captions.caption import Counter, fitting, introduced, notes, pixels
from render.captions.layout import Box
from render.captions.panel import HOW, INSET, NOTE, UNIT, Panel, clocked
from render.raster.glyphs import width, wrapped
from render.raster.shapes import Colour, boxes
from render.scene.scene import Scene

TITLES = (32, 28, 25, 22)
NUMBER, NAME, WHO, CLOCK = 36, 17, 17, 50
"""Sizes of words."""

TOP, LEAST = 8, 96
"""Room between the progress line and the words, and height of a caption at least."""

COLUMN, GAP, APART = 60, 22, 34
"""Widths of a counter, at least, of the gap between two, and of the gap to what is beside them."""

BLOCK = 82
"""Height of a counter: number, name and bar."""

ABREAST = 0.40
"""The title needs this share of the width beside counters and clock; in narrower frames these stand in rows."""


class Strip(Panel):
    """Title and who plays on the left, counters in the middle, the clock on the right; or one above the other."""

    def _place(self, box: Box) -> None:
        unit = self._unit
        self._box = Box(box.left + INSET * unit, box.top + TOP * unit, box.right - INSET * unit, box.bottom)
        self._plan = plan = _Plan(self._scene, box.width, unit, self._counters)
        spare = max(box.height - plan.height, 0.0)
        if plan.abreast:
            self._box = Box(self._box.left, self._box.top + spare / 2, self._box.right, self._box.bottom)
        y = self._box.top
        self._clock_base = y + 44 * unit
        self._still.append(self._write("s", self._box.right, self._clock_base, 24, "quiet", "right"))
        for line in plan.title:
            y += plan.size * 1.12 * unit
            self._still.append(self._write(line, self._box.left, y, plan.size, "ink"))
        y += 5 * unit
        for line in plan.notes:
            y += 1.25 * NOTE * unit
            self._still.append(self._write(line, self._box.left, y, NOTE, "quiet"))
        y += 4 * unit
        for row in plan.people:
            y += 1.35 * WHO * unit
            x = self._box.left
            for kind, who, how in row:
                x = self._peopled_at(kind, who, how, x, y)
        if plan.abreast:
            self._numbers_top = self._box.top
            self._first = self._box.right - plan.clock - APART * unit - plan.counters
        else:
            self._numbers_top = y + 10 * unit
            self._first = self._box.left
        for n, counter in enumerate(self._counters):
            self._named(counter, self._column(n)[0], self._row(n) + 58 * unit)
            self._still.append(self._bar(n, 1.0, self._theme["line"], 0.16))

    def _peopled_at(self, kind: str, who: str, how: str, x: float, base: float) -> float:
        """Show who plays as it looks on the stage; give where the next one may stand."""
        unit = self._unit
        self._still.append(self._likeness(kind, x + 9 * unit, base - 5.5 * unit, 0.95 * unit))
        x += 28 * unit
        self._still.append(self._write(who, x, base, WHO, "ink"))
        x += width(who, self._px(WHO)) + 9 * unit
        self._still.append(self._write(how, x, base, HOW, "quiet"))
        return x + width(how, self._px(HOW)) + 26 * unit

    def _column(self, n: int) -> tuple[float, float]:
        """Give the left edge and the width of a counter."""
        wide = self._plan.columns
        return self._first + n % self._plan.per_row * (wide + GAP * self._unit), wide

    def _row(self, n: int) -> float:
        return self._numbers_top + n // self._plan.per_row * BLOCK * self._unit

    def _bar(self, row: int, share: float, paint: Colour, alpha: float) -> np.ndarray:
        (x, wide), y, half = self._column(row), self._row(row) + 70 * self._unit, 2 * self._unit
        return boxes((x, y - half), (x + share * wide, y + half), paint, alpha, corner=half)

    def _number(self, row: int, digits: str, paint: str) -> list[np.ndarray]:
        x, base, unit = self._column(row)[0], self._row(row) + 34 * self._unit, self._counters[row].unit
        rows = [self._write(digits, x, base, NUMBER, paint, tabular=True)]
        if unit:
            end = x + width(digits, self._px(NUMBER), tabular=True) + 5 * self._unit
            rows.append(self._write(unit, end, base, UNIT, "quiet"))
        return rows

    def _clock(self, time: float) -> list[np.ndarray]:
        end = self._box.right - width("s", self._px(24)) - 6 * self._unit
        return [self._write(clocked(self._scene, time), end, self._clock_base, CLOCK, "ink", "right", tabular=True)]

    def _progress(self, share: float, paint: Colour, alpha: float) -> np.ndarray:
        """Draw the line between stage and caption."""
        top, half = self._panel.top, 1.5 * self._unit
        return boxes((0.0, top), (self._panel.width * share, top + 2 * half), paint, alpha)


class _Plan:
    """What a strip of some width says, in how many lines, and how high it becomes."""

    def __init__(self, scene: Scene, wide: float, unit: float, found: list[Counter]):
        room = wide - 2 * INSET * unit
        sizes = (pixels(NUMBER, unit), pixels(NAME, unit), pixels(UNIT, unit))
        self.columns = max([COLUMN * unit, *(counter.room(*sizes) for counter in found)])
        scenario = scene.subjects[0].scenario
        longest = f"{scene.paths.last * scenario.world.dt:.1f}"
        self.clock = width(longest, pixels(CLOCK, unit), tabular=True) + width("s", pixels(24, unit)) + 6 * unit
        self.counters = len(found) * (self.columns + GAP * unit) - GAP * unit if found else 0.0
        left = room - self.clock - APART * unit - (self.counters + APART * unit if found else 0)
        self.abreast = left >= ABREAST * room
        self.per_row = max(len(found), 1) if self.abreast else max(int((room + GAP * unit) / (self.columns + GAP * unit)), 1)
        beside = left if self.abreast else room - self.clock - APART * unit
        below = beside if self.abreast else room
        self.title, self.size = fitting(scenario.title, TITLES, beside, 2, unit)
        self.notes = wrapped(notes(scene), pixels(NOTE, unit), int(below), 2) if pixels(NOTE, unit) >= 8 else []
        self.people = _peopled(introduced(scene), below, unit)
        high = TOP * unit + len(self.title) * self.size * 1.12 * unit + 9 * unit
        high += len(self.notes) * 1.25 * NOTE * unit + len(self.people) * 1.35 * WHO * unit
        rows = -(-len(found) // self.per_row)
        numbers = BLOCK * rows * unit
        high = max(high, TOP * unit + numbers) if self.abreast else high + 10 * unit + numbers
        self.height = max(high + 10 * unit, LEAST * unit)


def _peopled(who: list[tuple[str, str, str]], room: float, unit: float) -> list[list[tuple[str, str, str]]]:
    """Deal who plays to lines."""
    if pixels(WHO, unit) < 8:
        return []
    rows: list[list[tuple[str, str, str]]] = []
    left = 0.0
    for each in who:
        wide = 63 * unit + width(each[1], pixels(WHO, unit)) + width(each[2], pixels(HOW, unit))
        if not rows or wide > left:
            rows.append([])
            left = room + 26 * unit
        rows[-1].append(each)
        left -= wide
    return rows


def height_of(scene: Scene, found: list[Counter]) -> Callable[[float, float], float]:
    """Give what tells how high [px] the caption of a scene becomes, by its width and the unit of type [px]."""
    return lambda wide, unit: _Plan(scene, wide, unit, found).height
