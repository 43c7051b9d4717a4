"""What moves: the agents of all subjects, their trails and states, drawn for one frame at a time in one pass."""

from collections.abc import Sequence

import numpy as np

from render.raster.glyphs import Atlas
from render.raster.shapes import WINDOW, capsules, colour, darts, discs, rings
from render.scene import background
from render.scene.camera import Camera, Orbit
from render.scene.events import Fates
from render.scene.overlays import Overlays
from render.scene.snapshot import Snapshot, now
from render.scene.trails import Trails
from render.scene.trajectories import ACTING, ALARMED, EXPLODING, Trajectories
from render.source import Kind, Live, is_endless
from render.style import Look
from tiswarm.records.recording import Recording

SMALLEST = 2.5
"""No agent is drawn smaller than this radius [px], nor 5 px across."""

READABLE, CROWD = 5.2, 60
"""Agents are at least this large [units of type] while there are at most CROWD of them, and shrink as they become more."""

ABOVE = 1.5
"""Agents above a cloud of others are this much larger than READABLE."""

LABEL, LEAST = 15, 9
"""Size of agents' numbers [units of type], and the smallest that can be read [px]."""

CROWDED = 20_000
"""From this many prey, or predators, on, a cloud shows where they are."""


Layer = tuple[np.ndarray, np.ndarray]
"""Shapes, and for each the row of `Now` that it belongs to."""


