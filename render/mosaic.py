"""Several recordings at once: cells of one size, each with its label and what became of its prey, under one title and clock."""

from collections.abc import Sequence

import numpy as np

from render.layout import Box
from render.motion import Motion
from render.scene import Scene
from render.shapes import NONE, Colour, boxes, colour, discs
from render.text import Atlas, width, wrapped
from render.theme import Theme
from tiswarm.recording import Recording

EDGE, HEAD, FOOT, LABEL, GAP = 28, 62, 40, 28, 14
"""Rims of the frame, and room for labels [units of type]."""

PIPS = 12
"""More prey than this are counted in words instead of dots."""

FATES = ("alive", "arrived", "captured", "crashed")


def labels_of(recordings: Sequence[Recording]) -> list[str]:
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


class Mosaic:
    """The captions of several recordings."""

    def __init__(
        self,
        scenes: Sequence[Scene],
        places: Sequence[Box],
        labels: Sequence[str],
        size: tuple[int, int],
        atlas: Atlas,
        unit: float,
    ):
        """Caption scenes in their places."""
        self._scenes, self._places, self._labels = scenes, places, labels
        self._size, self._atlas, self._unit = size, atlas, unit
        self._theme: Theme = scenes[0].theme
        self._tallies: dict[int, tuple[int, np.ndarray]] = {}  # counts change seldom: their shapes are kept until they do
        self._ticks = max(scene.paths.ticks for scene in scenes)

    def ground(self) -> np.ndarray:
        """Draw what stands still: title, labels, the track of the progress line."""
        unit, recording = self._unit, self._scenes[0].recording
        left, right = EDGE * unit, self._size[0] - EDGE * unit
        clock = 150 * unit
        title = wrapped(recording.scenario.title, self._px(20), int(right - left - clock), 1)[0]
        shared = len({scene.recording.trial for scene in self._scenes}) == 1
        note = (
            f"trial {recording.trial} · seed {recording.seed}"
            if shared
            else f"{len(self._scenes)} trials · seed {recording.seed}"
        )
        rows = [
            self._write(title, left, 34 * unit, 20, "ink"),
            self._write(note, left, 54 * unit, 12, "quiet"),
            self._progress(1.0, self._theme["line"], 0.25),
        ]
        for label, place, scene in zip(self._labels, self._places, self._scenes, strict=True):
            name = wrapped(label, self._px(13), int(place.width - self._tally_width(scene.paths)), 1)[0]
            rows.append(self._write(name, place.left, place.top - 9 * unit, 13, "ink"))
        return np.concatenate(rows)

    def frame(self, time: float) -> np.ndarray:
        """Draw what changes: clock, progress, fates."""
        unit, now = self._unit, min(time, self._ticks)
        right = self._size[0] - EDGE * unit
        digits = f"{now * self._scenes[0].recording.scenario.world.dt:.1f}"
        rows = [
            self._write(digits, right - 16 * unit, 42 * unit, 28, "ink", "right", tabular=True),
            self._write("s", right, 42 * unit, 16, "quiet", "right"),
            self._progress(now / self._ticks if self._ticks else 1.0, colour(self._theme.prey[0]), 0.9),
        ]
        rows += [self._tally(scene.paths, place, time) for scene, place in zip(self._scenes, self._places, strict=True)]
        return np.concatenate(rows)

    def _px(self, units: float) -> int:
        return max(round(units * self._unit), 7)

    def _write(
        self, text: str, x: float, y: float, size: float, paint: str, align: str = "left", *, tabular: bool = False
    ) -> np.ndarray:
        return self._atlas.line(text, (x, y), self._px(size), self._theme[paint], align=align, tabular=tabular)

    def _tally_width(self, paths: Motion) -> float:
        if paths.prey <= PIPS:
            return (paths.prey + 1) * 11 * self._unit
        return width("0000 arrived · 0000 dead", self._px(12)) + 10 * self._unit

    def _tally(self, paths: Motion, place: Box, time: float) -> np.ndarray:
        """Show the prey's fates: a dot for each, the arrived first and the dead last, or words when they are many."""
        gone = int((paths.end[: paths.prey] <= time).sum())
        if self._tallies.get(id(paths), (-1, NONE))[0] == gone:
            return self._tallies[id(paths)][1]
        self._tallies[id(paths)] = gone, self._counted(paths, place, time)
        return self._tallies[id(paths)][1]

    def _counted(self, paths: Motion, place: Box, time: float) -> np.ndarray:
        fates = np.where(paths.end[: paths.prey] <= time, paths.fate[: paths.prey], "alive")
        base = place.top - 9 * self._unit
        if paths.prey > PIPS:
            arrived, dead = int((fates == "arrived").sum()), int(np.isin(fates, FATES[2:]).sum())
            return self._write(f"{arrived} arrived · {dead} dead", place.right, base, 12, "quiet", "right", tabular=True)
        order = ("arrived", "alive", "captured", "crashed")
        ranked = sorted((order.index(fate) for fate in fates), reverse=True)
        paints = [colour(self._theme.prey[0]) if order[n] == "alive" else self._theme[order[n]] for n in ranked]
        step = 11 * self._unit
        centres = [(place.right - step * (n + 0.5), base - 4.5 * self._unit) for n in range(len(ranked))]
        return discs(np.array(centres), 3.6 * self._unit, np.array(paints))

    def _progress(self, share: float, paint: Colour, alpha: float) -> np.ndarray:
        left, right, y, half = EDGE * self._unit, self._size[0] - EDGE * self._unit, self._size[1] - 18 * self._unit, self._unit
        return boxes((left, y - half), (left + (right - left) * share, y + half), paint, alpha, corner=half)
