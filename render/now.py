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
    turns = np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)], float)
    shifts = turns[None] * np.broadcast_to(period, spots.shape)[:, None]
    moved = spots[:, None] + shifts
    seen = ((moved >= around[:, None, :2]) & (moved <= around[:, None, 2:])).all(axis=2)
    seen &= (shifts != 0).any(axis=2) | (turns == 0).all(axis=1)  # worlds without edges have no images but the point itself
    points, turn = seen.nonzero()
    return points, shifts[points, turn]
