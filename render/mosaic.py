"""Several recordings at once: cells of one size, each with its label and what became of its prey, under one title and clock."""

from collections.abc import Sequence

import numpy as np

from render.caption import Caption
from render.layout import Box
from render.live import Live, target_of
from render.motion import ARRIVED, CAPTURED
from render.scene import Scene
from render.shapes import NONE, Colour, boxes, colour, discs
from render.text import Atlas, width, wrapped
from tiswarm.recording import FATES, Recording

EDGE, HEAD, FOOT, LABEL, GAP = 28, 62, 40, 28, 4
"""Rims of the frame, and room for labels [units of type]."""

PIPS = 12
"""More prey than this are counted in words instead of dots."""

RANKS = ("arrived", "alive", "captured", "crashed")
"""The order of the dots, from the right."""


def labels_of(recordings: Sequence[Recording | Live]) -> list[str]:
    """Name recordings by what tells them apart: strategies, else seed and trial."""
    ways = [
        (r.scenario.prey.strategy, r.scenario.prey.avoidance, r.scenario.predators.strategy, r.scenario.predators.avoidance)
        for r in recordings
    ]
    differing = [n for n in range(4) if len({way[n] for way in ways}) > 1]
    if differing:
        return [" · ".join(way[n] for n in differing) for way in ways]
    seeds = len({r.seed for r in recordings}) > 1
    return [f"trial {r.trial}" + (f" · seed {r.seed}" if seeds else "") for r in recordings]


def cells(size: tuple[int, int], count: int, extent: tuple[float, float], unit: float) -> list[Box]:
    """Divide a frame into cells, labels left out, so that worlds of some extent [m] are as large as possible."""
    whole = Box(EDGE * unit, HEAD * unit, size[0] - EDGE * unit, size[1] - FOOT * unit)

    def cut(columns: int) -> list[Box]:
        rows = -(-count // columns)
        wide = (whole.width - (columns - 1) * GAP * unit) / columns
        high = (whole.height - (rows - 1) * GAP * unit) / rows
        out = []
        for n in range(count):
            row, in_row = n // columns, min(columns, count - n // columns * columns)
            left = whole.left + (n % columns + (columns - in_row) / 2) * (wide + GAP * unit)
            top = whole.top + row * (high + GAP * unit)
            out.append(Box(left, top + LABEL * unit, left + wide, top + high))
        return out

    return max((cut(columns) for columns in range(1, count + 1)), key=lambda each: _scale(each[0], extent))


def _scale(cell: Box, extent: tuple[float, float]) -> float:
    return min(cell.width / extent[0], cell.height / extent[1])


class Mosaic(Caption):
    """The captions of several subjects."""

    def __init__(
        self, scene: Scene, places: Sequence[Box], labels: Sequence[str], size: tuple[int, int], atlas: Atlas, unit: float
    ):
        """Caption the subjects of a scene in their places."""
        super().__init__(scene, atlas, unit)
        self._places, self._labels, self._size = places, labels, size
        paths = scene.paths
        self._prey = [np.flatnonzero(paths.is_prey & (paths.scene == n)) for n in range(len(places))]
        self._tallies = [NONE] * len(places)  # counts change seldom: their shapes are kept until they do
        self._gone = np.full(len(places), -1)

    def ground(self) -> np.ndarray:
        """Draw what stands still: title, labels, the track of the progress line."""
        unit, subjects = self._unit, self._scene.subjects
        left, right = EDGE * unit, self._size[0] - EDGE * unit
        clock = 150 * unit
        title = wrapped(subjects[0].scenario.title, self._px(20), int(right - left - clock), 1)[0]
        shared = len({subject.trial for subject in subjects}) == 1
        trials = f"trial {subjects[0].trial}" if shared else f"{len(subjects)} trials"
        note = f"{trials} · seed {subjects[0].seed}"
        rows = [
            self._write(title, left, 34 * unit, 20, "ink"),
            self._write(note, left, 54 * unit, 12, "quiet"),
            self._progress(1.0, self._theme["line"], 0.25),
        ]
        for label, place, prey in zip(self._labels, self._places, self._prey, strict=True):
            name = wrapped(label, self._px(13), int(place.width - self._tally_width(len(prey))), 1)[0]
            rows.append(self._write(name, place.left, place.top - 9 * unit, 13, "ink"))
        return np.concatenate(rows)

    def frame(self, time: float) -> np.ndarray:
        """Draw what changes: clock, progress, fates."""
        unit, ticks = self._unit, self._scene.paths.last
        now, right = min(time, ticks), self._size[0] - EDGE * self._unit
        digits = f"{now * self._scene.subjects[0].scenario.world.dt:.1f}"
        rows = [
            self._write(digits, right - 16 * unit, 42 * unit, 28, "ink", "right", tabular=True),
            self._write("s", right, 42 * unit, 16, "quiet", "right"),
            self._progress(now / ticks if ticks else 1.0, colour(self._theme.prey[0]), 0.9),
        ]
        paths = self._scene.paths
        gone = np.bincount(paths.scene[: paths.prey][paths.end[: paths.prey] <= time], minlength=len(self._places))
        for n in np.flatnonzero(gone != self._gone):
            self._tallies[n] = self._tally(int(n), time)
        self._gone = gone
        return np.concatenate([*rows, *self._tallies])

    def _tally_width(self, prey: int) -> float:
        if prey <= PIPS:
            return (prey + 1) * 11 * self._unit
        return width("0000 arrived · 0000 dead", self._px(12)) + 10 * self._unit

    def _tally(self, n: int, time: float) -> np.ndarray:
        """Show the fates of a subject's prey: a dot for each, the arrived first, the dead last, or words when they are many."""
        paths, prey, place = self._scene.paths, self._prey[n], self._places[n]
        fates = np.where(paths.end[prey] <= time, paths.fate[prey], 0)
        base = place.top - 9 * self._unit
        if len(prey) > PIPS:
            counts = {"arrived": int((fates == ARRIVED).sum()), "dead": int((fates >= CAPTURED).sum())}
            shown = counts if target_of(self._scene.subjects[n]) else {"alive": int((fates == 0).sum()), **counts}
            words = " · ".join(f"{number} {name}" for name, number in shown.items())
            return self._write(words, place.right, base, 12, "quiet", "right", tabular=True)
        ranked = sorted((RANKS.index(FATES[fate]) for fate in fates), reverse=True)
        paints = [colour(self._theme.prey[0]) if RANKS[n] == "alive" else self._theme[RANKS[n]] for n in ranked]
        step = 11 * self._unit
        centres = [(place.right - step * (n + 0.5), base - 4.5 * self._unit) for n in range(len(ranked))]
        return discs(np.array(centres).reshape(-1, 2), 3.6 * self._unit, np.array(paints).reshape(-1, 3))

    def _progress(self, share: float, paint: Colour, alpha: float) -> np.ndarray:
        left, right, y, half = EDGE * self._unit, self._size[0] - EDGE * self._unit, self._size[1] - 18 * self._unit, self._unit
        return boxes((left, y - half), (left + (right - left) * share, y + half), paint, alpha, corner=half)
