"""Trails: where agents were, as lines that thin out and fade with age."""

from dataclasses import dataclass

import numpy as np

from render.raster.shapes import NONE, capsules
from render.scene.camera import Camera, Orbit
from render.scene.snapshot import Snapshot, images
from render.scene.trajectories import Trajectories
from tiswarm.space import box

HUNTERS = 0.65
"""Trails of predators are this much weaker than those of prey, whose story it is."""

THICK = 0.42
"""Width of a new trail as a share of its agent's."""


@dataclass(frozen=True)
class _Pieces:
    """Pieces of trails on the screen.

    agents, starts: [piece], whose each is, and the number of the knot where it begins. a, b: both ends, [piece, 2], px.
    """

    agents: np.ndarray
    starts: np.ndarray
    a: np.ndarray
    b: np.ndarray

    def chosen(self, rows: np.ndarray) -> "_Pieces":
        """Give some of the pieces, in their order."""
        return _Pieces(*(each.take(rows, axis=0) for each in (self.agents, self.starts, self.a, self.b)))

    def joined(self, other: "_Pieces") -> "_Pieces":
        """Give these pieces and others, agent by agent."""
        pairs = ((self.agents, other.agents), (self.starts, other.starts), (self.a, other.a), (self.b, other.b))
        both = _Pieces(*(np.concatenate(pair) for pair in pairs))
        return both.chosen(both.agents.argsort(kind="stable"))


class Trails:
    """The trails of all agents.

    Knots are fixed in time. Under a camera that stands still the pieces between them are too: each is placed on the screen
    once, and only the newest, from the last knot to where the agent is, frame by frame.
    """

    def __init__(self, paths: Trajectories, reach: float, alpha: float):
        """Prepare. reach: how far back trails go [ticks]; alpha: opacity of a new one."""
        self._paths, self._reach, self._alpha = paths, reach, alpha
        self._strength = np.where(paths.is_prey, 1.0, HUNTERS)
        self._camera: Camera | None = None
        self._first = self._last = 0  # the kept pieces begin at the knots from the first to before the last
        self._kept: _Pieces

    def drawn(
        self, here: Snapshot, camera: Camera, around: np.ndarray | None, reach: np.ndarray, paints: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Draw the trails; give with each shape its agent.

        around: what of periodic worlds is seen, as in `now`. reach: [agent], size of agents on the screen [px], as it would be
        at the camera's pivot; paints: [agent, channel].
        """
        paths, pace = self._paths, self._paths.per_tick
        moment = min(here.time, float(paths.last))
        first, last = max(int(np.ceil((moment - self._reach) * pace)), 0), int(np.ceil(moment * pace))
        if last <= first:
            return NONE, np.zeros(0, int)
        newest = np.concatenate([paths.knots(last - 1, last), here.spot[None]])
        pieces = self._old(first, last - 1, camera, around).joined(self._placed(newest, last - 1, camera, around))
        times = np.append(np.arange(first, last) / pace, moment)
        fresh = np.maximum(1 - (moment - times) / self._reach, 0)
        alpha, thin = self._alpha * fresh**1.4, 0.25 + 0.75 * fresh
        agents, starts = pieces.agents, pieces.starts - first
        near = camera.nearness(here.spot) if isinstance(camera, Orbit) else 1.0
        strong, wide = self._strength.take(agents), (THICK * reach * near).take(agents)
        rows = capsules(
            pieces.a,
            pieces.b,
            wide * thin.take(starts),
            wide * thin.take(starts + 1),
            paints.take(agents, axis=0),
            alpha.take(starts) * strong,
            alpha.take(starts + 1) * strong,
            group=agents + 1,
        )
        return rows, agents

    def _old(self, first: int, last: int, camera: Camera, around: np.ndarray | None) -> _Pieces:
        """Give the pieces that begin at knots from the first to before the last, and end at a knot too."""
        if camera is not self._camera or not self._first <= first <= self._last <= last:
            self._kept = self._placed(self._paths.knots(first, last + 1), first, camera, around)
        elif (first, last) != (self._first, self._last):
            fresh = self._placed(self._paths.knots(self._last, last + 1), self._last, camera, around)
            self._kept = self._kept.chosen(np.flatnonzero(self._kept.starts >= first)).joined(fresh)
        self._camera, self._first, self._last = camera, first, last
        return self._kept

    def _placed(self, line: np.ndarray, first: int, camera: Camera, around: np.ndarray | None) -> _Pieces:
        """Place pieces on the screen, agent by agent. line: [point, agent, dim], m; its first point is knot number `first`."""
        ends = self._paths.end
        there = (np.arange(first, first + len(line) - 1) / self._paths.per_tick)[:, None] < ends
        if self._paths.latecomers:
            there &= np.isfinite(line[:-1, :, 0]) & np.isfinite(line[1:, :, 0])
        agents, starts = there.T.nonzero()
        if around is None:
            a, b = self._segments(line, agents, starts, camera)
        else:
            a, b, agents, starts = self._images(line, agents, starts, camera, around)
        return _Pieces(agents, starts + first, a, b)

    def _segments(
        self, line: np.ndarray, agents: np.ndarray, starts: np.ndarray, camera: Camera
    ) -> tuple[np.ndarray, np.ndarray]:
        """Give both ends of pieces on the screen. starts: rows of the line."""
        paths = self._paths
        pixels = camera.place(line).reshape(-1, 2)
        start = starts * paths.count + agents
        a, b = pixels.take(start, axis=0), pixels.take(start + paths.count, axis=0)
        if paths.period is not None:  # seen from an orbit, nothing is drawn across the edge
            far = np.abs(line[starts + 1, agents] - line[starts, agents]) > paths.period[agents] / 2
            b = np.where((far & (paths.period[agents] > 0)).any(axis=1)[:, None], a, b)
        return a, b

    def _images(
        self, line: np.ndarray, agents: np.ndarray, starts: np.ndarray, camera: Camera, around: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Give the same in periodic worlds, where a piece across the edge is seen on both sides of it."""
        paths = self._paths
        assert paths.period is not None
        points, start = line[..., :2].reshape(-1, 2), starts * paths.count + agents
        period = paths.period[:, :2].take(agents, axis=0)
        a = points.take(start, axis=0)
        step = box.displacement(points.take(start + paths.count, axis=0) - a, period)
        half = np.abs(step) / 2
        seen = around.take(agents, axis=0)
        seen[:, :2] -= half
        seen[:, 2:] += half
        copies, shift = images(a + step / 2, seen, period)
        agents, starts = agents.take(copies), starts.take(copies)
        own, a, step = camera.of(agents), a.take(copies, axis=0) + shift, step.take(copies, axis=0)
        return own.place(a), own.place(a + step), agents, starts
