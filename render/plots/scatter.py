"""Scatter: a study's cells as a cloud of points. Needs matplotlib."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from render.plots.figure import GRID, OURS, sheet

MOST_LABELS = 30
"""Points of a scatter that are named; more would cover each other."""


@dataclass(frozen=True)
class Cloud:
    """Points with 95 % intervals in both directions, all [point]; away is half an interval's width, 0 for none.

    names: none for points that nobody asks the names of.
    """

    names: Sequence[str]
    x: np.ndarray
    y: np.ndarray
    x_away: np.ndarray
    y_away: np.ndarray
    logarithmic: bool = False  # x


def scatter(cloud: Cloud, path: str | os.PathLike, title: str, note: str, x_axis: str, y_axis: str) -> Path:
    """Draw points with crosses for their intervals, named where there are few. It appears whole or not at all."""
    named = 0 < len(cloud.names) <= MOST_LABELS
    size = (6.4 + (0.075 * max(map(len, cloud.names)) if named else 0.0), max(4.6, 1.6 + 0.2 * named * len(cloud.names)))
    with sheet(1, 1, size, path, title, note) as (_, axes):
        axis = axes[0][0]
        marks: Any = {"fmt": "o", "color": OURS, "ecolor": OURS, "elinewidth": 1.0, "mec": "white", "mew": 0.8, "zorder": 3}
        axis.errorbar(cloud.x, cloud.y, cloud.y_away, cloud.x_away, markersize=7 if named else 5, **marks)
        if cloud.logarithmic:
            axis.set_xscale("log")
        axis.set_xlabel(x_axis)
        axis.set_ylabel(y_axis)
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(True, color=GRID, linewidth=0.7)
        axis.set_axisbelow(True)
        axis.margins(0.06)
        if named:
            _name_points(axis, cloud, gap=0.2 / (size[1] - 1.5))
    return Path(path)


def _name_points(axis: Any, cloud: Cloud, gap: float) -> None:
    """Write names in a column right of the plot, as near to their points' heights as `gap` lets them, with lines to them."""
    from scipy.optimize import isotonic_regression

    order = np.lexsort((-cloud.x, cloud.y))
    low, high = axis.get_ylim()
    heights = (cloud.y[order] - low) / (high - low)
    steps = gap * np.arange(len(order))
    places = np.clip(isotonic_regression(heights - steps).x, 0.0, max(1.0 - steps[-1], 0.0)) + steps
    line: Any = {"arrowstyle": "-", "color": "#BBBBBB", "linewidth": 0.7, "shrinkA": 2, "shrinkB": 0, "relpos": (0, 0.5)}
    for k, place in zip(order, places, strict=True):
        at = {"xycoords": "data", "textcoords": "axes fraction", "va": "center", "fontsize": 8, "zorder": 1}
        axis.annotate(cloud.names[k], (cloud.x[k], cloud.y[k]), xytext=(1.05, place), arrowprops=line, **at)
