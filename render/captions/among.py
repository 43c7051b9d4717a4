"""Among: what became of the prey in many other trials of the same scenario, as a histogram, and where this one stands."""

from dataclasses import dataclass

import numpy as np

from render.captions.caption import Caption, fated
from render.captions.layout import Box
from render.raster.glyphs import Atlas
from render.raster.shapes import boxes, discs
from render.scene.scene import Scene
from render.scene.signs import sign_paint
from tiswarm.records.recording import FATES

NAME, LEVEL = 15, 13
"""Sizes of its name and of the numbers below it."""

BARS = 40
"""Bars, at most: above so many prey a bar holds several counts."""


@dataclass(frozen=True)
class Among:
    """Outcomes of other trials. fate: "arrived", "captured" or "crashed"; counts: [trial], how many prey met it in each.

    Errors: ValueError for an unknown fate, or no trial.
    """

    fate: str
    counts: np.ndarray

    def __post_init__(self) -> None:
        if self.fate not in FATES[1:]:
            raise ValueError(f"among: unknown fate {self.fate!r}; use one of {', '.join(FATES[1:])}")
        if len(self.counts) == 0:
            raise ValueError("among: there are no other trials; give one or more")


class Histogram(Caption):
    """A histogram of outcomes, and a mark that goes as far as the film has come."""

    def __init__(self, scene: Scene, atlas: Atlas, unit: float, box: Box, among: Among):
        """Place it in a box."""
        super().__init__(scene, atlas, unit)
        self._among, self._fate, self._prey = among, FATES.index(among.fate), max(scene.paths.prey, 1)
        self._plot = Box(box.left, box.top + (NAME + 9) * unit, box.right, box.bottom - (LEVEL + 6) * unit)
        self._wide = -(-(self._prey + 1) // BARS)  # counts in a bar
        self._bars = -(-(self._prey + 1) // self._wide)

    def ground(self) -> list[np.ndarray]:
        """Draw its name, bars and numbers."""
        unit, plot, trials = self._unit, self._plot, len(self._among.counts)
        name = self._words.say("lines.among", trials, fate=fated(self._scene, self._fate))
        self._within(plot.left, plot.right)
        rows = [self._write(name, plot.left, plot.top - 8 * unit, NAME, "quiet")]
        self._turn = None  # numbers grow to the right in all languages
        many = np.bincount(np.clip(self._among.counts, 0, self._prey).astype(int) // self._wide, minlength=self._bars)
        step, there = plot.width / self._bars, np.flatnonzero(many)
        left = plot.left + (there + 0.08) * step
        high = plot.height * many[there] / many.max()
        low, far = np.stack([left, plot.bottom - high], 1), np.stack([left + 0.84 * step, np.full(len(there), plot.bottom)], 1)
        rows.append(boxes(low, far, self._theme["quiet"], 0.55))
        rows.append(boxes((plot.left, plot.bottom), (plot.right, plot.bottom + 1.2 * unit), self._theme["line"], 0.4))
        base = plot.bottom + (LEVEL + 5) * unit
        for count, align in ((0, "left"), (self._prey, "right")):
            x = plot.left if count == 0 else plot.right
            rows.append(self._write(self._words.whole(count), x, base, LEVEL, "quiet", align))
        return rows

    def frame(self, time: float) -> list[np.ndarray]:
        """Mark how many met that fate up to a time [ticks] in the trial that is shown."""
        return [discs((self.place(self.count(time)), self._plot.bottom), 4.5 * self._unit, sign_paint(self._fate, self._theme))]

    def count(self, time: float) -> int:
        """Count who met that fate up to a time [ticks]."""
        paths = self._scene.paths
        paths.reach(time)
        return int(((paths.end <= time) & paths.is_prey & (paths.fate == self._fate)).sum())

    def place(self, count: int) -> float:
        """Give where a count stands: the middle of its bar [px]."""
        return self._plot.left + (count // self._wide + 0.5) * self._plot.width / self._bars
