"""Curves: cubic Hermite curves from tick to tick, of many agents.

They are reckoned in place: memory asked for anew takes longer than what is written there.
"""

import numpy as np


def lay(
    begin: np.ndarray, end: np.ndarray, leaving: np.ndarray, coming: np.ndarray, bend: np.ndarray, twist: np.ndarray
) -> None:
    """Write the coefficients of the second power, bend, and of the third, twist, from places and velocities at both ends."""
    chord = end - begin
    np.multiply(chord, 3, out=bend)  # 3 chord - 2 leaving - coming
    np.multiply(leaving, 2, out=twist)
    bend -= twist
    bend -= coming
    np.add(leaving, coming, out=twist)  # leaving + coming - 2 chord
    chord *= 2
    twist -= chord


def along(share: float, begin: np.ndarray, leaving: np.ndarray, bend: np.ndarray, twist: np.ndarray) -> np.ndarray:
    """Give places at a share of the way."""
    spots = share * twist
    for each in (bend, leaving):
        spots += each
        spots *= share
    spots += begin
    return spots