class Scene:
    """Recordings or live simulations, ready to be drawn."""

    def __init__(self, subjects: Sequence[Recording | Live], look: Look, unit: float, atlas: Atlas, knots: int = 2):
        """Prepare the paths.

        unit: pixels per unit of type, by which small things are sized. atlas: what clouds are written to. knots: points of a
        trail per tick; 2 make round curves.

        Errors: as `Trajectories`, and ValueError for the label of an agent that does not exist.
        """
        self.subjects, self.look, self.unit, self.theme = subjects, look, unit, look.colours
        behind = look.trail * look.speed
        self.paths = Trajectories(subjects, behind, knots)
        self._trails = Trails(self.paths, behind, self.theme.trail_alpha)
        kinds, scene = self.paths.kind, self.paths.scene
        crowds = [np.bincount(scene[kinds == kind], minlength=len(subjects)).max() for kind in Kind]
        self._lone = np.array(crowds)[kinds] < CROWDED
        self._fates = Fates(self.paths, self.theme, unit, look.speed)
        swept = any(subject.scenario.coverage.cell for subject in subjects)
        overlay = {*look.overlay, *(() if self._lone.all() else ("density",)), *(("coverage",) if swept else ())}
        self._overlays = Overlays(self.paths, self.theme, unit, overlay, self._lone, atlas, look.wording)
        self.coverage, self.density = self._overlays.coverage, self._overlays.density
        self._seen: tuple[Camera | None, np.ndarray | None] = (None, None)
        self._atlas = atlas
        self._followed = np.array([] if look.followed is None else self._numbered(look.followed), int)
        most = int(np.bincount(self.paths.scene).max())
        if max(look.label, default=0) >= most:
            raise ValueError(f"label: no agent {max(look.label)}; use 0 to {most - 1}, prey first")
        self._named = {agent: str(number) for number in look.label for agent in self._numbered(number)}
        self._size_up()

    def _numbered(self, number: int) -> list[int]:
        """Find who has a number in each subject, where prey come first."""
        each = [np.flatnonzero(self.paths.scene == n) for n in range(len(self.subjects))]
        return [int(agents[number]) for agents in each if number < len(agents)]

    def _size_up(self) -> None:
        """Find out what about each agent never changes: [agent]."""
        paths = self.paths
        crowds = [np.bincount(paths.scene[paths.kind == kind], minlength=len(self.subjects)) for kind in Kind]
        radii = [[getattr(subject.scenario, kind.name.lower()).radius for subject in self.subjects] for kind in Kind]
        readable = READABLE * self.unit * (1.0 if self._lone.all() else ABOVE)
        least = [np.maximum(readable * np.minimum(1, (CROWD / np.maximum(c, 1)) ** 0.5), SMALLEST) for c in crowds]
        kinds, scene = paths.kind, paths.scene
        self._radius, self._least = np.array(radii)[kinds, scene], np.array(least)[kinds, scene]
        self._swatch = np.array([colour(each) for each in self.theme.prey])
        self._grounded = not any(is_endless(subject) for subject in self.subjects)

    def frame(self, time: float, camera: Camera, windows: np.ndarray) -> np.ndarray:
        """Draw what moves at a time [ticks]; past the last tick the last state stays and flashes go on.

        windows: [subject, 4], where on the screen each is shown [px].
        """
        around = self._around(camera, windows)
        here = now(self.paths, time, camera, around, self._lone)
        gone = bool((self.paths.end <= time).any())
        rows = [self._shadows(here, camera)] if isinstance(camera, Orbit) and self._grounded else []
        rows.append(self._overlays.below(here, camera, windows))
        if gone:
            rows += [self._fates.pulses(here, camera), self._fates.marks(here, camera)]
        reach = np.maximum(self._radius * camera.scale, self._least)
        if self.paths.trailed:
            everybody = self._paints(time, np.arange(self.paths.count))
            rows.append(self._cut(*self._trails.drawn(here, camera, around, reach, everybody)))
        reach, paints = reach[here.who], self._paints(time, here.who)
        if isinstance(camera, Orbit):
            reach = np.maximum(reach * here.near, SMALLEST)
            haze = camera.haze(here.near) * (1.0 if self._lone.all() else 0.4)  # clear before a cloud
            paints = paints * (1 - haze) + np.array(self.theme["backdrop"]) * haze
        drawn = [*self._predators(here, reach, paints), *self._prey(here, reach, paints)]
        rows += self._by_depth(drawn, here, camera) if isinstance(camera, Orbit) else [each for each, _ in drawn]
        rows.append(self._chosen(here, reach))
        if gone:
            rows.append(self._fates.flashes(here, camera))
        return np.concatenate(rows)

    def _chosen(self, here: Snapshot, reach: np.ndarray) -> np.ndarray:
        """Ring the agent that the camera follows, and write the numbers of those that have labels beside them."""
        ringed = np.flatnonzero(np.isin(here.who, self._followed))
        ink, thick, size = self.theme["ink"], max(1.4 * self.unit, 1.0), max(round(LABEL * self.unit), LEAST)
        rows = [self._cut(rings(here.centre[ringed], 3.2 * reach[ringed], thick, ink, 0.9), here.who[ringed])]
        for row in np.flatnonzero(np.isin(here.who, list(self._named))):
            x, y = here.centre[row] + np.array((1.8, -1.2)) * reach[row]
            words = self._atlas.line(self._named[int(here.who[row])], (x, y), size, ink)
            rows.append(self._cut(words, np.repeat(here.who[row], len(words))))
        return np.concatenate(rows)

    def _around(self, camera: Camera, windows: np.ndarray) -> np.ndarray | None:
        """Give what of periodic worlds each agent's window shows, and a rim for what is larger than a point: [agent, 4], m."""
        if self.paths.period is None or isinstance(camera, Orbit):
            return None
        if self._seen[0] is not camera:
            edges = windows[self.paths.scene].astype(float)
            middle = np.broadcast_to(camera.middle, (self.paths.count, 2))
            low = camera.centre + (edges[:, [0, 3]] - middle) * (1, -1) / camera.scale
            high = camera.centre + (edges[:, [2, 1]] - middle) * (1, -1) / camera.scale
            rim = 3 * np.maximum(self._radius, self._least / camera.scale)[:, None]
            self._seen = camera, np.concatenate([low - rim, high + rim], axis=1)
        return self._seen[1]

    def _paints(self, time: float, agents: np.ndarray) -> np.ndarray:
        """Colour some agents by the sub-swarm they belong to: [agent, channel], linear light."""
        group = np.maximum(self.paths.groups(time)[agents], 0)
        paints = self._swatch[group % len(self._swatch)]
        paints[agents >= self.paths.prey] = colour(self.theme.predator)
        return paints

    def _cut(self, rows: np.ndarray, agents: np.ndarray) -> np.ndarray:
        """Cut shapes to the windows of their agents' scenes."""
        if len(self.subjects) > 1:
            rows[:, WINDOW] = self.paths.scene[agents]
        return rows

    def _by_depth(self, drawn: list[Layer], here: Snapshot, camera: Orbit) -> list[np.ndarray]:
        """Order shapes of agents, and the spheres among them, from far to near."""
        shapes, near = [each for each, _ in drawn], [here.near[rows] for _, rows in drawn]
        for scene, subject in enumerate(self.subjects):
            agents = np.flatnonzero(self.paths.scene == scene)
            balls, depth = background.spheres(subject, self.theme, camera.of(agents[0]) if len(agents) else camera)
            balls[:, WINDOW] = scene
            shapes.append(balls)
            near.append(depth)
        order = np.argsort(np.concatenate(near), kind="stable")
        return [np.concatenate(shapes)[order]]

    def _prey(self, here: Snapshot, reach: np.ndarray, paints: np.ndarray) -> list[Layer]:
        """Draw prey as drops, round in front; their state shows on them."""
        rows = np.arange(here.prey)
        if not len(rows):
            return []
        reach, paints = reach[rows], paints[rows]
        centre, heading, long = here.centre[rows], here.heading[rows], reach[:, None]
        nose, tail, edge = centre + heading * 0.35 * long, centre - heading * 1.9 * long, np.maximum(0.28 * reach, 1.0)
        alpha, edges, dye = self._twice(paints, edge)
        slim = np.concatenate([0.25 * reach, 0.22 * reach])
        drops = capsules(_doubled(nose), _doubled(tail), _doubled(reach) + edges, slim + edges, dye, alpha)
        states = self.paths.states(here.time)[here.who[rows]]
        layers = [(drops, _doubled(rows)), *self._states(states, rows, nose, reach, paints)]
        return [self._layer(shapes, each, here) for shapes, each in layers]

    def _layer(self, shapes: np.ndarray, rows: np.ndarray, here: Snapshot) -> Layer:
        """Cut shapes to their windows; rows: the rows of `here` that they belong to."""
        return self._cut(shapes, here.who[rows]), rows

    def _twice(self, paints: np.ndarray, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Give opacity, width of the edge and colour of agents' outlines, followed by those of the agents themselves."""
        alpha = np.ones(2 * len(edge))
        alpha[: len(edge)] = 0.7
        outline = np.empty_like(paints)
        outline[:] = self.theme["outline"]
        return alpha, np.concatenate([edge, np.zeros_like(edge)]), np.concatenate([outline, paints])

    def _states(
        self, states: np.ndarray, rows: np.ndarray, nose: np.ndarray, reach: np.ndarray, paints: np.ndarray
    ) -> list[Layer]:
        """Mark who is not calm: a bright head; for any state but alarmed a ring too, wide and glowing when exploding."""
        layers = []
        stirred, acting = states >= ALARMED, states >= ACTING
        if stirred.any():
            layers.append((discs(nose[stirred], reach[stirred] * 0.42, self.theme["alarm"], 0.9), rows[stirred]))
        if acting.any():
            wild = np.where(states[acting] == EXPLODING, 1.0, 0.0)
            size = reach[acting] * (2.1 + 0.6 * wild)
            layers.append((discs(nose[acting], size, paints[acting], 0.3 * wild, soft=size), rows[acting]))
            layers.append((rings(nose[acting], size, 1.3 * self.unit, paints[acting], 0.9), rows[acting]))
        return layers

    def _predators(self, here: Snapshot, reach: np.ndarray, paints: np.ndarray) -> list[Layer]:
        """Draw predators as swept darts, with a dot in the colour of the cluster that each chases."""
        rows = np.arange(here.prey, len(here.who))
        if not len(rows):
            return []
        reach, paints = reach[rows], paints[rows]
        centre, heading = here.centre[rows], here.heading[rows]
        length, width, edge = 1.75 * reach, 1.25 * reach, np.maximum(0.3 * reach, 1.0)
        alpha, edges, dye = self._twice(paints, edge)
        notch = np.concatenate([0.55 * length, 0.8 * length])
        twice, ahead = _doubled(centre), _doubled(heading)
        shapes = darts(twice, ahead, _doubled(length) + 2 * edges, _doubled(width) + 1.3 * edges, notch, dye, alpha)
        layers = [(shapes, _doubled(rows))]
        group = self.paths.groups(here.time)[here.who[rows]]
        chasing = group >= 0
        if chasing.any():
            spots, size = (centre + heading * 0.1 * reach[:, None])[chasing], 0.5 * reach[chasing]
            hues = self._swatch[group[chasing] % len(self._swatch)]
            layers.append((discs(spots, 1.3 * size, self.theme["outline"], 0.9), rows[chasing]))
            layers.append((discs(spots, size, hues), rows[chasing]))
        return [self._layer(each, own, here) for each, own in layers]

    def _shadows(self, here: Snapshot, camera: Camera) -> np.ndarray:
        """Drop the agents' shadows on the ground of a 3-D world."""
        spots, own = here.spot[here.who, :2], camera.of(here.who)
        size = np.maximum(
            np.maximum(self._radius[here.who] * camera.scale, self._least[here.who]) * own.nearness(spots), SMALLEST
        )
        return self._cut(
            discs(own.place(spots), size, self.theme["shadow"], 0.5 * self.theme.shadow_alpha, soft=size), here.who
        )


def _doubled(rows: np.ndarray) -> np.ndarray:
    """Give an array followed by itself."""
    return np.concatenate([rows, rows])
