"""Snapshot: the agents that can be seen at one time, on the screen."""

from dataclasses import dataclass

import numpy as np

from render.scene.camera import Camera, Orbit
from render.scene.trajectories import Trajectories


@dataclass(frozen=True)
class Snapshot:
    """Agents at one time.

    spot: [agent, dim], m, of all agents, those that are gone where they went.
    who: [shown], numbers of the agents to be seen, prey first, as far as `prey`; near an edge of a periodic world an agent is
    there twice. centre, heading: [shown, 2], px and unit vectors. shift: [shown, 2], how far from its agent's spot each is
    shown [m]. near: [shown], how much larger than at the middle things look.
    """

    time: float
    spot: np.ndarray
    who: np.ndarray
    prey: int
    centre: np.ndarray
    heading: np.ndarray
    near: np.ndarray
    shift: np.ndarray


def now(paths: Trajectories, time: float, camera: Camera, around: np.ndarray | None, lone: np.ndarray) -> Snapshot:
    """Look at a time [ticks] through a camera.

    around: [agent, 4], what of a periodic world is seen, as in `images`. lone: [agent], who is shown one by one.
    """
    spot = paths.spots(time)
    who = np.flatnonzero((time < paths.end) & lone)
    if around is None or isinstance(camera, Orbit):
        shift = np.zeros((len(who), 2))
        shown = spot[who]
    else:
        copies, shift = images(spot[who, :2], around[who], paths.period[who, :2] if paths.period is not None else 0)
        who = who[copies]
        shown = spot[who, :2] + shift
    own = camera.of(who)
    return Snapshot(
        time,
        spot,
        who,
        int(np.searchsorted(who, paths.prey)),
        own.place(shown),
        own.turn(shown, paths.speeds(time, who)),
        own.nearness(shown),
        shift,
    )


def images(spots: np.ndarray, around: np.ndarray, period: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Find where points of a periodic world are seen: numbers of points, ascending, and shifts [m].

    spots: [point, 2]; around: [point, 4], what is seen: x0, y0, x1, y1 [m], at most one more world on each side.
    period: [point, 2], 0 for worlds that are not periodic.
    """
    period = np.broadcast_to(period, spots.shape)
    # Along each axis: is the image one period lower seen, the point itself, the image one period higher?
    moved = spots.T[:, None] + np.array([[-1.0], [0.0], [1.0]]) * period.T[:, None]
    seen = (moved >= around.T[:2, None]) & (moved <= around.T[2:, None])
    seen[:, ::2] &= period.T[:, None] != 0  # worlds without edges have no images but the point itself
    points, x, y = (seen[0].T[:, :, None] & seen[1].T[:, None]).nonzero()
    return points, np.stack([x - 1.0, y - 1.0], axis=1) * period.take(points, axis=0)
