"""Now: the agents that can be seen at one time, on the screen."""

from dataclasses import dataclass

import numpy as np

from render.camera import Camera, Orbit
from render.motion import Motion


@dataclass(frozen=True)
class Now:
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


def now(paths: Motion, time: float, camera: Camera, around: np.ndarray | None) -> Now:
    """Look at a time [ticks] through a camera. around: [agent, 4], what of a periodic world is seen, as in `images`."""
    spot = paths.spots(time)
    who = np.flatnonzero(time < paths.end)
    if around is None or isinstance(camera, Orbit):
        shift = np.zeros((len(who), 2))
        shown = spot[who]
    else:
        copies, shift = images(spot[who, :2], around[who], paths.period[who, :2] if paths.period is not None else 0)
        who = who[copies]
        shown = spot[who, :2] + shift
    own = camera.of(who)
    return Now(
        time,
        spot,
        who,
        int(np.searchsorted(who, paths.prey)),
        own.place(shown),
        own.turn(shown, paths.speeds(time)[who]),
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
    seen = np.empty((2, 3, len(spots)), bool)
    for axis in (0, 1):
        place, low, high, size = spots[:, axis], around[:, axis], around[:, axis + 2], period[:, axis]
        for n, turn in enumerate((-1, 0, 1)):
            moved = place + turn * size
            np.logical_and(moved >= low, moved <= high, out=seen[axis, n])
            if turn:  # worlds without edges have no images but the point itself
                seen[axis, n] &= size != 0
    found = [(x, y, np.flatnonzero(seen[0, x] & seen[1, y])) for x in range(3) for y in range(3)]
    points = np.concatenate([own for _, _, own in found])
    turns = np.concatenate([np.full((len(own), 2), (x - 1.0, y - 1.0)) for x, y, own in found])
    order = points.argsort(kind="stable")
    points = points[order]
    return points, turns[order] * period[points]
