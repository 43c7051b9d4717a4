"""Overlays: what agents see, where they go, whom they flock with, where it is crowded or was cleaned."""

import numpy as np

from render.language import Language
from render.raster.glyphs import Atlas
from render.raster.shapes import NONE, WINDOW, capsules, colour, mixed, rings
from render.scene.camera import Camera
from render.scene.coverage import Coverage
from render.scene.density import Density
from render.scene.pursuit import chased, quarries
from render.scene.snapshot import Snapshot
from render.scene.springs import Springs, sprung
from render.scene.trajectories import Trajectories
from render.theme import Theme
from tiswarm.space.sight import in_view, nearest_of

ARC = 48
"""Straight pieces of the edge of a field of view."""

LINKED = 2000
"""With more agents than this, links between neighbours would cover everything, and are left out."""


class Overlays:
    """The overlays that a look asks for."""

    def __init__(
        self, paths: Trajectories, theme: Theme, unit: float, names: set[str], lone: np.ndarray, atlas: Atlas, words: Language
    ):
        """Prepare. unit: pixels per unit of type. lone, atlas, words: as for `Density`."""
        self._paths, self._theme, self._unit, self._names = paths, theme, unit, names
        self.coverage = Coverage(paths, theme) if "coverage" in names else None
        self.density = Density(paths, theme, lone, atlas, words) if "density" in names else None
        scenarios = [subject.scenario for subject in paths.subjects]
        linked = {n for n, scenario in enumerate(scenarios) if sprung(scenario)} if "links" in names else set()
        self._springs = {scene: Springs(paths, scene, theme) for scene in linked}
        sights = np.array([(scenario.prey.perception, scenario.predators.perception) for scenario in scenarios])
        self._chased = [chased(scenario) for scenario in scenarios] if "pursuit" in names else []
        self._sight = sights[paths.scene, paths.kind]
        flat = np.array([scenario.world.dim == 2 for scenario in scenarios])
        views = np.array([(scenario.prey.field_of_view, scenario.predators.field_of_view) for scenario in scenarios])
        self._view = np.where(flat[:, None], views, 360.0)[paths.scene, paths.kind]

    def below(self, here: Snapshot, camera: Camera, windows: np.ndarray) -> np.ndarray:
        """Draw what lies under the agents. windows: as in `Scene.frame`."""
        rows = [NONE]
        if self.coverage:
            rows.append(self.coverage.drawn(here, camera))
        if self.density:
            rows.append(self.density.drawn(here, camera, windows))
        if "perception" in self._names:
            rows.append(self._perception(here, camera))
        for scene, kind in enumerate(self._chased):
            rows.append(self._pursuit(here, camera, scene, kind))
        if "links" in self._names:
            rows.append(self._links(here, camera))
        if "velocity" in self._names:
            rows.append(self._velocity(here, camera))
        return np.concatenate(rows)

    def _cut(self, rows: np.ndarray, agents: np.ndarray) -> np.ndarray:
        rows[:, WINDOW] = self._paths.scene[agents]
        return rows

    def _perception(self, here: Snapshot, camera: Camera) -> np.ndarray:
        """Circle what agents perceive; of who sees nobody behind it, in a flat world, a sector."""
        hues = np.array([colour(self._theme.prey[0]), colour(self._theme.predator)])[self._paths.kind[here.who]]
        reach, round_about = self._sight[here.who] * camera.scale * here.near, self._view[here.who] >= 360
        circles = rings(here.centre[round_about], reach[round_about], 1.1 * self._unit, hues[round_about], 0.28)
        rows = [self._cut(circles, here.who[round_about])]
        for k in np.flatnonzero(~round_about):
            across = np.radians(self._view[here.who[k]]) * np.linspace(-0.5, 0.5, ARC + 1)
            angle = np.arctan2(here.heading[k, 1], here.heading[k, 0]) + across
            edge = here.centre[k] + reach[k] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
            outline = np.concatenate([here.centre[k : k + 1], edge, here.centre[k : k + 1]])
            thick = 0.55 * self._unit
            pieces = capsules(outline[:-1], outline[1:], thick, thick, hues[k], 0.28, group=k + 1)
            rows.append(self._cut(pieces, np.repeat(here.who[k], len(pieces))))
        return np.concatenate(rows)

    def _velocity(self, here: Snapshot, camera: Camera) -> np.ndarray:
        """Draw where each agent will be in three ticks if it goes straight on."""
        shown = here.spot[here.who]
        shown[:, :2] += here.shift
        ahead = camera.of(here.who).place(shown + 3 * self._paths.speeds(here.time, here.who))
        thick = 1.0 * self._unit
        return self._cut(capsules(here.centre, ahead, thick, thick * 0.5, self._theme["ink"], 0.75, 0.35), here.who)

    def _pursuit(self, here: Snapshot, camera: Camera, scene: int, kind: str) -> np.ndarray:
        """Draw a line from each predator to whom it chases, the fainter the nearer to that."""
        agents, ways = quarries(self._paths, scene, kind, here.time, here.spot)
        own = camera.of(agents)
        start, end = own.place(here.spot[agents]), own.place(here.spot[agents] + ways)
        hue, thick = colour(self._theme.predator), 0.8 * self._unit
        lines = capsules(start, end, thick, 0.6 * thick, hue, 0.6, 0.25)
        return self._cut(np.concatenate([lines, rings(end, 5 * self._unit, 1.2 * self._unit, hue, 0.5)]), np.tile(agents, 2))

    def _links(self, here: Snapshot, camera: Camera) -> np.ndarray:
        """Join prey that heed each other as neighbours: in view, within perception, among the nearest, of one sub-swarm.

        Or those that a spring links, in the colour of its tension.
        """
        paths, rows = self._paths, [NONE]
        group = paths.groups(here.time)
        hue, thick = mixed(colour(self._theme.prey[0]), self._theme["ink"], 0.3), 0.7 * self._unit
        prey = np.unique(here.who[: here.prey])
        for scene in range(len(paths.subjects)):
            flock = prey[paths.scene[prey] == scene]
            if not 1 < len(flock) <= LINKED:
                continue
            spots = here.spot[flock]
            steps = paths.shortest(spots[None] - spots[:, None], flock)
            apart, sight = np.linalg.norm(steps, axis=2), self._sight[flock[0]]
            prey_rules = paths.subjects[scene].scenario.prey
            counts = (apart < sight) & (group[flock][:, None] == group[flock][None]) & ~np.eye(len(flock), dtype=bool)
            counts &= in_view(steps, paths.speeds(here.time, flock), prey_rules.field_of_view)
            springs = self._springs.get(scene)
            chosen = springs.linked(flock) if springs else nearest_of(apart, counts, prey_rules.nearest)
            a, b = chosen.nonzero()
            hues, alpha = (springs.hues(apart[a, b]), 0.8) if springs else (hue, 0.08 + 0.5 * (1 - apart[a, b] / sight))
            own, step = camera.of(flock[a]), steps[a, b]
            # Across an edge of a periodic world each of the two draws its own half of the way, and no more.
            start = own.place(spots[a])
            middle = own.place(spots[a] + step / 2)
            links = capsules(start, middle, thick, thick, hues, alpha)
            rows.append(self._cut(links, flock[a]))
        return np.concatenate(rows)
