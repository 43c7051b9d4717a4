"""Density: agents too many to be drawn one by one, as a cloud that is denser and brighter where they crowd."""

import numpy as np

from render.raster.glyphs import Atlas
from render.raster.shapes import NONE, WINDOW, cloud, colour
from render.scene.camera import Camera, Orbit
from render.scene.snapshot import Snapshot, images
from render.scene.trajectories import Trajectories
from render.source import is_endless
from render.theme import Theme
from tiswarm.space import box

BLUR = np.array([1, 8, 28, 56, 70, 56, 28, 8, 1], np.float32) / 256
"""Each agent is spread over the cells around its own, by about one and a half of them."""

SPREAD = 0.85
"""Edge of a cell, in mean distances between agents: as fine as their number lets it be without grain."""

COARSEST, FINEST = 56, 512
"""Cells along the longer side, at least and at most."""

BRIGHTEST = 8
"""The scale of colours ends where agents are this many times as crowded as on average: it must not change as they move."""

DEEP = 2.5
"""In space agents add up along a line of sight: it takes this many times as many for the same colour."""

THIN = 1.2
"""How fast a cloud becomes opaque: with average density its opacity is 1 - exp(-THIN)."""

OPAQUE, VEIL = 0.96, 0.55
"""Opacity of the densest cloud that stands for its agents, and of one that lies under agents who are drawn as well."""

STEPS = 1024
"""Colours of the scale."""

AWAY = 0.5
"""How far beyond an open world the cloud goes on [share of the world's size]."""


