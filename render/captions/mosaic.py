"""Several recordings at once: cells that touch, each with its label and what became of its prey, under one title and clock."""

from collections.abc import Sequence

import numpy as np

from render.captions.caption import LEGIBLE, Caption, fated, fitting, keyed, pixels, possible_ends
from render.captions.layout import SMALLEST, Box
from render.captions.measured import measured
from render.captions.panel import clocked
from render.language import Language
from render.raster.glyphs import Atlas, width, wrapped
from render.raster.shapes import NONE, Colour, boxes, colour
from render.scene.scene import Scene
from render.scene.signs import PARTED, signs
from render.scene.trajectories import ALIVE, ARRIVED, CAPTURED
from render.source import Live, target_of
from tiswarm.records.recording import FATES, Recording

INSET, HAIR = 18, 2
"""Rims of the head, and of lines between cells [units of type]."""

TITLES, NOTE, CLOCK, LABEL = (32, 28, 25, 22), 15, 46, 17
"""Sizes of words."""

PIPS = 12
"""More prey than this are counted in words instead of signs."""

SIGN, PIP = 5.4, 14
"""Half the width of a sign, and distance of signs [units of type]."""

RANKS = ("arrived", "alive", "captured", "crashed")
"""The order of the signs, from the right."""

LINED = 0.3
"""Opacity of lines between cells that have no ground."""

PLATE = 0.72
"""Opacity of what lies under words on a cell."""


def labels_of(recordings: Sequence[Recording | Live], words: Language) -> list[str]:
    """Name recordings by what tells them apart: strategies, else seed and trial."""
    roles = (("prey", "strategy"), ("prey", "avoidance"), ("predators", "strategy"), ("predators", "avoidance"))
    ways = [
        [getattr(getattr(r.scenario, kind), role) if getattr(r.scenario, kind).count else "none" for kind, role in roles]
        for r in recordings
    ]
    differing = [n for n in range(4) if len({way[n] for way in ways}) > 1]
    if differing:
        return [" · ".join(way[n] for n in differing) for way in ways]
    seeds = len({r.seed for r in recordings}) > 1
    named = []
    for each in recordings:
        parts = [words.say("lines.trial", number=str(each.trial)), words.say("lines.seed", number=str(each.seed))]
        named.append(" · ".join(parts if seeds else parts[:1]))
    return named


class Heading:
    """What the head of a mosaic says, and how high it becomes."""

    def __init__(self, scene: Scene, size: tuple[int, int], unit: float):
        self.unit, self.shown = unit, size[0] >= SMALLEST[0] and size[1] >= SMALLEST[1]
        subjects = scene.subjects
        words = scene.look.wording
        room = size[0] - 2 * INSET * unit
        longest = clocked(scene, scene.paths.last)
        self.clock = width(longest, pixels(CLOCK, unit), tabular=True) + width(words.unit("s"), pixels(24, unit)) + 30 * unit
        self.title, self.size = fitting(words.title(subjects[0].scenario), TITLES, room - self.clock, 2, unit)
        few = max((scene.paths.is_prey & (scene.paths.scene == n)).sum() for n in range(len(subjects))) <= PIPS
        self.key = [fate for fate in keyed(scene) if few or fate == PARTED]
        shared = len({subject.trial for subject in subjects}) == 1
        one = words.say("lines.trial", number=str(subjects[0].trial))
        trials = one if shared else words.say("lines.trials", len(subjects))
        self.note = f"{trials} · {words.say('lines.seed', number=str(subjects[0].seed))}"
        small = pixels(NOTE, unit)
        widths = [(2 * SIGN + 26) * unit + width(fated(scene, fate), small) for fate in self.key]
        self.beside = 26 * unit + width(self.note, small) + sum(widths) <= room - self.clock
        lines = len(self.title) * self.size * 1.12 + 12
        if small >= LEGIBLE:
            lines += 1.3 * NOTE * (1 if self.beside else 2)
        self.height = max(lines, 54) * unit if self.shown else 0.0


