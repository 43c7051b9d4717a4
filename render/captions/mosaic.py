"""Several recordings at once: cells of one size, each with its label and what became of its prey, under one title and clock."""

from collections.abc import Sequence

import numpy as np

from render.captions.caption import Caption, pixels
from render.captions.layout import Box
from render.raster.glyphs import Atlas, width, wrapped
from render.raster.shapes import NONE, Colour, boxes, colour
from render.scene.scene import Scene
from render.scene.signs import signs
from render.scene.trajectories import ARRIVED, CAPTURED
from render.source import Live, target_of
from tiswarm.records.recording import FATES, Recording

EDGE, HEAD, FOOT, LABEL, GAP = 28, 62, 40, 28, 4
"""Rims of the frame, and room for labels [units of type]."""

PIPS = 12
"""More prey than this are counted in words instead of signs."""

SIGN = 4.2
"""Half the width of a sign [units of type]."""

PIP, PIPS_ACROSS = 11, 3
"""Distance of signs [units of type], and how many stand in a row beside a world."""

ASIDE = 10
"""Gap between a world and captions beside it [units of type]."""

RANKS = ("arrived", "alive", "captured", "crashed")
"""The order of the signs, from the right."""


def labels_of(recordings: Sequence[Recording | Live]) -> list[str]:
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
    return [f"trial {r.trial}" + (f" · seed {r.seed}" if seeds else "") for r in recordings]


def beside(subjects: Sequence[Recording | Live], labels: Sequence[str], unit: float) -> float:
    """Give the width that captions need beside worlds instead of above them [px]."""
    widths = [width(label, pixels(13, unit)) for label in labels]
    for each in subjects:
        prey = each.prey.count if isinstance(each, Recording) else each.scenario.prey.count
        words = f"{prey} {'arrived' if target_of(each) else 'alive'}"
        widths.append(width(words, pixels(12, unit)) if prey > PIPS else round(PIPS_ACROSS * PIP * unit))
    return max(widths) + ASIDE * unit


def cells(size: tuple[int, int], count: int, extent: tuple[float, float], unit: float, aside: float) -> tuple[list[Box], bool]:
    """Divide a frame into cells, captions left out, so that worlds of some extent [m] are as large as possible.

    aside: width of the captions if they stand on the worlds' left [px]; tell whether they do, or stand above.
    """
    whole = Box(EDGE * unit, HEAD * unit, size[0] - EDGE * unit, size[1] - FOOT * unit)

    def cut(columns: int, left: float, above: float) -> list[Box]:
        rows = -(-count // columns)
        wide = (whole.width - (columns - 1) * GAP * unit) / columns
        high = (whole.height - (rows - 1) * GAP * unit) / rows
        out = []
        for n in range(count):
            row, in_row = n // columns, min(columns, count - n // columns * columns)
            start = whole.left + (n % columns + (columns - in_row) / 2) * (wide + GAP * unit)
            top = whole.top + row * (high + GAP * unit)
            out.append(Box(start + left, top + above, start + wide, top + high))
        return out

    plans = [(cut(columns, 0, LABEL * unit), False) for columns in range(1, count + 1)]
    plans += [(cut(columns, aside, 0), True) for columns in range(1, count + 1)]
    return max(plans, key=lambda plan: _scale(plan[0][0], extent))


def _scale(cell: Box, extent: tuple[float, float]) -> float:
    return min(cell.width / extent[0], cell.height / extent[1])


class Mosaic(Caption):
    """The captions of several subjects."""

    def __init__(
        self,
        scene: Scene,
        places: Sequence[Box],
        labels: Sequence[str],
        size: tuple[int, int],
        atlas: Atlas,
        unit: float,
        aside: float,
    ):
        """Caption the subjects of a scene above their places, or, when `aside` [px] is above zero, that far to the left."""
        super().__init__(scene, atlas, unit)
        self._places, self._labels, self._size, self._aside = places, labels, size, aside
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
            room = self._aside if self._aside else place.width - self._tally_width(len(prey))
            base = place.top + (11 * unit if self._aside else -9 * unit)
            rows.append(self._write(wrapped(label, self._px(13), int(room), 1)[0], place.left - self._aside, base, 13, "ink"))
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
            return (prey + 1) * PIP * self._unit
        return width("0000 arrived · 0000 dead", self._px(12)) + 10 * self._unit

    def _tally(self, n: int, time: float) -> np.ndarray:
        """Show the fates of a subject's prey: signs, the arrived first, the dead last, or words for many."""
        paths, prey, place = self._scene.paths, self._prey[n], self._places[n]
        fates = np.where(paths.end[prey] <= time, paths.fate[prey], 0)
        base = place.top - 9 * self._unit
        if len(prey) > PIPS:
            counts = {"arrived": int((fates == ARRIVED).sum()), "dead": int((fates >= CAPTURED).sum())}
            alive = {"alive": int((fates == 0).sum()), "dead": counts["dead"]}
            shown = counts if target_of(self._scene.subjects[n]) else alive
            words = [f"{number} {name}" for name, number in shown.items()]
            if self._aside:
                tops = [place.top + (30 + 17 * line) * self._unit for line in range(len(words))]
                lines = [(word, place.left - self._aside, top, 12, "quiet") for word, top in zip(words, tops, strict=True)]
                return np.concatenate([self._write(*line, tabular=True) for line in lines])
            return self._write(" · ".join(words), place.right, base, 12, "quiet", "right", tabular=True)
        ranked = np.sort([RANKS.index(FATES[fate]) for fate in fates])[::-1]
        step = PIP * self._unit
        if self._aside:
            ranked_rows = np.divmod(np.arange(len(ranked))[::-1], PIPS_ACROSS)
            start = place.left - self._aside + step / 2, place.top + 26 * self._unit
            centres = [(start[0] + column * step, start[1] + row * step) for row, column in zip(*ranked_rows, strict=True)]
        else:
            centres = [(place.right - step * (n + 0.5), base - 4.5 * self._unit) for n in range(len(ranked))]
        spots, size = np.array(centres).reshape(-1, 2), SIGN * self._unit
        return np.concatenate([signs(FATES.index(name), spots[ranked == n], size, self._theme) for n, name in enumerate(RANKS)])

    def _progress(self, share: float, paint: Colour, alpha: float) -> np.ndarray:
        left, right, y, half = EDGE * self._unit, self._size[0] - EDGE * self._unit, self._size[1] - 18 * self._unit, self._unit
        return boxes((left, y - half), (left + (right - left) * share, y + half), paint, alpha, corner=half)
