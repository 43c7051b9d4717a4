"""View: a frame of a trial that runs in an environment, as our films draw it, for render_mode = "rgb_array"."""

from collections import deque

import numpy as np

from tiswarm.environments.environment import Environment
from tiswarm.records.recording import Swarm

SIZE = (640, 360)

TRAIL = 40
"""So many ticks are remembered, for trails."""


class View:
    """Remembers the last moments of the first trial, where frames are asked for at all."""

    def __init__(self, environment: Environment, mode: str | None) -> None:
        """Remember nothing yet. Errors: ValueError for a mode that is unknown."""
        if mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode: {mode!r} is unknown; use 'rgb_array' or None")
        self._environment, self._on = environment, mode is not None
        self._moments: deque[tuple[Swarm, Swarm]] = deque(maxlen=TRAIL)

    def begin(self) -> None:
        """Forget the trial before, and look at the start of another."""
        self._moments.clear()
        self.look()

    def look(self) -> None:
        """Remember the trial as it is now."""
        if self._on:
            self._moments.append(self._environment.moments(0))

    def frame(self) -> np.ndarray | None:
        """Draw the trial as it is now: [y, x, channel] of uint8; None where frames are not asked for."""
        if not self._on:
            return None
        import render

        if not self._moments:
            raise ValueError("render: no trial runs yet; call reset first")
        return render.still(self._environment.recorded(self._moments), SIZE, time=len(self._moments) - 1)
