"""Charts: heat maps, paired differences and scatters of a study, for papers and pages. Needs matplotlib."""

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from render.plots.figure import FAINT, GRID, INK, OURS, PUBLISHED, sheet

MOST_LABELS = 30
"""Points of a scatter that are named; more would cover each other."""


@dataclass(frozen=True)
class Heat:
    """One panel of a heat map: [row, column], NaN where there is no cell.

    away: half the width of the 95 % interval; framed, dotted: which cells stand out.
    """

    title: str
    rows: Sequence[str]
    columns: Sequence[str]
    mean: np.ndarray
    away: np.ndarray
    framed: np.ndarray | None = None
    dotted: np.ndarray | None = None


def heat(
    panels: Sequence[Heat], path: str | os.PathLike, title: str, note: str, measure: str, row_axis: str, column_axis: str
) -> Path:
    """Draw panels side by side, in rows of up to four, on one scale of colours; it appears whole or not at all."""
    across = min(len(panels), 4)
    down = math.ceil(len(panels) / across)
    rows, columns = len(panels[0].rows), len(panels[0].columns)
    cell = (0.66, 0.5) if columns <= 12 else (0.5, 0.42)
    names = 0.085 * max(map(len, panels[0].rows))
    size = (max(across * cell[0] * columns + names + 1.6, 4.6), down * (cell[1] * rows + 0.9) + 0.9)
    low = min(np.nanmin(panel.mean) for panel in panels)
    high = max(np.nanmax(panel.mean) for panel in panels)
    with sheet(down, across, size, path, title, note) as (figure, axes):
        image: Any = None
        for place, axis in enumerate(axes.flat):
            if place >= len(panels):
                axis.set_axis_off()
                continue
            image = _heat_panel(axis, panels[place], (low, high))
            if place % across == 0:
                axis.set_yticks(np.arange(rows), panels[place].rows)
                axis.set_ylabel(row_axis)
            else:
                axis.set_yticks([])
            if place + across >= len(panels):
                axis.set_xlabel(column_axis)
        bar = figure.colorbar(image, ax=list(axes.flat), shrink=min(1.0, 3.2 / size[1]), aspect=24, pad=0.015, label=measure)
        bar.outline.set_visible(False)
    return Path(path)


def _heat_panel(axis: Any, panel: Heat, limits: tuple[float, float]) -> Any:
    import matplotlib as mpl
    from matplotlib.patches import Rectangle

    scale = mpl.colormaps["cividis"]
    low, high = limits
    image = axis.imshow(panel.mean, cmap=scale, vmin=low, vmax=high if high > low else low + 1, aspect="auto")
    digits = min(max(1 - math.floor(math.log10(high - low)), 0), 4) if high > low else 2
    long = any(len(name) > 5 for name in panel.columns)
    turned: Any = {"rotation": 35, "ha": "right", "rotation_mode": "anchor"} if long else {}
    axis.set_xticks(np.arange(len(panel.columns)), panel.columns, **turned)
    axis.tick_params(length=0)
    axis.spines[:].set_visible(False)
    axis.set_xticks(np.arange(len(panel.columns) + 1) - 0.5, minor=True)
    axis.set_yticks(np.arange(len(panel.rows) + 1) - 0.5, minor=True)
    axis.grid(which="minor", color="white", linewidth=1.5)
    axis.tick_params(which="minor", length=0)
    axis.set_title(panel.title, fontsize=10)
    for (row, column), mean in np.ndenumerate(panel.mean):
        if not np.isfinite(mean):
            continue
        shade = scale((mean - low) / (high - low) if high > low else 0.0)
        ink = "black" if 0.299 * shade[0] + 0.587 * shade[1] + 0.114 * shade[2] > 0.5 else "white"
        axis.text(column, row - 0.1, f"{mean:.{digits}f}", ha="center", va="center", color=ink, fontsize=8.5)
        away = panel.away[row, column]
        if np.isfinite(away):
            small = f"±{away:.{digits + 1}f}".replace("±0.", "±.")
            axis.text(column, row + 0.2, small, ha="center", va="center", color=ink, fontsize=6.5, alpha=0.85)
        if panel.dotted is not None and panel.dotted[row, column]:
            axis.plot(column + 0.34, row - 0.31, "o", markersize=4.5, mfc=PUBLISHED, mec="white", mew=0.7)
        if panel.framed is not None and panel.framed[row, column]:
            corner = (column - 0.44, row - 0.44)
            axis.add_patch(Rectangle(corner, 0.88, 0.88, fill=False, edgecolor=PUBLISHED, linewidth=2.2))
    return image


@dataclass(frozen=True)
class Differences:
    """One panel: mean differences to the first row with 95 % intervals, and p after Holm's correction, all [row]."""

    axis: str
    names: Sequence[str]
    mean: np.ndarray
    low: np.ndarray
    high: np.ndarray
    p: np.ndarray


def pairs(panels: Sequence[Differences], path: str | os.PathLike, title: str, note: str) -> Path:
    """Draw differences to a first row as points on a line each; filled where p < 0.05. It appears whole or not at all."""
    rows = len(panels[0].names)
    size = (1.2 + 0.07 * max(map(len, panels[0].names)) + 3.3 * len(panels), min(1.7 + 0.3 * rows, 40.0))
    with sheet(1, len(panels), size, path, title, note) as (figure, axes):
        place = np.arange(rows)[::-1]
        for k, (axis, panel) in enumerate(zip(axes[0], panels, strict=True)):
            away = np.abs(np.stack([panel.mean - panel.low, panel.high - panel.mean]))
            axis.axvline(0, color=INK, linewidth=0.9)
            axis.errorbar(panel.mean, place, xerr=away, fmt="none", ecolor=OURS, elinewidth=1.4, capsize=2.5)
            for sure, face, text in ((True, OURS, "p < 0.05"), (False, "white", "p ≥ 0.05")):
                some = (panel.p < 0.05) == sure
                label = f"{text} (paired t-test, Holm)"
                axis.plot(panel.mean[some], place[some], "o", markersize=6, mfc=face, mec=OURS, mew=1.3, label=label, zorder=3)
            for row, p in zip(place, panel.p, strict=True):
                text = "" if not np.isfinite(p) else "p < .001" if p < 0.001 else f"p = {p:.3f}".replace("0.", ".", 1)
                axis.text(1.02, row, text, transform=axis.get_yaxis_transform(), va="center", fontsize=7.5, color=FAINT)
            axis.set_yticks(place, panel.names if k == 0 else [""] * rows)
            axis.tick_params(axis="y", length=0)
            axis.set_ylim(-0.6, rows - 0.4)
            axis.margins(x=0.12)
            axis.set_xlabel(panel.axis)
            axis.spines[["top", "right", "left"]].set_visible(False)
            axis.grid(True, axis="both", color=GRID, linewidth=0.7)
            axis.set_axisbelow(True)
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False)
    return Path(path)


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
