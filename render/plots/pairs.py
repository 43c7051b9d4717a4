"""Pairs: paired differences between a study's rows. Needs matplotlib."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from render.plots.figure import FAINT, GRID, INK, OURS, sheet


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
