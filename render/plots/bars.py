"""Bars: a study's rows as bars beside published figures. Needs matplotlib."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from render.plots.figure import GRID, INK, OURS, PUBLISHED, sheet

MOST_NAMES = 60
"""Bars that can be named side by side; of more, every second, third, ... is named."""


@dataclass(frozen=True)
class Bars:
    """One panel: means with 95 % intervals as bars, published means with theirs as marks (NaN where there is none)."""

    title: str
    axis: str
    names: Sequence[str]
    mean: np.ndarray
    low: np.ndarray
    high: np.ndarray
    published: np.ndarray
    published_away: np.ndarray  # half the width of the published mean's interval


def bars(panels: Sequence[Bars], path: str | os.PathLike, title: str, note: str = "") -> Path:
    """Draw panels side by side into one PNG; it appears whole or not at all.

    Errors: ModuleNotFoundError when matplotlib is not installed.
    """
    width = min(max(4.1, 0.9 + 0.3 * max(len(panel.names) for panel in panels)), 20.0)
    with sheet(1, len(panels), (width * len(panels), 3.9), path, title, note) as (figure, axes):
        for axis, panel in zip(axes[0], panels, strict=True):
            _draw(axis, panel)
        handles, labels = axes[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False)
    return Path(path)


def _draw(axis, panel: Bars) -> None:
    place = np.arange(len(panel.names))
    away = np.abs(np.stack([panel.mean - panel.low, panel.high - panel.mean]))
    axis.bar(place, panel.mean, width=0.7, color=OURS, alpha=0.85, label="tiswarm, 95 % interval")
    axis.errorbar(place - 0.12, panel.mean, yerr=away, fmt="none", ecolor=INK, elinewidth=1.2, capsize=3)
    if np.isfinite(panel.published).any():
        marks: Any = {
            "fmt": "D",
            "markersize": 5,
            "color": PUBLISHED,
            "mec": "white",
            "ecolor": PUBLISHED,
            "elinewidth": 1.2,
            "capsize": 3,
        }
        axis.errorbar(place + 0.18, panel.published, yerr=panel.published_away, label="published, 95 % interval", **marks)
    step = -(-len(place) // MOST_NAMES)
    axis.set_xticks(place[::step], panel.names[::step], rotation=35, ha="right", rotation_mode="anchor")
    axis.set_ylabel(panel.axis)
    axis.set_title(panel.title, fontsize=10)
    axis.spines[["top", "right"]].set_visible(False)
    axis.yaxis.grid(True, color=GRID, linewidth=0.7)
    axis.set_axisbelow(True)
    if not (panel.mean < 0).any():
        axis.set_ylim(bottom=0)
