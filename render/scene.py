"""What to draw of a recording at a time: its world once, its agents, trails and fates for every frame."""

from dataclasses import dataclass

import numpy as np

from render.camera import Camera
from render.motion import KNOTS, motion
from render.shapes import NONE, boxes, capsules, colour, darts, discs, mixed, rings
from render.text import Atlas
from render.theme import Theme
from tiswarm.recording import Recording

SMALLEST = 2.5
"""No agent is drawn smaller than this radius [px], nor 5 px across."""

FLASH = 0.7
"""How long a death or an arrival shines [s of film]."""

GRID = 10.0
"""Distance of the floor's grid lines [m]."""


@dataclass(frozen=True)
class Look:
    """What a film shows, and at which pace.

    speed: ticks per second of film. trail: how long trails last [s of film].
    """

    speed: float = 10.0
    trail: float = 2.5


class Scene:
    """A recording seen by a camera."""

    def __init__(self, recording: Recording, theme: Theme, atlas: Atlas, unit: float, look: Look):
        """Prepare the paths. unit: pixels per unit of type, by which small things are sized."""
        self.recording = recording
        self.theme = theme
        self.unit = unit
        self.look = look
        self._atlas = atlas
        self.paths = motion(recording)
        self._knots = self.paths.knots()
        self._paints = self._palette()

    def _palette(self) -> np.ndarray:
        """Colour agents by the sub-swarm they belong to: [tick, agent, channel], linear light."""
        group, prey = np.maximum(self.paths.group, 0), self.paths.prey
        hues = [np.array([colour(each) for each in swatch]) for swatch in (self.theme.prey, self.theme.predator)]
        return np.concatenate([hues[0][group[:, :prey] % len(hues[0])], hues[1][group[:, prey:] % len(hues[1])]], axis=1)

    def ground(self, camera: Camera) -> np.ndarray:
        """Draw the world: everything that stands still."""
        theme, world = self.theme, self.recording.scenario.world
        low, high = self._box((0, 0), world.size[:2], camera)
        middle, reach = (low + high) / 2, np.hypot(*(high - low)) / 2
        unit = self.unit
        rows = [
            boxes(low, high, theme["shadow"], theme.shadow_alpha * 0.7, corner=6 * unit, soft=28 * unit),
            boxes(low, high, theme["world"], corner=3 * unit),
            discs(middle, reach * 0.25, theme["glow"], theme.glow_alpha, soft=reach * 1.5),
            self._grid(camera),
            *(self._area(area, camera) for area in world.areas),
            boxes(low, high, theme["line"], 0.85 if world.boundary == "walls" else 0.22, corner=3 * unit, stroke=0.75 * unit),
            self._target(camera),
            self._obstacles(camera),
        ]
        return np.concatenate(rows)

    def frame(self, time: float, camera: Camera) -> np.ndarray:
        """Draw what moves at a time [ticks]; past the last tick the last state stays and flashes go on."""
        paths = self.paths
        spots, speeds = (each[0] for each in paths.at(np.array([time])))
        here = _Here(time, paths.row(time), camera.place(spots), camera.turn(speeds), time < paths.end)
        gone = not here.seen.all()
        rows = [
            *(self._pulses(here, camera) if gone else ()),
            self._marks(here) if gone else NONE,
            self._trails(here, spots, camera),
            *self._predators(here, camera),
            *self._prey(here, camera),
            *(self._flashes(here) if gone else ()),
        ]
        return np.concatenate(rows)

    @staticmethod
    def _box(low, high, camera: Camera) -> tuple[np.ndarray, np.ndarray]:
        """Map a box of the world to its top left and bottom right corner on the screen."""
        a, b = camera.place(np.array([low, high], float))
        return np.minimum(a, b), np.maximum(a, b)

    def _grid(self, camera: Camera) -> np.ndarray:
        width, height = self.recording.scenario.world.size[:2]
        across, up = np.arange(GRID, width, GRID), np.arange(GRID, height, GRID)
        starts = np.concatenate([np.stack([across, 0 * across], 1), np.stack([0 * up, up], 1)])
        ends = np.concatenate([np.stack([across, 0 * across + height], 1), np.stack([0 * up + width, up], 1)])
        half = 0.5 * self.unit
        return capsules(camera.place(starts), camera.place(ends), half, half, self.theme["line"], 0.06)

    def _area(self, area, camera: Camera) -> np.ndarray:
        """Tint an area and name it once, in its upper left corner."""
        words = area.label.lower()
        hue = self.theme["danger" if "danger" in words else "safe" if "safe" in words else "line"]
        low, high = self._box(area.region.low, area.region.high, camera)
        size, inset = max(round(11 * self.unit), 8), 12 * self.unit
        label = self._atlas.line(
            area.label.upper(), (low[0] + inset, low[1] + inset + size * 0.75), size, hue, 0.75, spacing=max(round(size * 0.12), 1)
        )
        return np.concatenate([boxes(low, high, hue, self.theme.tint_alpha), label])

    def _target(self, camera: Camera) -> np.ndarray:
        target = self.recording.scenario.target
        centre, radius, hue = camera.place(np.array([target.position])), target.radius * camera.scale, self.theme["target"]
        return np.concatenate(
            [
                discs(centre, radius * 1.15, hue, 0.16, soft=radius * 1.1),
                discs(centre, radius, hue, 0.14),
                rings(centre, radius, 2.2 * self.unit, hue, 0.95),
                rings(centre, radius * 0.62, 1.2 * self.unit, hue, 0.45),
                discs(centre, max(radius * 0.16, 2 * self.unit), hue, 0.95),
            ]
        )

    def _obstacles(self, camera: Camera) -> np.ndarray:
        """Shade obstacles like pebbles lit from the upper left."""
        theme = self.theme
        centre = camera.place(self.recording.obstacle_position)
        radius = self.recording.obstacle_radius * camera.scale
        aside = radius[:, None] * (1.0, 1.0)
        return np.concatenate(
            [
                discs(centre + aside * 0.22, radius, theme["shadow"], theme.shadow_alpha, soft=np.maximum(radius * 0.8, 1)),
                discs(centre, radius, mixed(theme["obstacle"], theme["shadow"], 0.25)),
                discs(centre - aside * 0.05, radius * 0.9, theme["obstacle"], soft=np.maximum(radius * 0.18, 1)),
                discs(centre - aside * 0.3, radius * 0.3, theme["obstacle_light"], 0.75, soft=np.maximum(radius * 0.7, 1)),
            ]
        )

    def _reach(self, prey: bool, camera: Camera) -> float:
        """Give an agent's radius on the screen: true, but large enough to be seen among as many as there are."""
        scenario = self.recording.scenario
        radius = scenario.prey.radius if prey else scenario.predators.radius
        crowd = self.paths.prey if prey else self.paths.count - self.paths.prey
        return max(radius * camera.scale, 5.2 * self.unit * min(1.0, (60 / max(crowd, 1)) ** 0.5), SMALLEST)

    def _trails(self, here: "_Here", spots: np.ndarray, camera: Camera) -> np.ndarray:
        """Draw where agents were: lines that thin out and fade with age."""
        paths, ticks = self.paths, self.look.trail * self.look.speed
        now = min(here.time, float(paths.ticks))
        first, last = max(int(np.ceil((now - ticks) * KNOTS)), 0), int(np.ceil(now * KNOTS))
        if last <= first:
            return NONE
        line = np.concatenate([self._knots[first:last], spots[None]])
        times = np.append(np.arange(first, last) / KNOTS, now)
        # A line ends where its agent went, and breaks where the agent left one side of a periodic world for the other.
        shown = times[:-1, None] < paths.end
        if paths.period is not None:
            shown = shown & (np.abs(np.diff(line, axis=0)) < paths.period / 2).all(axis=2)
        agents, starts = shown.T.nonzero()
        pixels = camera.place(line)
        fresh = np.maximum(1 - (now - times) / ticks, 0)
        alpha, thin = self.theme.trail_alpha * fresh**1.4, 0.25 + 0.75 * fresh
        wide = np.where(paths.is_prey, *(0.42 * self._reach(prey, camera) for prey in (True, False)))[agents]
        return capsules(
            pixels[starts, agents],
            pixels[starts + 1, agents],
            wide * thin[starts],
            wide * thin[starts + 1],
            self._paints[here.row][agents],
            alpha[starts],
            alpha[starts + 1],
            group=agents + 1,
        )

    def _prey(self, here: "_Here", camera: Camera) -> list[np.ndarray]:
        """Draw prey as drops, round in front: brighter with a thin ring when alarmed."""
        seen = np.flatnonzero(here.seen[: self.paths.prey])
        if not len(seen):
            return []
        centre, heading, paints = here.centre[seen], here.heading[seen], self._paints[here.row][seen]
        alarmed = self.paths.state[here.row][seen] != "calm"
        reach = self._reach(True, camera)
        nose, tail, edge = centre + heading * 0.35 * reach, centre - heading * 1.9 * reach, max(0.28 * reach, 1.0)
        rows = [
            capsules(nose, tail, reach + edge, 0.25 * reach + edge, self.theme["outline"], 0.7),
            capsules(nose, tail, reach, 0.22 * reach, paints),
        ]
        if alarmed.any():
            rows.append(rings(centre[alarmed], reach * 2.3, 1.1 * self.unit, paints[alarmed], 0.4))
            rows.append(discs(nose[alarmed], reach * 0.55, self.theme["alarm"], 0.9))
        return rows

    def _predators(self, here: "_Here", camera: Camera) -> list[np.ndarray]:
        """Draw predators as swept darts."""
        prey = self.paths.prey
        seen = prey + np.flatnonzero(here.seen[prey:])
        if not len(seen):
            return []
        centre, heading = here.centre[seen], here.heading[seen]
        reach = self._reach(False, camera)
        length, width, edge = 1.75 * reach, 1.25 * reach, max(0.3 * reach, 1.0)
        return [
            darts(centre, heading, length + 2 * edge, width + 1.3 * edge, 0.55 * length, self.theme["outline"], 0.7),
            darts(centre, heading, length, width, 0.8 * length, self._paints[here.row][seen]),
        ]

    def _gone(self, here: "_Here", fate: str, prey: bool, within: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
        """Give where agents of a fate went before now, and how long ago [s of film], if less than `within`."""
        paths = self.paths
        age = (here.time - paths.end) / self.look.speed
        chosen = (age >= 0) & (age < within) & (paths.fate == fate) & (paths.is_prey == prey)
        return here.centre[chosen], age[chosen]

    def _marks(self, here: "_Here") -> np.ndarray:
        """Keep a quiet mark where prey died: a cross for a crash, a ring for a capture."""
        theme, unit = self.theme, self.unit
        caught, _ = self._gone(here, "captured", True)
        crashed, _ = self._gone(here, "crashed", True)
        rows = [rings(caught, 3.4 * unit, 1.6 * unit, theme["captured"], 0.6)]
        if len(crashed):
            arm, half = 3.6 * unit, 0.8 * unit
            rows += [capsules(crashed - (arm, s * arm), crashed + (arm, s * arm), half, half, theme["crashed"], 0.6) for s in (1, -1)]
        return np.concatenate(rows)

    def _pulses(self, here: "_Here", camera: Camera) -> list[np.ndarray]:
        """Let the target's ring swell, once for each arrival."""
        _, age = self._gone(here, "arrived", True, 2 * FLASH)
        if not len(age):
            return []
        phase = age / (2 * FLASH)
        target = self.recording.scenario.target
        centre = np.repeat(camera.place(np.array([target.position])), len(phase), axis=0)
        radius = target.radius * camera.scale
        swell = radius * (1 + 0.7 * (1 - (1 - phase) ** 2))
        return [
            rings(centre, swell, 3.0 * self.unit * (1 - phase), self.theme["arrived"], 0.8 * (1 - phase)),
            discs(centre, radius * 0.8, self.theme["arrived"], 0.35 * (1 - phase) ** 2, soft=radius * 0.6),
        ]

    def _flashes(self, here: "_Here") -> list[np.ndarray]:
        """Flash where agents die: two rings for a capture, a star of sparks for a crash; a soft glow where one arrives."""
        theme, unit, rows = self.theme, self.unit, []
        for prey in (False, True):
            place, age = self._gone(here, "crashed", prey, FLASH)
            if len(age):
                rows += self._sparks(place, age / FLASH, 1.0 if prey else 0.6)
        for fate in ("captured", "arrived"):
            place, age = self._gone(here, fate, True, FLASH)
            if not len(age):
                continue
            phase = age / FLASH
            ease = 1 - (1 - phase) ** 3
            rows.append(discs(place, unit * (4 + 9 * ease), theme[fate], 0.75 * (1 - phase) ** 2, soft=unit * 12))
            if fate == "captured":
                rows.append(rings(place, unit * (6 + 26 * ease), unit * 3.2 * (1 - phase), theme[fate], 1 - phase))
                rows.append(rings(place, unit * (3 + 15 * ease), unit * 2.0 * (1 - phase), theme["ink"], 0.8 * (1 - phase)))
        return rows

    def _sparks(self, place: np.ndarray, phase: np.ndarray, size: float) -> list[np.ndarray]:
        """Throw eight sparks from each place."""
        angle = np.arange(8) * (np.pi / 4) + np.pi / 8
        ray = np.tile(np.stack([np.cos(angle), np.sin(angle)], axis=1), (len(place), 1)) * (size * self.unit)
        glow = discs(place, 7 * self.unit * size, self.theme["crashed"], 0.7 * (1 - phase) ** 2, soft=9 * self.unit * size)
        centre, phase = np.repeat(place, 8, axis=0), np.repeat(phase, 8)
        ease = (1 - (1 - phase) ** 3)[:, None]
        half = np.maximum(1.3 * self.unit * size * (1 - phase), 0.2)
        start, end = centre + ray * (4 + 10 * ease), centre + ray * (6 + 19 * ease)
        return [glow, capsules(start, end, half, 0.4 * half, self.theme["crashed"], 1 - phase)]


@dataclass(frozen=True)
class _Here:
    """The agents at one time, on the screen: row of the recording, centre and heading [agent, 2], who is still seen [agent]."""

    time: float
    row: int
    centre: np.ndarray
    heading: np.ndarray
    seen: np.ndarray