class Density:
    """Clouds of agents: over the ground of flat worlds, between the eye and the walls of 3-D ones."""

    def __init__(self, paths: Trajectories, theme: Theme, lone: np.ndarray, atlas: Atlas):
        """Prepare. lone: [agent], who is drawn one by one; the others make the cloud, or all when all are. atlas: takes it."""
        self._paths, self._theme, self._atlas = paths, theme, atlas
        self._counted = np.full_like(lone, True) if lone.all() else ~lone
        level = np.linspace(0, 1, STEPS)
        most = VEIL if lone.all() else OPAQUE
        opacity = most * (1 - np.exp(-THIN * np.expm1(level * np.log1p(BRIGHTEST))))
        stops = np.array([colour(each) for each in theme.heat])
        light = np.stack([np.interp(level, (0, 0.5, 1), stops[:, n]) for n in range(3)], axis=1)
        self._scale = np.column_stack([light * opacity[:, None], opacity]).astype(np.float32)
        self._texels: list[np.ndarray] = []
        self._many = [int((self._counted & (paths.scene == scene)).sum()) for scene in range(len(paths.subjects))]

    def drawn(self, here: Snapshot, camera: Camera, windows: np.ndarray) -> np.ndarray:
        """Draw the clouds of all subjects. windows: [subject, 4], where each is shown [px]."""
        rows = [NONE]
        self._texels.clear()
        there = self._counted & (here.time < self._paths.end)
        for scene, many in enumerate(self._many):
            agents = np.flatnonzero(there if len(self._many) == 1 else there & (self._paths.scene == scene))
            if not len(agents):
                continue
            own, spots = camera.of(agents[0]), here.spot[agents]
            if isinstance(own, Orbit):
                drawn = self._deep(spots, many, scene, own, windows[scene])
            else:
                drawn = self._flat(spots, many, scene, own, windows[scene])
            for each in drawn:
                each[:, WINDOW] = scene
            rows += drawn
        if self._texels:
            self._atlas.texels = np.concatenate(self._texels)
        return np.concatenate(rows)

    def _flat(self, spots: np.ndarray, many: int, scene: int, camera: Camera, window: np.ndarray) -> list[np.ndarray]:
        """Spread agents over the ground, whatever the camera does: the cloud does not crawl when it moves."""
        world = self._paths.subjects[scene].scenario.world
        size = np.array(world.size[:2], float)
        cells = _cells(size, many)
        low, far = np.zeros(2), size
        if not box.bounded(world.boundary):
            rim = np.ceil(AWAY * cells)
            low, far, cells = -rim * size / cells, size + rim * size / cells, cells + 2 * rim.astype(int)
        mode = "wrap" if box.wraps(world.boundary) else "symmetric" if box.bounded(world.boundary) else "constant"
        crowd = _counted((spots - low) / (far - low), cells, mode) * (np.prod(size / (far - low)) * np.prod(cells) / many)
        texels = self._scale.take(self._level(crowd), axis=0)[::-1]  # y points up in the world, down on the screen
        first, shapes = self._write(texels), []
        edges = np.array(
            [
                camera.centre + (window[[0, 3]] - camera.middle) * (1, -1) / camera.scale,
                camera.centre + (window[[2, 1]] - camera.middle) * (1, -1) / camera.scale,
            ]
        )
        period = box.period(world.size[:2], world.boundary)
        seen = np.concatenate([edges[0] - size / 2, edges[1] + size / 2])
        _, shifts = images((size / 2)[None], seen[None], period[None])
        for shift in shifts:
            left, bottom = camera.place(low + shift)
            right, top = camera.place(far + shift)
            shapes.append(cloud((left, top), (right, bottom), (int(cells[0]), int(cells[1])), first))
        return shapes

    def _deep(self, spots: np.ndarray, many: int, scene: int, camera: Orbit, window: np.ndarray) -> list[np.ndarray]:
        """Spread agents over the screen: the near ones weigh more and are clear, the far ones are hazy; below, their shadow."""
        rows = [] if is_endless(self._paths.subjects[scene]) else [self._shadow(spots, many, camera, window)]
        screen, near = _Screen(camera.place(spots), many, window), camera.nearness(spots)
        crowd = screen.counted(near**3)
        haze = camera.haze(screen.counted(near**4) / np.maximum(crowd, 1e-9))
        texels = self._scale.take(self._level(crowd / DEEP), axis=0) * (1 - haze).astype(np.float32)
        return [*rows, cloud(screen.low, screen.high, screen.cells, self._write(texels))]

    def _shadow(self, spots: np.ndarray, many: int, camera: Orbit, window: np.ndarray) -> np.ndarray:
        """Let the cloud's shadow fall on the ground."""
        fallen = _Screen(camera.place(spots[:, :2]), many, window)
        dark = self._theme.shadow_alpha * (1 - np.exp(-0.5 * fallen.counted(None)))[..., None]
        shade = np.concatenate([dark * self._theme["shadow"], dark], axis=2, dtype=np.float32)
        return cloud(fallen.low, fallen.high, fallen.cells, self._write(shade))

    @staticmethod
    def _level(crowd: np.ndarray) -> np.ndarray:
        """Give the place on the scale of colours: [row, column] of int, from how crowded it is, in averages."""
        return np.minimum(np.log1p(crowd) * ((STEPS - 1) / np.log1p(BRIGHTEST)) + 0.5, STEPS - 1).astype(np.int32)

    def _write(self, texels: np.ndarray) -> int:
        """Hand over texels [row, column, 4]; return the number of the first."""
        first = sum(map(len, self._texels))
        self._texels.append(texels.reshape(-1, 4))
        return first


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

    def counted(self, weights: np.ndarray | None) -> np.ndarray:
        """Give how crowded cells are, in averages, with a rim: [row, column]. weights: [point], 1 when None."""
        return _counted(self._places, self._size, "constant", weights) * (np.prod(self._size) / self._many)


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
    with np.errstate(invalid="ignore"):
        at = np.floor(places * cells)
    inside = ((at >= 0) & (at < cells)).all(axis=1)
    number = np.where(inside, at[:, 1] * columns + at[:, 0], rows * columns).astype(np.int64)
    counts = np.bincount(number, weights, minlength=rows * columns + 1)[:-1].reshape(rows, columns)
    rim = len(BLUR) // 2 + 1
    padded = np.pad(counts.astype(np.float32), rim, mode=mode)  # type: ignore[call-overload]
    for _ in range(2):
        length = len(padded) - 2 * (rim - 1)
        padded = sum(share * padded[n : n + length] for n, share in enumerate(BLUR)).T
    return padded
