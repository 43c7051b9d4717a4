"""Terms: what each part of a move added to an agent's velocity, from the velocities that it had on the way."""

from collections.abc import Mapping, Sequence

import numpy as np

EDGE = "edge"
"""What happens behind all terms: walls, bounces, and the drive of a unicycle."""


def differences(velocity: np.ndarray, courses: Sequence[Mapping[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Give what each term added to the velocity in the move out of each tick: name -> [tick, agent, dim], m/s.

    velocity: [tick, agent, dim], m/s; courses: for each move, name -> [agent, dim], the velocity behind each term, in their
    order. The terms of a move add up to its change of velocity; NaN where an agent made none, or was gone behind it. Terms that
    never did anything are left out.
    """
    if not courses:
        return {}
    moved = np.isfinite(velocity[1:])
    none = np.full((1, *velocity.shape[1:]), np.nan)
    total, terms = np.zeros_like(velocity[1:]), {}
    for name in (*courses[0], EDGE):
        behind = velocity[1:] if name == EDGE else np.stack([each[name] for each in courses])
        # Measured from what the terms before it add up to, so that rounding does not: some push by 10 km/s.
        added = np.where(moved, behind - velocity[:-1] - total, np.nan)
        if np.nan_to_num(added).any():
            terms[name] = np.concatenate([added, none])
            total = total + added
    return terms
