"""Charts of a caption: what a recording measures, against time, as far as the film has come."""

from dataclasses import dataclass

import numpy as np

from render.captions.among import Histogram
from render.captions.caption import Caption, fated, possible_ends
from render.captions.layout import Box
from render.captions.measured import UNITS, called
from render.raster.glyphs import Atlas
from render.raster.shapes import Colour, boxes, capsules, colour, discs
from render.scene.lettering import rounded_up
from render.scene.scene import Scene
from render.scene.signs import sign_paint
from render.scene.trajectories import ALIVE
from tiswarm.measures.recorded import MEANS
from tiswarm.records.recording import FATES, Recording

NAME, LEVEL = 15, 13
"""Sizes of a chart's name and of the numbers at its sides."""

LEAST, MOST, BETWEEN = 64, 150, 14
"""Height of a chart, at least and at most, and the gap between two [units of type]."""

AROUND = 48
"""Room above and below charts in a strip [units of type]."""

KNOTS = 300
"""Points of a line, at most: more cannot be told apart."""


@dataclass(frozen=True)
class Series:
    """What is drawn: values [tick], NaN where there is none, from 0 to `top`."""

    name: str
    unit: str
    values: np.ndarray
    top: float
    paint: Colour


def chartable(scene: Scene) -> list[str]:
    """Name what is worth a chart of a scene of one recording: what its preset is about, then who lives."""
    subject = scene.subjects[0]
    if not isinstance(subject, Recording) or subject.ticks < 2:
        return []
    return [*subject.scenario.film.measures, *(["alive"] if possible_ends(scene, 0) else [])]


def series(scene: Scene, name: str) -> Series:
    """Measure a recording at all its ticks. name: "alive", or one of scenario.measures.Shown."""
    recording = scene.subjects[0]
    assert isinstance(recording, Recording)
    paint = colour(scene.theme.prey[0])
    if name == "alive":
        return Series(
            fated(scene, ALIVE), "", recording.prey.alive.sum(axis=1).astype(float), float(max(recording.prey.count, 1)), paint
        )
    values = MEANS[name](recording)
    largest = float(np.nanmax(values)) if np.isfinite(values).any() else 1.0
    top = 1.0 if name in ("polarisation", "milling") else rounded_up(largest)
    unit = scene.look.wording.unit(UNITS.get(name, ""))
    return Series(called(scene, 0, name), unit, values, top, paint)


class Charts(Caption):
    """Charts, one above the other."""

    def __init__(self, scene: Scene, atlas: Atlas, unit: float, box: Box, wanted: tuple[str, ...] | None):
        """Place as many charts as a box has room for. wanted: what they show; None for what is worth it.

        Errors: ValueError where other trials are to be shown and there is no room for them.
        """
        super().__init__(scene, atlas, unit)
        names = chartable(scene) if wanted is None else [each for each in wanted if isinstance(scene.subjects[0], Recording)]
        room = int((box.height / unit + BETWEEN) // (LEAST + BETWEEN))
        among = scene.look.among
        if among is not None and room < 1:
            raise ValueError("among: there is no room for it in this caption; choose another --size, larger or less wide")
        names = names[: max(room - (among is not None), 0)]
        self._lines = [series(scene, name) for name in names]
        many = len(names) + (among is not None)
        high = min((box.height + BETWEEN * unit) / max(many, 1) - BETWEEN * unit, MOST * unit)
        tops = [box.top + n * (high + BETWEEN * unit) for n in range(many)]
        self._plots = [Box(box.left, top + (NAME + 9) * unit, box.right, top + high) for top in tops[: len(names)]]
        last = Box(box.left, tops[-1], box.right, tops[-1] + high) if among else box
        self.among = Histogram(scene, atlas, unit, last, among) if among else None
        self._drawn = [self._line(each, plot) for each, plot in zip(self._lines, self._plots, strict=True)]

    def ground(self) -> list[np.ndarray]:
        """Draw names, axes, and what they reach to."""
        unit, rows = self._unit, self.among.ground() if self.among else []
        for each, plot in zip(self._lines, self._plots, strict=True):
            base = plot.top - 8 * unit
            self._within(plot.left, plot.right)  # time runs to the right in all languages, words do not
            rows.append(self._write(each.name, plot.left, base, NAME, "quiet"))
            whole = not each.unit and each.top == round(each.top)
            top = self._words.whole(round(each.top)) if whole else f"{self._words.short(each.top)} {each.unit}".rstrip()
            rows.append(self._write(top, plot.right, base, LEVEL, "quiet", "right"))
            for y, alpha in ((plot.top, 0.14), (plot.bottom, 0.4)):
                rows.append(boxes((plot.left, y - 0.6 * unit), (plot.right, y + 0.6 * unit), self._theme["line"], alpha))
        return rows

    def frame(self, time: float) -> list[np.ndarray]:
        """Draw the lines as far as a time [ticks], and a mark on the axis for each prey that met its end."""
        rows = self.among.frame(time) if self.among else []
        for each, plot, (starts, pieces) in zip(self._lines, self._plots, self._drawn, strict=True):
            rows += [self._ends(time, plot), pieces[: int(np.searchsorted(starts, time))]]
            tick = min(time, len(each.values) - 1)
            value = float(np.interp(tick, np.arange(len(each.values)), each.values))
            if np.isfinite(value):
                spot = self._spots(np.array([tick]), np.array([value]), each, plot)
                rows.append(discs(spot, 3.4 * self._unit, each.paint))
        return rows

    def _spots(self, ticks: np.ndarray, values: np.ndarray, each: Series, plot: Box) -> np.ndarray:
        x = plot.left + plot.width * ticks / max(len(each.values) - 1, 1)
        return np.stack([x, plot.bottom - plot.height * np.clip(values / each.top, 0, 1)], axis=1)

    def _line(self, each: Series, plot: Box) -> tuple[np.ndarray, np.ndarray]:
        """Give the ticks at which the pieces of a line begin, and the pieces."""
        ticks = np.linspace(0, len(each.values) - 1, min(len(each.values), KNOTS))
        values = np.interp(ticks, np.arange(len(each.values)), each.values)
        spots, half = self._spots(ticks, values, each, plot), max(1.1 * self._unit, 0.7)
        known = np.isfinite(values[:-1]) & np.isfinite(values[1:])
        return ticks[:-1][known], capsules(spots[:-1][known], spots[1:][known], half, half, each.paint, 0.95, group=1)

    def _ends(self, time: float, plot: Box) -> np.ndarray:
        paths, unit = self._scene.paths, self._unit
        paths.reach(time)
        gone = np.flatnonzero(paths.is_prey & (paths.end <= time) & (paths.fate != ALIVE))
        x = plot.left + plot.width * paths.end[gone] / max(paths.last, 1)
        low = np.stack([x - 0.9 * unit, np.full(len(gone), plot.bottom - 7 * unit)], axis=1)
        paints = np.array([sign_paint(fate, self._theme) for fate in range(len(FATES))])[paths.fate[gone]]
        return boxes(low, low + np.array((1.8, 7.0)) * unit, paints, 0.9)


def height_for(count: int) -> float:
    """Give the height that a strip needs for so many charts, with room around them [units of type]."""
    return count * (LEAST + BETWEEN) + AROUND if count else 0.0
