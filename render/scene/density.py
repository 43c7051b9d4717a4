"""Density: agents too many to be drawn one by one, as a cloud that is denser and brighter where they crowd."""

from typing import TYPE_CHECKING

import numpy as np

from render.language import Language
from render.raster.glyphs import Atlas
from render.raster.shapes import NONE, WINDOW, cloud
from render.scene.camera import Camera, Orbit
from render.scene.orbits import START, axes
from render.scene.scale import moments, most, scale_of
from render.scene.snapshot import Snapshot, images
from render.scene.trajectories import Trajectories
from render.source import is_endless
from render.theme import Theme
from tiswarm.records.recording import Recording
from tiswarm.space import box

if TYPE_CHECKING:
    from render.scene.cells import Cells

BLUR = 8
"""Each agent is spread over the cells around its own, by one and a half of them: so often each cell is added to the next."""

SPREAD = 0.85
"""Edge of a cell, in mean distances between agents: as fine as their number lets it be without grain."""

COARSEST, FINEST = 56, 512
"""Cells along the longer side, at least and at most."""

AWAY = 0.5
"""How far beyond an open world the cloud goes on [share of the world's size]."""


class Density:
    """Clouds of agents: over the ground of flat worlds, between the eye and the walls of 3-D ones."""

    def __init__(self, paths: Trajectories, theme: Theme, lone: np.ndarray, atlas: Atlas, words: Language):
        """Prepare. lone: [agent], who is drawn one by one; the others make the cloud, or all when all are. atlas: takes it."""
        self._paths, self._theme, self._atlas = paths, theme, atlas
        self._counted = np.full_like(lone, True) if lone.all() else ~lone
        self._written: list[tuple[np.ndarray, np.ndarray]] = []
        self._cells: dict[int, Cells] = {}  # of each subject
        self._many = [int((self._counted & (paths.scene == scene)).sum()) for scene in range(len(paths.subjects))]
        self.scale = scale_of(theme, self._most(), veiled=bool(lone.all()), counted=self._words(words))

    def _words(self, words: Language) -> str:
        """Say what is counted, and across what: in space all that lie behind each other."""
        prey, scenario = self._counted & self._paths.is_prey, self._paths.subjects[0].scenario
        alone = (prey == self._counted).all()
        who = words.noun(scenario, "prey", int(prey.sum())) if alone else words.say("lines.agents")
        return words.say("lines.density-view" if self._paths.dim == 3 else "lines.density", who=who)

    def _most(self) -> float:
        """Find where the scale must end [agents/m²]: it does not change as they move."""
        paths, found = self._paths, []
        for scene, (subject, many) in enumerate(zip(paths.subjects, self._many, strict=True)):
            mine = paths.scene == scene
            size = np.array(subject.scenario.world.size, float) if paths.dim == 2 else None
            for spots in moments(subject, paths.spots(0.0)[mine]):
                there = spots[self._counted[mine] & np.isfinite(spots[:, 0])]
                if len(there):
                    found.append(_around(there @ axes(START)[:2].T if paths.dim == 3 else there, many, size))
        return most(found, live=not isinstance(paths.subjects[0], Recording))

    def drawn(self, here: Snapshot, camera: Camera, windows: np.ndarray) -> np.ndarray:
        """Draw the clouds of all subjects. windows: [subject, 4], where each is shown [px]."""
        rows = [NONE]
        self._written.clear()
        there = self._counted & (here.time < self._paths.end)
        for scene, many in enumerate(self._many):
            agents = np.flatnonzero(there if len(self._many) == 1 else there & (self._paths.scene == scene))
            if not len(agents):
                continue
            own, spots = camera.of(agents[0]), here.spot if len(agents) == len(here.spot) else here.spot[agents]
            if isinstance(own, Orbit):
                drawn = self._deep(spots, many, scene, own, windows[scene])
            else:
                drawn = self._flat(spots, many, scene, own, windows[scene])
            for each in drawn:
                each[:, WINDOW] = scene
            rows += drawn
        if self._written:
            self._atlas.take(*map(list, zip(*self._written, strict=True)))
        return np.concatenate(rows)

    def _flat(self, spots: np.ndarray, many: int, scene: int, camera: Camera, window: np.ndarray) -> list[np.ndarray]:
        """Spread agents over the ground, whatever the camera does: the cloud does not crawl when it moves."""
        from render.scene.cells import Cells

        world = self._paths.subjects[scene].scenario.world
        size = np.array(world.size[:2], float)
        cells = _cells(size, many)
        edges = np.array(
            [
                camera.centre + (window[[0, 3]] - camera.middle) * (1, -1) / camera.scale,
                camera.centre + (window[[2, 1]] - camera.middle) * (1, -1) / camera.scale,
            ]
        )
        edge, first, past = size / cells, np.zeros(2, int), cells  # of the cells, numbered from the world's corner
        if not box.bounded(world.boundary):  # as far as the cloud goes on, and can be seen
            rim, seen = np.ceil(AWAY * cells), edges / edge
            first = np.clip(np.floor(seen[0]) - BLUR, -rim, cells + rim - 1).astype(int)
            past = np.clip(np.ceil(seen[1]) + BLUR, first + 1, cells + rim).astype(int)
        low, far, cells = first * edge, past * edge, past - first
        mode = "wrap" if box.wraps(world.boundary) else "symmetric" if box.bounded(world.boundary) else "constant"
        own = self._cells.setdefault(scene, Cells())
        steps = own.steps(spots, low, far, cells, mode, float(np.prod(cells / (far - low))), self.scale.top)
        start, shapes = self._write(steps, self.scale.colours), []
        period = box.period(world.size[:2], world.boundary)
        seen = np.concatenate([edges[0] - size / 2, edges[1] + size / 2])
        _, shifts = images((size / 2)[None], seen[None], period[None])
        for shift in shifts:
            left, bottom = camera.place(low + shift)
            right, top = camera.place(far + shift)
            shapes.append(cloud((left, top), (right, bottom), (int(cells[0]), int(cells[1])), start))
        return shapes

    def _deep(self, spots: np.ndarray, many: int, scene: int, camera: Orbit, window: np.ndarray) -> list[np.ndarray]:
        """Spread agents over the screen, the far ones hazy; below, their shadow.

        What looks n times as large covers n² times the screen, and counts n² times: a colour tells what is behind each other.
        """
        rows = [] if is_endless(self._paths.subjects[scene]) else [self._shadow(spots, many, camera, window)]
        screen, near = _Screen(camera.place(spots), many, window), camera.nearness(spots)
        counted = screen.counted(near**2)
        haze = camera.haze(screen.counted(near**3) / np.maximum(counted, 1e-9))
        texels = self.scale.colours.take(self.scale.level(counted * camera.scale**2), axis=0) * (1 - haze).astype(np.float32)
        return [*rows, cloud(screen.low, screen.high, screen.cells, self._write(_one_each(texels), texels))]

    def _shadow(self, spots: np.ndarray, many: int, camera: Orbit, window: np.ndarray) -> np.ndarray:
        """Let the cloud's shadow fall on the ground."""
        fallen = _Screen(camera.place(spots[:, :2]), many, window)
        dark = self._theme.shadow_alpha * (1 - np.exp(-0.5 * fallen.averages()))[..., None]
        shade = np.concatenate([dark * self._theme["shadow"], dark], axis=2, dtype=np.float32)
        return cloud(fallen.low, fallen.high, fallen.cells, self._write(_one_each(shade), shade))

    def _write(self, cells: np.ndarray, colours: np.ndarray) -> int:
        """Hand over cells [row, column], numbers of colours [..., 4]; return the number of the first."""
        first = sum(each.size for each, _ in self._written)
        own = cells if not self._written else cells + sum(len(each) for _, each in self._written)
        self._written.append((own.ravel(), colours.reshape(-1, 4)))
        return first


