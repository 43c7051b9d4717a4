"""Planning: the numbers of planned ways."""

from collections.abc import Sequence
from math import ceil
from typing import Literal

from tiswarm.scenario.parts import NotNegative, Part, Positive


class Planning(Part):
    """Ways to the target around obstacles, where `prey.goal_by` is "path"."""

    # Whether each prey knows the way from wherever it is, or keeps to the list of points that it made at its start.
    plan: Literal["field", "list"] = "field"
    cell: Positive = 1.0  # side of a cell of the grid that ways are found on [m]
    clearance: NotNegative = 1.0  # cells nearer to an obstacle's edge are blocked [m]

    def cells(self, size: Sequence[float]) -> tuple[int, int]:
        """Count the cells along both sides of a flat world."""
        return ceil(size[0] / self.cell), ceil(size[1] / self.cell)
