"""Cameras: maps from metres to pixels."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Camera:
    """A flat map from metres, y upwards, to pixels, y downwards.

    centre: the point [dim], m, shown at `middle` [px]; scale: px/m. A joint camera has a centre and a middle for each agent,
    [agent, dim] and [agent, 2], and maps points of all agents, [..., agent, dim].
    """

    centre: np.ndarray
    middle: np.ndarray
    scale: float

    def of(self, agents: np.ndarray) -> "Camera":
        """Give the camera that maps points of some agents, in their order."""
        if self.middle.ndim == 1:
            return self
        return replace(self, centre=self.centre[agents], middle=self.middle[agents])

    def place(self, points: np.ndarray) -> np.ndarray:
        """Map points [..., dim] in metres to pixels [..., 2]."""
        return self.middle + (points[..., :2] - self.centre) * (self.scale, -self.scale)

    def turn(self, points: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """Map directions [..., dim] at points to unit vectors on the screen [..., 2]."""
        del points
        return _unit(directions[..., :2] * (1.0, -1.0))

    def nearness(self, points: np.ndarray) -> np.ndarray:
        """Give how much larger than at the centre things look: [...], 1 in a flat world."""
        return np.ones(points.shape[:-1])


@dataclass(frozen=True)
class Orbit(Camera):
    """A perspective view of a 3-D world. eye axes: right, up and forward, unit vectors [3, 3]; away: distance [m]."""

    axes: np.ndarray
    away: float

    def place(self, points: np.ndarray) -> np.ndarray:
        """Map points [..., 3], or points on the ground [..., 2], to pixels [..., 2]."""
        seen = self._seen(points)
        return self.middle + seen[..., :2] * (self.scale, -self.scale) * self._grown(seen)[..., None]

    def turn(self, points: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """Map directions to unit vectors on the screen, as perspective shows them."""
        step = 1e-3 * directions / np.maximum(np.linalg.norm(directions, axis=-1, keepdims=True), 1e-12)
        return _unit((self.place(points + step) - self.place(points)) * 1e3)

    def nearness(self, points: np.ndarray) -> np.ndarray:
        """Give how much larger than at the centre things look: [...]."""
        return self._grown(self._seen(points))

    @staticmethod
    def haze(near: np.ndarray) -> np.ndarray:
        """Give how much of what is behind shows through things, the farther the more: [..., 1]."""
        return np.clip(0.22 + 1.5 * (1 - near), 0, 0.75)[..., None]

    def _seen(self, points: np.ndarray) -> np.ndarray:
        if points.shape[-1] == 2:
            points = np.concatenate([points, np.zeros((*points.shape[:-1], 1))], axis=-1)
        return (points - self.centre) @ self.axes.T

    def _grown(self, seen: np.ndarray) -> np.ndarray:
        return self.away / np.maximum(self.away + seen[..., 2], 0.05 * self.away)


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Scale vectors [..., 2] to length one; no direction at all points right."""
    length = np.hypot(vectors[..., 0], vectors[..., 1])[..., None]
    return np.where(length > 1e-12, vectors / np.maximum(length, 1e-12), (1.0, 0.0))


def joint(cameras: Sequence[Camera], scene: np.ndarray) -> Camera:
    """Give one camera for the agents of several scenes that are shown alike, each in its own place. scene: [agent]."""
    if len(cameras) == 1:
        return cameras[0]
    centres, middles = (np.array([getattr(camera, name) for camera in cameras]) for name in ("centre", "middle"))
    return replace(cameras[0], centre=centres[scene], middle=middles[scene])