def _one_each(texels: np.ndarray) -> np.ndarray:
    """Give each cell of texels [row, column, 4] a colour of its own: its number."""
    return np.arange(texels[..., 0].size, dtype=np.int32).reshape(texels.shape[:2])


class _Screen:
    """The part of a window that points fill, divided into cells."""

    def __init__(self, places: np.ndarray, many: int, window: np.ndarray):
        """Divide it for `many` agents. places: [point, 2], window: x0, y0, x1, y1, px."""
        low, high = places.min(axis=0), places.max(axis=0)
        rim = 0.02 * (high - low) + 4  # room for what the blur spreads
        self.low = np.maximum(low - rim, window[:2])
        self.high = np.maximum(np.minimum(high + rim, window[2:]), self.low + 1)
        self._size = _cells(self.high - self.low, many)
        self.cells = int(self._size[0]), int(self._size[1])
        self._places, self._many = (places - self.low) / (self.high - self.low), many

    def counted(self, weights: np.ndarray) -> np.ndarray:
        """Give how many points there are on a pixel, with a rim: [row, column]. weights: [point]."""
        area = np.prod((self.high - self.low) / self._size)
        return _counted(self._places, self._size, "constant", weights) / area

    def averages(self) -> np.ndarray:
        """Give how crowded cells are, in averages, with a rim: [row, column]."""
        return _counted(self._places, self._size, "constant") * (np.prod(self._size) / self._many)