def cells(size: tuple[int, int], count: int, extent: tuple[float, float], head: float) -> list[Box]:
    """Divide what is below the head of a frame into cells that touch, so that worlds of some extent [m] are as large as can be.

    A last row that is not full is as wide as the others: its cells are wider.
    """
    high = size[1] - head

    def cut(columns: int) -> list[Box]:
        rows, out = -(-count // columns), []
        for n in range(count):
            row = n // columns
            across = min(columns, count - row * columns)
            place = n - row * columns
            left, right = (round(size[0] * each / across) for each in (place, place + 1))
            top, bottom = (round(head + high * each / rows) for each in (row, row + 1))
            out.append(Box(left, top, right, bottom))
        return out

    plans = [cut(columns) for columns in range(1, count + 1)]
    return max(plans, key=lambda plan: min(min(cell.width / extent[0], cell.height / extent[1]) for cell in plan))


class Mosaic(Caption):
    """The captions of several subjects."""

    def __init__(self, scene: Scene, places: Sequence[Box], labels: Sequence[str], head: Heading, atlas: Atlas):
        """Caption the subjects of a scene inside their places."""
        super().__init__(scene, atlas, head.unit)
        self._places, self._labels, self._head = places, labels, head
        self.shown = head.shown
        self._right = max(place.right for place in places)
        paths = scene.paths
        self._prey = [np.flatnonzero(paths.is_prey & (paths.scene == n)) for n in range(len(places))]
        self._ends = [possible_ends(scene, n) for n in range(len(places))]
        named = [subject.scenario.film.measures for subject in scene.subjects]
        self._measured = [
            measured(scene, n, names[0]) if names and not ends else None
            for n, (names, ends) in enumerate(zip(named, self._ends, strict=True))
        ]
        trials = {(subject.seed, subject.trial) for subject in scene.subjects}
        self._paired = len(trials) == 1 and len(places) > 1 and all(self._ends)
        self._tallies = [NONE] * len(places)  # counts change seldom: their shapes are kept until they do
        self._gone = np.full(len(places), -1)

    def ground(self) -> np.ndarray:
        """Draw what stands still: title, key, the track of the progress line. What stands on cells is drawn above them."""
        if not self._head.shown:
            return NONE
        unit, head, y = self._unit, self._head, 0.0
        self._within(0, self._right)
        rows = [self._progress(1.0, self._theme["line"], 0.25)]
        y = 4 * unit
        for line in head.title:
            y += head.size * 1.1 * unit
            rows.append(self._write(line, INSET * unit, y, head.size, "ink"))
        y += 1.3 * NOTE * unit
        rows.append(self._write(head.note, INSET * unit, y, NOTE, "quiet"))
        rows.append(self._write(self._words.unit("s"), self._right - INSET * unit, 42 * unit, 24, "quiet", "right"))
        x = INSET * unit + (width(head.note, self._px(NOTE)) + 26 * unit if head.beside else 0.0)
        y += 0.0 if head.beside else 1.3 * NOTE * unit
        if self._px(NOTE) >= LEGIBLE:
            for fate in head.key:
                name = fated(self._scene, fate)
                wide = (2 * SIGN + 6) * unit + width(name, self._px(NOTE))
                if x + wide > self._right - INSET * unit:
                    break
                rows.append(self._sign(fate, x + SIGN * unit, y - 5 * unit, SIGN * unit))
                rows.append(self._write(name, x + (2 * SIGN + 6) * unit, y, NOTE, "quiet"))
                x += wide + 20 * unit
        return np.concatenate(rows)

    def frame(self, time: float) -> np.ndarray:
        """Draw what changes, and what stands on the cells: labels, fates, clock, progress."""
        rows = [self._lines(), *self._labelled(time)]
        if self._head.shown:
            self._within(0, self._right)
            unit, ticks = self._unit, self._scene.paths.last
            end = self._right - (INSET + 8) * unit - width(self._words.unit("s"), self._px(24))
            rows += [
                self._write(clocked(self._scene, time), end, 42 * unit, CLOCK, "ink", "right", tabular=True),
                self._progress(min(time / ticks, 1.0) if ticks else 1.0, colour(self._theme.prey[0]), 0.9),
            ]
        return np.concatenate(rows)

    def _lines(self) -> np.ndarray:
        """Draw the lines between cells."""
        half = max(HAIR * self._unit / 2, 0.75)
        low = np.array([(place.left, place.top) for place in self._places])
        high = np.array([(place.right, place.bottom) for place in self._places])
        paint, alpha = (self._theme["backdrop"], 1.0) if self._theme.ground_alpha else (self._theme["line"], LINED)
        return boxes(low, high, paint, alpha, stroke=half)

    def _labelled(self, time: float) -> list[np.ndarray]:
        if self._px(LABEL) < LEGIBLE:
            return []
        paths = self._scene.paths
        gone = np.bincount(paths.scene[: paths.prey][paths.end[: paths.prey] <= time], minlength=len(self._places))
        for n in range(len(self._places)):
            if gone[n] != self._gone[n] or self._measured[n] or (self._paired and gone[0] != self._gone[0]):
                self._tallies[n] = self._corner(n, time)
        self._gone = gone
        return self._tallies

    def _corner(self, n: int, time: float) -> np.ndarray:
        """Write a cell's label and what became of its prey on a plate in its upper left corner."""
        unit, place = self._unit, self._places[n]
        self._within(place.left, place.right)
        tally = self._tally(n, time)
        signed = not tally and len(self._ends[n]) > 0
        wide = len(self._prey[n]) * PIP * unit if signed else width(tally, self._px(LABEL)) if tally else 0.0
        lead = self._lead(n, time)
        beyond = width(lead, self._px(LABEL)) + 12 * unit if lead else 0.0
        room = place.width - (wide + 40 * unit if wide else 22 * unit) - beyond
        label = wrapped(self._labels[n], self._px(LABEL), int(max(room, 40 * unit)), 1)[0]
        left, top = place.left + 3 * unit, place.top + 3 * unit
        start = left + 8 * unit + width(label, self._px(LABEL)) + 10 * unit
        far = start + (wide + 6 * unit if wide else -2 * unit)
        base = top + 19 * unit
        low, high = self._span(left, far + beyond)
        rows = [
            boxes((low, top), (high, top + 26 * unit), self._theme["backdrop"], PLATE, corner=4 * unit),
            self._write(label, left + 8 * unit, base, LABEL, "ink"),
        ]
        if tally:
            rows.append(self._write(tally, start, base, LABEL, "quiet"))
        elif signed:
            rows.append(self._signs(n, time, start, base - 6 * unit))
        if lead:
            rows.append(self._write(lead, far + 4 * unit, base, LABEL, "ink"))
        return np.concatenate(rows)

    def _lead(self, n: int, time: float) -> str:
        """Say how many prey more than the first of several ways through the same trial one has kept up to a time."""
        if not self._paired or n == 0:
            return ""
        kept = [int((self._fates(cell, time) < CAPTURED).sum()) for cell in (0, n)]
        sign = "±" if kept[0] == kept[1] else "+" if kept[1] > kept[0] else "\N{MINUS SIGN}"
        return sign + self._words.whole(abs(kept[1] - kept[0]))

    def _tally(self, n: int, time: float) -> str:
        """Say what became of many prey, and what is measured where nothing can become of them."""
        if not self._ends[n]:
            each = self._measured[n]
            return f"{each.name} {each.text(time)} {each.unit}".rstrip() if each else ""
        if len(self._prey[n]) <= PIPS:
            return ""
        fates = self._fates(n, time)
        alive, dead = int((fates == ALIVE).sum()), int((fates >= CAPTURED).sum())
        counts = {"arrived": int((fates == ARRIVED).sum())} if target_of(self._scene.subjects[n]) else {"alive": alive}
        counts["dead"] = dead
        return " · ".join(f"{self._words.whole(number)} {self._words.say(f'fates.{name}')}" for name, number in counts.items())

    def _fates(self, n: int, time: float) -> np.ndarray:
        paths, prey = self._scene.paths, self._prey[n]
        return np.where(paths.end[prey] <= time, paths.fate[prey], ALIVE)

    def _signs(self, n: int, time: float, left: float, middle: float) -> np.ndarray:
        """Show the fate of each prey by its sign: the dead first, the arrived last."""
        ranked = np.sort([RANKS.index(FATES[fate]) for fate in self._fates(n, time)])[::-1]
        across = self._x(left + (np.arange(len(ranked)) + 0.5) * PIP * self._unit)
        spots = np.stack([across, np.full(len(ranked), middle)], axis=1)
        return np.concatenate(
            [signs(FATES.index(name), spots[ranked == k], SIGN * self._unit, self._theme) for k, name in enumerate(RANKS)]
        )

    def _progress(self, share: float, paint: Colour, alpha: float) -> np.ndarray:
        """Draw the line between the head and the cells."""
        if not self.progresses:
            return NONE
        high, (left, right) = 3 * self._unit, self._span(0.0, self._right * share)
        return boxes((left, self._head.height - high), (right, self._head.height), paint, alpha)
