"""The caption below the stage: in one line of sight where the frame is wide, else in rows."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from render.captions.caption import LEGIBLE, Counter, fitting, introduced, pixels
from render.captions.chart import chartable, height_for
from render.captions.layout import Box, dealt
from render.captions.panel import HOW, INSET, NOTE, UNIT, Panel, clocked
from render.raster.glyphs import width, wrapped
from render.raster.shapes import NONE, Colour, boxes
from render.scene.scene import Scene
from tiswarm.records.recording import Recording

TITLES = (34, 31, 28, 25, 22)
NUMBER, NAME, WHO, CLOCK = 32, 17, 18, 54
"""Sizes of words."""

TOP, BOTTOM = 10, 12
"""Room above and below the words."""

GAP, APART = 20, 30
"""Gaps between counters, and between them and what stands beside them."""

COUNTED, PEOPLED, NOTED, PART = 46, 27, 21, 6
"""Heights of a row of counters, of who plays, of a note, and what parts them."""


class Strip(Panel):
    """Title, who plays and notes on the left, clock and counters on the right; narrow frames have counters in rows below."""

    def _place(self, box: Box) -> None:
        unit = self._unit
        plan = _Plan(self._scene, box.width, unit, self._counters, self._note)
        spare = max(box.height - plan.height, 0.0) / 2
        charted = charted_in(self._scene, 2 * spare / unit)
        if charted:
            spare = min(spare, APART / 2 * unit)
            below = box.top + plan.height + spare
            self._chart(Box(box.left + INSET * unit, below + PART * unit, box.right - INSET * unit, box.bottom - INSET * unit))
        else:
            self._chart(Box(0, 0, 0, 0))
        self._box = Box(box.left + INSET * unit, box.top + TOP * unit + spare, box.right - INSET * unit, box.bottom)
        y = self._box.top
        self._clock_base = y + CLOCK * 0.82 * unit
        self._still.append(self._write(self._words.unit("s"), self._box.right, self._clock_base, 24, "quiet", "right"))
        for line in plan.title:
            y += plan.size * 1.12 * unit
            self._still.append(self._write(line, self._box.left, y, plan.size, "ink"))
        for line_up in plan.people:
            y += PEOPLED * unit
            x = self._box.left
            for kind, who, how in line_up:
                x = self._peopled_at(kind, who, how, x, y)
        y += PART * unit if plan.notes else 0
        for line in plan.notes:
            y += NOTED * unit
            self._still.append(self._write(line, self._box.left, y, NOTE, "quiet"))
        self._spots: list[tuple[float, float, float]] = []  # left edge, baseline and width of each counter
        foot = box.top + plan.height + spare if charted else box.bottom - spare
        base = y + 2 * PART * unit if not plan.abreast else foot - (BOTTOM + COUNTED - 3) * unit
        for row in plan.rows:
            base += COUNTED * unit
            x = self._box.right - sum(wide + GAP * unit for wide in row) + GAP * unit if plan.abreast else self._box.left
            for wide in row:
                self._spots.append((x, base - 10 * unit, wide))
                x += wide + GAP * unit
        for n, counter in enumerate(self._counters):
            x, base, wide = self._spots[n]
            named = wide - counter.name_room(self._px(NAME))
            self._named(counter, x + named, base)
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

    def _bar(self, row: int, share: float, paint: Colour, alpha: float) -> np.ndarray:
        (x, base, wide), half = self._spots[row], 1.75 * self._unit
        y = base + 9 * self._unit
        left, right = self._span(x, x + share * wide)
        return boxes((left, y - half), (right, y + half), paint, alpha, corner=half)

    def _number(self, row: int, digits: str, paint: str) -> list[np.ndarray]:
        (x, base, wide), counter = self._spots[row], self._counters[row]
        right = x + wide - counter.name_room(self._px(NAME)) - 7 * self._unit
        rows = []
        if counter.unit:
            rows.append(self._write(counter.unit, right, base, UNIT, "quiet", "right"))
            right -= width(" " + counter.unit, self._px(UNIT))
        return [*rows, self._write(digits, right, base, NUMBER, paint, "right", tabular=True)]

    def _clock(self, time: float) -> list[np.ndarray]:
        end = self._box.right - width(self._words.unit("s"), self._px(24)) - 6 * self._unit
        return [self._write(clocked(self._scene, time), end, self._clock_base, CLOCK, "ink", "right", tabular=True)]

    def _progress(self, share: float, paint: Colour, alpha: float) -> np.ndarray:
        """Draw the line between stage and caption."""
        if not self.progresses:
            return NONE
        top, half = self._panel.top, 1.5 * self._unit
        left, right = self._span(0.0, self._panel.width * share)
        return boxes((left, top), (right, top + 2 * half), paint, alpha)


class _Plan:
    """What a strip of some width says, in how many lines, and how high it becomes."""

    def __init__(self, scene: Scene, wide: float, unit: float, found: list[Counter], note: str):
        room = wide - 2 * INSET * unit
        words = scene.look.wording
        widths = [counter.room(pixels(NUMBER, unit), pixels(NAME, unit), pixels(UNIT, unit)) + 7 * unit for counter in found]
        longest = clocked(scene, scene.paths.last)
        clock = (
            width(longest, pixels(CLOCK, unit), tabular=True) + width(words.unit("s"), pixels(24, unit)) + (6 + APART) * unit
        )
        self.title, self.size = fitting(words.title(scene.subjects[0].scenario), TITLES, room - clock, 2, unit)
        beside = room - sum(each + GAP * unit for each in widths) - (APART - GAP) * unit
        who, noted = introduced(scene), max(width(note, pixels(NOTE, unit)), 1)
        needed = max(noted, max((_wide(each, unit) for each in who), default=0.0) if len(who) > 1 else 0.0)
        self.abreast = 0.9 * needed <= beside and beside > 0.3 * room
        self.rows = dealt(widths, room if not self.abreast else np.inf, GAP * unit)
        small = pixels(NOTE, unit) < LEGIBLE
        self.people = [] if small else _peopled(who, beside if self.abreast else room - clock, unit)
        self.notes = [] if small else wrapped(note, pixels(NOTE, unit), int(beside if self.abreast else room), 2)
        left = len(self.title) * self.size * 1.12 + len(self.people) * PEOPLED + len(self.notes) * NOTED
        left += PART if self.notes else 0
        if self.abreast:
            high = max(left, CLOCK * 0.82 + 4 + COUNTED * len(self.rows))
        else:
            high = max(left, CLOCK * 0.82) + COUNTED * len(self.rows) + 2 * PART
        self.height = (TOP + high + BOTTOM) * unit


def _wide(who: tuple[str, str, str], unit: float) -> float:
    """Measure who plays with its likeness."""
    return 37 * unit + width(who[1], pixels(WHO, unit)) + width(who[2], pixels(HOW, unit))


def _peopled(who: list[tuple[str, str, str]], room: float, unit: float) -> list[list[tuple[str, str, str]]]:
    """Deal who plays to lines."""
    widths = [_wide(each, unit) for each in who]
    counts = [len(row) for row in dealt(widths, room, 26 * unit)]
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(int)
    return [who[start:end] for start, end in pairwise(starts)]


def height_of(scene: Scene, found: list[Counter], note: str) -> Callable[[float, float], float]:
    """Give what tells how high [px] the caption of a scene becomes, by its width and the unit of type [px]."""
    more = (
        height_for(len(scene.look.chart or ()) + (scene.look.among is not None))
        if isinstance(scene.subjects[0], Recording)
        else 0.0
    )
    return lambda wide, unit: _Plan(scene, wide, unit, found, note).height + more * unit


def charted_in(scene: Scene, left: float) -> bool:
    """Tell whether what is left of a strip [units of type] has room for a chart that is wanted, or worth it."""
    names = chartable(scene) if scene.look.chart is None else scene.look.chart
    return bool(names or scene.look.among) and isinstance(scene.subjects[0], Recording) and left >= height_for(1) - 1e-6