def _around(spots: np.ndarray, many: int, size: np.ndarray | None) -> np.ndarray:
    """Give how crowded it is around each of some points [point, 2], m: agents/m², spread as in a cloud of so many.

    size: of the flat world that is divided into cells [m]; None for what fills a screen itself.
    """
    low, high = spots.min(axis=0) - 1e-6, spots.max(axis=0) + 1e-6
    whole = high - low if size is None else size
    edge = whole / _cells(whole, many)
    cells = np.maximum(np.ceil((high - low) / edge - 1e-9), 1).astype(int)
    at = np.minimum((spots - low) / edge, cells - 1).astype(int)
    return _counted((spots - low) / (edge * cells), cells, "constant")[at[:, 1] + 1, at[:, 0] + 1] / np.prod(edge)


def _cells(size: np.ndarray, many: int) -> np.ndarray:
    """Divide a rectangle into cells for so many agents: columns and rows."""
    longer = size.max()
    edge = np.clip(SPREAD * np.sqrt(np.prod(size) / many), longer / FINEST, longer / COARSEST)
    return np.maximum(np.round(size / edge), 1).astype(int)


def _counted(places: np.ndarray, cells: np.ndarray, mode: str, weights: np.ndarray | None = None) -> np.ndarray:
    """Count points in cells, spread a little, with a rim of one cell: [rows + 2, columns + 2] of float32.

    places: [point, 2], 0 to 1 in both. mode: what lies beyond the edge, as np.pad names it. weights: [point], 1 when None.
    """
    columns, rows = cells
    x, y = (places * cells).T
    inside = (x >= 0) & (x < columns) & (y >= 0) & (y < rows)  # who is nowhere is not
    if not inside.all():
        x, y, weights = x[inside], y[inside], None if weights is None else weights[inside]
    number = y.astype(np.int64) * columns + x.astype(np.int64)
    return _spread(np.bincount(number, weights, minlength=rows * columns).reshape(rows, columns), mode)


def _spread(counts: np.ndarray, mode: str) -> np.ndarray:
    """Spread counts [row, column] over the cells around, with a rim of one cell; mode: as for `_counted`."""
    padded = np.pad(counts.astype(np.float32), BLUR // 2 + 1, mode=mode)  # type: ignore[call-overload]
    for _ in range(BLUR):
        padded = padded[1:] + padded[:-1]
    for _ in range(BLUR):
        padded = padded[:, 1:] + padded[:, :-1]
    return padded * np.float32(0.25**BLUR)
