"""Heat: heat maps of a study's cells. Needs matplotlib."""

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from render.plots.figure import PUBLISHED, sheet


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
