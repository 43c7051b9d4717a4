"""Cleaned ground: where agents have been, in cells that the world is divided into."""

import numpy as np

from render.raster.shapes import NONE, WINDOW, boxes
from render.scene.camera import Camera
from render.scene.snapshot import Snapshot
from render.scene.trajectories import Trajectories
from render.source import Live
from render.theme import Theme
from tiswarm.measures.ground import Sweep
from tiswarm.records.recording import Recording
from tiswarm.scenario.model import World
from tiswarm.space import box

FINE = 320
"""Cells along the world's longer side."""

FRESH = 8
"""Cleaned ground shines for about this many ticks."""


class Cells:
    """A world divided into squares, numbered row by row."""

    def __init__(self, size: tuple[float, ...], edge: float):
        """Divide a world of some size into squares of some edge [m]."""
        width, height = size[:2]
        self.edge = edge
        self.across, self.up = int(np.ceil(width / self.edge)), int(np.ceil(height / self.edge))

    @property
    def count(self) -> int:
        """Count the cells."""
        return self.across * self.up

    @property
    def middles(self) -> np.ndarray:
        """Give the cells' middles: [cell, 2], m."""
        numbers = np.arange(self.count)
        return (np.stack([numbers % self.across, numbers // self.across], axis=1) + 0.5) * self.edge

    def of(self, spots: np.ndarray) -> np.ndarray:
        """Give the number of each point's cell [...], -1 outside the world. spots: [..., dim], m."""
        place = np.nan_to_num(spots[..., :2] / self.edge, nan=-1.0)
        x, y = place[..., 0].astype(np.int32), place[..., 1].astype(np.int32)
        inside = (place >= 0).all(axis=-1) & (x < self.across) & (y < self.up)
        return np.where(inside, y * self.across + x, -1)

    def around(self, spots: np.ndarray, reach: float) -> np.ndarray:
        """Give the numbers of the cells whose middles lie within reach [m] of points [point, 2]; -1 for cells outside."""
        ways = np.arange(-np.ceil(reach / self.edge), np.ceil(reach / self.edge) + 1)
        offsets = np.stack(np.meshgrid(ways, ways), axis=-1).reshape(-1, 2)
        middles = (np.floor(spots / self.edge)[:, None] + offsets + 0.5) * self.edge
        return self.of(middles[np.hypot(*np.moveaxis(middles - spots[:, None], -1, 0)) <= reach])

    def drawn(self, cells: np.ndarray, runs: np.ndarray | int, camera: Camera, paint, alpha) -> np.ndarray:
        """Draw rows of `runs` cells that begin with some. Edges lie on whole pixels, so that none shows between neighbours."""
        corner = np.stack([cells % self.across, cells // self.across], axis=1) * self.edge
        far = corner + np.stack([np.broadcast_to(runs, len(cells)), np.ones(len(cells))], axis=1) * self.edge
        a, b = np.round(camera.place(corner)), np.round(camera.place(far))
        return boxes(np.minimum(a, b), np.maximum(a, b), paint, alpha)


class Coverage:
    """Ground that prey have been to, brightest where they have just been."""

    def __init__(self, paths: Trajectories, theme: Theme):
        """Watch the paths from their start on."""
        self._paths, self._theme = paths, theme
        sizes = [subject.scenario.world.size for subject in paths.subjects]
        self._cells = [Cells(size, max(size[:2]) / FINE) for size in sizes]
        # What is counted in words is what the measure "coverage" counts, on the scenario's own grid where there is one.
        self._grids = [_grid(subject) for subject in paths.subjects]
        self._reach = [max(tool_radius(s.scenario), 0.71 * c.edge) for s, c in zip(paths.subjects, self._cells, strict=True)]
        self._before = np.zeros(0)
        paths.watch(self._clean)

    def _clean(self, tick: int, places: np.ndarray) -> None:
        """Note what prey clean on the way to a tick."""
        if tick == 0:
            self._first = [np.full(cells.count + 1, np.inf) for cells in self._cells]
            self._swept = [np.full(grid.free.size, np.inf) for grid in self._grids]
            self._before = places
        paths, prey = self._paths, np.flatnonzero(self._paths.is_prey & np.isfinite(places[:, 0]))
        for scene, (cells, first) in enumerate(zip(self._cells, self._first, strict=True)):
            mine = prey[paths.scene[prey] == scene]
            world = paths.subjects[scene].scenario.world
            step = paths.shortest(places[mine] - self._before[mine], mine)
            count = max(int(np.ceil(np.abs(step).max(initial=0) / cells.edge)), 1)
            for share in np.arange(1, count + 1) / count:
                spots = paths.within(places[mine] - step * (1 - share), mine)[:, :2]
                cleaned = cells.around(_reaching_in(spots, world, self._reach[scene]), self._reach[scene])
                first[cleaned] = np.minimum(first[cleaned], tick - 1 + share if tick else 0)
            first[-1] = np.inf
            if box.rounded(world.boundary):
                first[:-1][~box.inside(cells.middles, world.size[:2], world.boundary)] = np.inf
            under = self._grids[scene].under(places[mine, :2])
            self._swept[scene][under] = np.minimum(self._swept[scene][under], tick)
        self._before = places.copy()

    def share(self, time: float) -> float:
        """Give the share of the ground that is clean."""
        done = sum(int((swept <= time).sum()) for swept in self._swept)
        return done / max(sum(int(grid.free.sum()) for grid in self._grids), 1)

    def drawn(self, here: Snapshot, camera: Camera) -> np.ndarray:
        """Draw the cleaned cells; those that shine no more in whole rows."""
        rows = [NONE]
        for scene, (cells, first) in enumerate(zip(self._cells, self._first, strict=True)):
            own = camera.of(np.flatnonzero(self._paths.scene == scene)[0]) if self._paths.count else camera
            age = here.time - first[:-1]
            fresh = np.flatnonzero((age >= 0) & (age < 4 * FRESH))
            shine = 0.3 * np.exp(-age[fresh] / FRESH)
            old = (age >= 4 * FRESH).reshape(cells.up, cells.across)
            edges = np.diff(np.pad(old, ((0, 0), (1, 1))).astype(np.int8), axis=1)
            (row, start), (_, end) = (edges == 1).nonzero(), (edges == -1).nonzero()
            hue = self._theme["arrived"]
            alpha = self._theme.cleaned_alpha
            drawn = cells.drawn(row * cells.across + start, end - start, own, hue, alpha)
            for tiles in (drawn, cells.drawn(fresh, 1, own, hue, alpha + shine)):
                tiles[:, WINDOW] = scene
                rows.append(tiles)
        return np.concatenate(rows)


def _grid(subject: Recording | Live) -> Sweep:
    """Give the grid on which a subject's ground is counted."""
    world = subject.scenario.world
    cell = subject.scenario.coverage.cell or max(world.size[:2]) / FINE
    return Sweep(cell, tool_radius(subject.scenario), world, subject.obstacle_position[:, :2], subject.obstacle_radius)


def _reaching_in(spots: np.ndarray, world: World, reach: float) -> np.ndarray:
    """Add to points [point, 2] their images beyond the edges of a periodic world, as far as they reach into it."""
    spots = box.images(spots, box.period(world.size[:2], world.boundary))
    return spots[((spots >= -reach) & (spots <= np.array(world.size[:2]) + reach)).all(axis=1)]


def tool_radius(scenario) -> float:
    """Give how far prey clean [m]: as far as their tools reach where ground is counted, else as far as they themselves do."""
    return float(scenario.coverage.tool if scenario.coverage.cell else scenario.prey.radius)
