"""Events: deaths and arrivals: a flash when they happen, a quiet mark afterwards."""

import numpy as np

from render.raster.shapes import NONE, WINDOW, capsules, discs, rings
from render.scene.camera import Camera
from render.scene.signs import signs
from render.scene.snapshot import Snapshot
from render.scene.trajectories import ARRIVED, CAPTURED, CRASHED, Trajectories
from render.source import target_of
from render.theme import Theme

FLASH = 0.7
"""How long a death or an arrival shines [s of film]."""


MARKED = 0.9
"""Opacity of the marks where prey died: a little behind those that live."""


class Fates:
    """What became of the agents."""

    def __init__(self, paths: Trajectories, theme: Theme, unit: float, speed: float):
        """Prepare. unit: pixels per unit of type; speed: ticks per second of film."""
        self._paths, self._theme, self._unit, self._speed = paths, theme, unit, speed
        targets = [target_of(subject) for subject in paths.subjects]
        self._targets = np.array([(*target.position[:2], target.radius) if target else (0, 0, 0) for target in targets])
        self._depths = [target.position[2:] if target else () for target in targets]
        self._marked: tuple[Camera | None, int, np.ndarray] = (None, 0, NONE)  # marks change seldom under a still camera

    def marks(self, now: Snapshot, camera: Camera) -> np.ndarray:
        """Mark where prey died: a cross for a crash, a ring for a capture."""
        gone = int(np.count_nonzero(self._paths.end <= now.time))
        if self._marked[0] is not camera or self._marked[1] != gone:
            self._marked = camera, gone, self._marks(now, camera)
        return self._marked[2]

    def _marks(self, now: Snapshot, camera: Camera) -> np.ndarray:
        theme, unit = self._theme, self._unit
        rows = [NONE]
        for fate in (CAPTURED, CRASHED):
            agents, places, _ = self._gone(now, camera, fate, True)
            drawn = signs(fate, places, 4.3 * unit, theme, MARKED)
            rows.append(self._cut(drawn, np.resize(agents, len(drawn))))
        return np.concatenate(rows)

    def pulses(self, now: Snapshot, camera: Camera) -> np.ndarray:
        """Let the target's ring swell, once for each arrival."""
        agents, _, age = self._gone(now, camera, ARRIVED, True, 2 * FLASH)
        if not len(agents):
            return NONE
        phase = age / (2 * FLASH)
        targets = self._targets[self._paths.scene[agents]]
        own = camera.of(agents)
        depth = np.array([self._depths[scene] for scene in self._paths.scene[agents]]).reshape(len(agents), -1)
        spots = np.concatenate([targets[:, :2], depth], axis=1)
        centre, radius, hue = own.place(spots), targets[:, 2] * camera.scale * own.nearness(spots), self._theme["arrived"]
        swell = radius * (1 + 0.7 * (1 - (1 - phase) ** 2))
        ring = rings(centre, swell, 3.0 * self._unit * (1 - phase), hue, 0.8 * (1 - phase))
        glow = discs(centre, radius * 0.8, hue, 0.35 * (1 - phase) ** 2, soft=radius * 0.6)
        return np.concatenate([self._cut(ring, agents), self._cut(glow, agents)])

    def flashes(self, now: Snapshot, camera: Camera) -> np.ndarray:
        """Flash where agents die: two rings for a capture, a star of sparks for a crash; a soft glow where one arrives."""
        if not (now.time - self._paths.end < FLASH * self._speed)[self._paths.end <= now.time].any():
            return NONE
        theme, unit, rows = self._theme, self._unit, [NONE]
        for prey in (False, True):
            agents, place, age = self._gone(now, camera, CRASHED, prey, FLASH)
            if len(agents):
                rows += self._sparks(agents, place, age / FLASH, unit * (1.0 if prey else 0.6))
        for fate, hue in ((CAPTURED, theme["captured"]), (ARRIVED, theme["arrived"])):
            agents, place, age = self._gone(now, camera, fate, True, FLASH)
            if not len(agents):
                continue
            left = 1 - age / FLASH
            ease = 1 - left**3
            own = [discs(place, unit * (4 + 9 * ease), hue, 0.75 * left**2, soft=unit * 12)]
            if fate == CAPTURED:
                own.append(rings(place, unit * (6 + 26 * ease), unit * 3.2 * left, hue, left))
                own.append(rings(place, unit * (3 + 15 * ease), unit * 2.0 * left, theme["ink"], 0.8 * left))
            rows += [self._cut(each, agents) for each in own]
        return np.concatenate(rows)

    def _gone(
        self, now: Snapshot, camera: Camera, fate: int, prey: bool, within: float = np.inf
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Give the agents of a fate, where on the screen they went, and how long ago [s of film], if less than `within`."""
        paths = self._paths
        age = (now.time - paths.end) / self._speed
        agents = np.flatnonzero((age >= 0) & (age < within) & (paths.fate == fate) & (paths.is_prey == prey))
        return agents, camera.of(agents).place(now.spot[agents]), age[agents]

    def _cut(self, rows: np.ndarray, agents: np.ndarray) -> np.ndarray:
        """Cut shapes to the windows of their agents' scenes."""
        rows[:, WINDOW] = self._paths.scene[agents]
        return rows

    def _sparks(self, agents: np.ndarray, place: np.ndarray, phase: np.ndarray, size: float) -> list[np.ndarray]:
        """Throw eight sparks from each place."""
        hue = self._theme["crashed"]
        angle = np.arange(8) * (np.pi / 4) + np.pi / 8
        ray = np.tile(np.stack([np.cos(angle), np.sin(angle)], axis=1), (len(place), 1)) * size
        glow = discs(place, 7 * size, hue, 0.7 * (1 - phase) ** 2, soft=9 * size)
        centre, late = np.repeat(place, 8, axis=0), np.repeat(phase, 8)
        ease = (1 - (1 - late) ** 3)[:, None]
        half = np.maximum(1.3 * size * (1 - late), 0.2)
        tips = capsules(centre + ray * (4 + 10 * ease), centre + ray * (6 + 19 * ease), half, 0.4 * half, hue, 1 - late)
        return [self._cut(glow, agents), self._cut(tips, np.repeat(agents, 8))]
