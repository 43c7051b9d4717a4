"""Barrier: the numbers of the certificates that keep bodies apart."""

from typing import Literal

from tiswarm.scenario.parts import NotNegative, Part, Positive

MOST_JOINT = 32
"""Most prey whose commands are corrected together: a kernel has a place for each pair."""


class Barrier(Part):
    """What commands may not do to distances, where `prey.safety` is "barrier"."""

    # Whether the commands of all are changed together, as little as can be, or everybody keeps to half of each pair's bound.
    form: Literal["joint", "shared"] = "joint"
    radius: Positive = 0.15  # m, the least distance of two; half of it from walls
    gain: Positive = 100.0  # how fast a distance may shrink, for the cube of how far it is from the least [1/(m⁴ s)]
    wall_share: NotNegative = 0.4  # how much of the gain holds at walls [m²]
