"""Now: the agents of a recording at one time, on the screen."""

from dataclasses import dataclass

import numpy as np

from render.camera import Camera
from render.motion import Motion


@dataclass(frozen=True)
class Now:
    """Agents at one time.

    row: the recorded row that holds their states. spot: [agent, dim], m. speed: [agent, dim], m/tick.
    centre, heading: [agent, 2], px and unit vectors. near: [agent], how much larger than at the middle things look.
    seen: [agent], who is still there.
    """

    time: float
    row: int
    spot: np.ndarray
    speed: np.ndarray
    centre: np.ndarray
    heading: np.ndarray
    near: np.ndarray
    seen: np.ndarray


def now(paths: Motion, time: float, camera: Camera) -> Now:
    """Look at a time [ticks] through a camera."""
    spot, speed = (each[0] for each in paths.at(np.array([time])))
    return Now(
        time,
        min(max(int(time), 0), paths.ticks),
        spot,
        speed,
        camera.place(spot),
        camera.turn(spot, speed),
        camera.nearness(spot),
        time < paths.end,
    )
