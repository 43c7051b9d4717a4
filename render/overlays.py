"""Overlays: what agents see, where they go, whom they flock with, where it is crowded or was cleaned."""

import numpy as np

from render.camera import Camera
from render.motion import Motion
from render.now import Now
from render.shapes import NONE, boxes, capsules, colour, mixed, rings
from render.theme import Theme
from tiswarm.recording import Recording

CELLS = 96
"""Cells of a heat map or a coverage map along the world's longer side."""

LINKED = 2000
"""With more agents than this, links between neighbours would cover everything, and are left out."""


class Overlays:
    """The overlays of one recording that a look asks for."""

    def __init__(self, recording: Recording, paths: Motion, theme: Theme, unit: float, names: tuple[str, ...]):
        """Prepare what needs the whole recording. unit: pixels per unit of type."""
        self._recording, self._paths, self._theme, self._unit, self._names = recording, paths, theme, unit, names
        width, height = recording.scenario.world.size[:2]
        self._cell = max(width, height) / CELLS
        self._shape = int(np.ceil(width / self._cell)), int(np.ceil(height / self._cell))
        self._cleaned = self._first_visits() if "coverage" in names else None

    def below(self, here: Now, camera: Camera) -> np.ndarray:
        """Draw what lies under the agents."""
        rows = [NONE]
        if self._cleaned is not None:
            rows.append(self._coverage(here, camera))
        if "density" in self._names:
            rows.append(self._density(here, camera))
        if "perception" in self._names:
            rows.append(self._perception(here, camera))
        if "links" in self._names:
            rows.append(self._links(here))
        if "velocity" in self._names:
            rows.append(self._velocity(here, camera))
        return np.concatenate(rows)

    def _perception(self, here: Now, camera: Camera) -> np.ndarray:
        """Circle what agents perceive: predators always, prey when they perceive less than a third of the world."""
        scenario, rows = self._recording.scenario, [NONE]
        for agents, prey, paint in (
            (scenario.prey, True, self._theme.prey[0]),
            (scenario.predators, False, self._theme.predator[0]),
        ):
            chosen = here.seen & (self._paths.is_prey == prey)
            if chosen.any():
                rows.append(rings(here.centre[chosen], agents.perception * camera.scale, 1.1 * self._unit, colour(paint), 0.28))
        return np.concatenate(rows)

    def _velocity(self, here: Now, camera: Camera) -> np.ndarray:
        """Draw where each agent will be in three ticks if it goes straight on."""
        seen = here.seen
        ahead = camera.place(here.spot[seen] + 3 * here.speed[seen])
        thick = 1.0 * self._unit
        return capsules(here.centre[seen], ahead, thick, thick * 0.5, self._theme["ink"], 0.75, 0.35)

    def _links(self, here: Now) -> np.ndarray:
        """Join prey that are neighbours: within perception of each other, and of the same sub-swarm."""
        prey = np.flatnonzero(here.seen & self._paths.is_prey)
        if not 1 < len(prey) <= LINKED:
            return NONE
        spots, group = here.spot[prey], self._paths.group[here.row][prey]
        apart = np.linalg.norm(spots[:, None] - spots[None], axis=2)
        mates = (apart < self._recording.scenario.prey.perception) & (group[:, None] == group[None])
        a, b = np.triu(mates, 1).nonzero()
        closeness = 1 - apart[a, b] / self._recording.scenario.prey.perception
        thick = 0.7 * self._unit
        hue = mixed(colour(self._theme.prey[0]), self._theme["ink"], 0.3)
        return capsules(here.centre[prey[a]], here.centre[prey[b]], thick, thick, hue, 0.08 + 0.5 * closeness)

    def _cells(self, spots: np.ndarray) -> np.ndarray:
        """Give the number of each point's cell, row by row, or -1 outside the world."""
        cell = np.floor(np.nan_to_num(spots[..., :2], nan=-1.0) / self._cell).astype(int)
        inside = ((cell >= 0) & (cell < self._shape)).all(axis=-1)
        return np.where(inside, cell[..., 1] * self._shape[0] + cell[..., 0], -1)

    def _tiles(self, cells: np.ndarray, camera: Camera, paint, alpha) -> np.ndarray:
        """Draw cells of the world by number."""
        corner = np.stack([cells % self._shape[0], cells // self._shape[0]], axis=1) * self._cell
        a, b = camera.place(corner), camera.place(corner + self._cell)
        return boxes(np.minimum(a, b), np.maximum(a, b), paint, alpha)

    def _density(self, here: Now, camera: Camera) -> np.ndarray:
        """Colour cells by how many agents are there, on a scale that ends at the most crowded one."""
        counts = np.bincount(self._cells(here.spot[here.seen]) + 1, minlength=self._shape[0] * self._shape[1] + 1)[1:]
        cells = counts.nonzero()[0]
        if not len(cells):
            return NONE
        level = np.log1p(counts[cells]) / np.log1p(counts.max())
        stops = np.array([colour(each) for each in self._theme.heat])
        paints = np.stack([np.interp(level, (0, 0.5, 1), stops[:, n]) for n in range(3)], axis=1)
        return self._tiles(cells, camera, paints, 0.35 + 0.6 * level)

    def _first_visits(self) -> np.ndarray:
        """Find when prey first came to each cell: [cell], ticks, inf for never."""
        cells = self._cells(self._paths.position[:, : self._paths.prey])
        first = np.full(self._shape[0] * self._shape[1], np.inf)
        for tick in range(len(cells) - 1, -1, -1):
            first[cells[tick][cells[tick] >= 0]] = tick
        return first

    def _coverage(self, here: Now, camera: Camera) -> np.ndarray:
        """Tint the cells that prey have been to, brightest where they have just been."""
        assert self._cleaned is not None
        cells = (self._cleaned <= here.time).nonzero()[0]
        fresh = np.exp(-(here.time - self._cleaned[cells]) / 8)
        return self._tiles(cells, camera, self._theme["arrived"], 0.10 + 0.3 * fresh)
