"""Deaths and arrivals: a flash when they happen, a quiet mark afterwards."""

import numpy as np

from render.camera import Camera
from render.motion import Motion
from render.now import Now
from render.shapes import NONE, capsules, discs, rings
from render.theme import Theme
from tiswarm.recording import Recording

FLASH = 0.7
"""How long a death or an arrival shines [s of film]."""


class Fates:
    """What became of the agents of one recording."""

    def __init__(self, recording: Recording, paths: Motion, theme: Theme, unit: float, speed: float):
        """Take note of who went when. unit: pixels per unit of type; speed: ticks per second of film."""
        self._target = recording.scenario.target
        self._theme, self._unit, self._speed = theme, unit, speed
        self._fated = {
            (fate, prey): np.flatnonzero((paths.fate == fate) & (paths.is_prey == prey) & np.isfinite(paths.end))
            for fate in ("arrived", "captured", "crashed")
            for prey in (True, False)
        }
        self._ends = paths.end
        self._marked: tuple[Camera | None, int, np.ndarray] = (None, 0, NONE)  # marks change seldom under a still camera

    def over(self, ticks: int) -> float:
        """Give when the last flash of a recording of so many ticks has faded [ticks]."""
        return ticks + 2 * FLASH * self._speed

    def marks(self, now: Now, camera: Camera) -> np.ndarray:
        """Mark where prey died: a cross for a crash, a ring for a capture."""
        left = int(np.count_nonzero(now.seen))
        if self._marked[0] is not camera or self._marked[1] != left:
            self._marked = camera, left, self._marks(now)
        return self._marked[2]

    def _marks(self, now: Now) -> np.ndarray:
        theme, unit, rows = self._theme, self._unit, [NONE]
        caught, _ = self._gone(now, "captured", True)
        crashed, _ = self._gone(now, "crashed", True)
        if len(caught):
            rows.append(rings(caught, 3.4 * unit, 1.6 * unit, theme["captured"], 0.6))
        if len(crashed):
            arms, half = 3.6 * unit * np.array([[1, 1], [1, -1]]), 0.8 * unit
            rows += [capsules(crashed - arm, crashed + arm, half, half, theme["crashed"], 0.6) for arm in arms]
        return np.concatenate(rows)

    def pulses(self, now: Now, camera: Camera) -> np.ndarray:
        """Let the target's ring swell, once for each arrival."""
        _, age = self._gone(now, "arrived", True, 2 * FLASH)
        if not len(age):
            return NONE
        phase = age / (2 * FLASH)
        centre = np.repeat(camera.place(np.array([self._target.position])), len(phase), axis=0)
        radius, hue = self._target.radius * camera.scale, self._theme["arrived"]
        swell = radius * (1 + 0.7 * (1 - (1 - phase) ** 2))
        ring = rings(centre, swell, 3.0 * self._unit * (1 - phase), hue, 0.8 * (1 - phase))
        return np.concatenate([ring, discs(centre, radius * 0.8, hue, 0.35 * (1 - phase) ** 2, soft=radius * 0.6)])

    def flashes(self, now: Now) -> np.ndarray:
        """Flash where agents die: two rings for a capture, a star of sparks for a crash; a soft glow where one arrives."""
        theme, unit, rows = self._theme, self._unit, [NONE]
        for prey in (False, True):
            place, age = self._gone(now, "crashed", prey, FLASH)
            if len(age):
                rows += self._sparks(place, age / FLASH, unit * (1.0 if prey else 0.6))
        for fate in ("captured", "arrived"):
            place, age = self._gone(now, fate, True, FLASH)
            if not len(age):
                continue
            left = 1 - age / FLASH
            ease = 1 - left**3
            rows.append(discs(place, unit * (4 + 9 * ease), theme[fate], 0.75 * left**2, soft=unit * 12))
            if fate == "captured":
                rows.append(rings(place, unit * (6 + 26 * ease), unit * 3.2 * left, theme[fate], left))
                rows.append(rings(place, unit * (3 + 15 * ease), unit * 2.0 * left, theme["ink"], 0.8 * left))
        return np.concatenate(rows)

    def _gone(self, now: Now, fate: str, prey: bool, within: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
        """Give where agents of a fate went, and how long ago [s of film], if less than `within`."""
        fated = self._fated[fate, prey]
        age = (now.time - self._ends[fated]) / self._speed
        chosen = (age >= 0) & (age < within)
        return now.centre[fated[chosen]], age[chosen]

    def _sparks(self, place: np.ndarray, phase: np.ndarray, size: float) -> list[np.ndarray]:
        """Throw eight sparks from each place."""
        hue = self._theme["crashed"]
        angle = np.arange(8) * (np.pi / 4) + np.pi / 8
        ray = np.tile(np.stack([np.cos(angle), np.sin(angle)], axis=1), (len(place), 1)) * size
        glow = discs(place, 7 * size, hue, 0.7 * (1 - phase) ** 2, soft=9 * size)
        centre, phase = np.repeat(place, 8, axis=0), np.repeat(phase, 8)
        ease = (1 - (1 - phase) ** 3)[:, None]
        half = np.maximum(1.3 * size * (1 - phase), 0.2)
        return [
            glow,
            capsules(centre + ray * (4 + 10 * ease), centre + ray * (6 + 19 * ease), half, 0.4 * half, hue, 1 - phase),
        ]
