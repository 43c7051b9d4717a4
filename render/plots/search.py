"""Search: how a tuning went, how much each number matters, and where its candidates lie. Needs matplotlib."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from render.plots.figure import FAINT, GRID, INK, OURS, PUBLISHED, sheet


@dataclass(frozen=True)
class Progress:
    """Candidates by generation, checks as gains to the start, and the validated gain of each scenario.

    generation, best, mean: [generation]; checked, gain, low, high: [check]; names, final, final_low, final_high: [scenario].
    """

    generation: np.ndarray
    best: np.ndarray
    mean: np.ndarray
    checked: np.ndarray
    gain: np.ndarray
    low: np.ndarray
    high: np.ndarray
    names: Sequence[str]
    final: np.ndarray
    final_low: np.ndarray
    final_high: np.ndarray


def progress(told: Progress, path: str | os.PathLike, title: str, note: str, objective: str) -> Path:
    """Draw candidates above and paired gains to the start below; it appears whole or not at all."""
    with sheet(2, 1, (7.2, 5.6), path, title, note) as (_, axes):
        above, below = axes[0][0], axes[1][0]
        above.plot(told.generation, told.best, color=FAINT, linewidth=0.9, label="best candidate, on its own trials")
        above.plot(told.generation, told.mean, color=OURS, linewidth=1.4, label="mean of the generation")
        above.set_ylabel(objective)
        above.legend(frameon=False, fontsize=8, loc="lower right")
        away = np.abs(np.stack([told.gain - told.low, told.high - told.gain]))
        below.axhline(0, color=INK, linewidth=0.9)
        below.errorbar(
            told.checked,
            told.gain,
            away,
            fmt="o-",
            color=OURS,
            markersize=4,
            linewidth=1,
            elinewidth=1,
            label="check of the middle",
        )
        end = float(told.generation[-1])
        span = max(end - float(told.generation[0]), 1.0)
        for k, name in enumerate(told.names):
            place = end + (0.05 + 0.04 * k) * span
            far = np.abs([[told.final[k] - told.final_low[k]], [told.final_high[k] - told.final[k]]])
            label = "validated" if len(told.names) == 1 else f"validated: {name}"
            below.errorbar(
                [place], [told.final[k]], far, fmt="D", color=PUBLISHED, mec="white", markersize=7, capsize=3, label=label
            )
        below.set_ylabel("paired gain to the start")
        below.set_xlabel("generation")
        below.legend(frameon=False, fontsize=8, loc="lower right")
        above.sharex(below)
        above.tick_params(labelbottom=False)
        below.xaxis.get_major_locator().set_params(integer=True)
        for axis in (above, below):
            _plain(axis)
    return Path(path)


@dataclass(frozen=True)
class Response:
    """One number moved over its range: the objective's mean and interval there, and where the search settled."""

    name: str
    logarithmic: bool
    values: np.ndarray
    mean: np.ndarray
    low: np.ndarray
    high: np.ndarray
    found: float


def responses(panels: Sequence[Response], path: str | os.PathLike, title: str, note: str, objective: str) -> Path:
    """Draw a panel for each number, in rows of three, on one scale; it appears whole or not at all."""
    across = min(len(panels), 3)
    down = -(-len(panels) // across)
    floor, ceiling = min(np.nanmin(panel.low) for panel in panels), max(np.nanmax(panel.high) for panel in panels)
    edge = 0.05 * max(ceiling - floor, 1e-9)
    with sheet(down, across, (max(3.1 * across, 4.2), 2.3 * down + 0.8), path, title, note) as (_, axes):
        for place, axis in enumerate(axes.flat):
            if place >= len(panels):
                axis.set_axis_off()
                continue
            panel = panels[place]
            axis.fill_between(panel.values, panel.low, panel.high, color=OURS, alpha=0.22, linewidth=0)
            axis.plot(panel.values, panel.mean, "o-", color=OURS, markersize=3, linewidth=1.3)
            axis.axvline(panel.found, color=PUBLISHED, linewidth=1.3)
            if panel.logarithmic:
                axis.set_xscale("log")
            axis.set_ylim(floor - edge, ceiling + edge)
            axis.set_title(f"{panel.name} = {panel.found:g}", fontsize=9)
            if place % across == 0:
                axis.set_ylabel(objective)
            _plain(axis)
    return Path(path)


def parallel(
    names: Sequence[str],
    ends: Sequence[tuple[str, str]],
    units: np.ndarray,
    rank: np.ndarray,
    start: np.ndarray,
    found: np.ndarray,
    path: str | os.PathLike,
    title: str,
    note: str,
) -> Path:
    """Draw candidates as lines across one axis a number, good ones dark; it appears whole or not at all.

    ends: what 0 and 1 stand for; units: [candidate, number]; rank: [candidate], from 0 for the worst to 1 for the best of its
    generation; start, found: [number].
    """
    import matplotlib as mpl

    scale = mpl.colormaps["Blues"]
    width = max(1.5 * len(names) + 1.4, 5.0)
    with sheet(1, 1, (width, 4.4), path, title, note) as (figure, axes):
        axis = axes[0][0]
        place = np.arange(len(names))
        for k in np.argsort(rank, kind="stable"):
            axis.plot(place, units[k], color=scale(0.15 + 0.8 * rank[k]), linewidth=0.7, alpha=0.45)
        axis.plot(place, start, "o--", color=INK, linewidth=1.6, markersize=5, label="start")
        axis.plot(place, found, "D-", color=PUBLISHED, linewidth=2.0, markersize=5, label="found")
        for x, (low, high) in zip(place, ends, strict=True):
            axis.axvline(x, color=GRID, linewidth=1.0, zorder=0)
            axis.text(x, -0.03, low, ha="center", va="top", fontsize=8)
            axis.text(x, 1.03, high, ha="center", va="bottom", fontsize=8)
        axis.set_xticks(place, [name.rpartition(".")[2] for name in names])
        axis.tick_params(length=0, pad=14)
        axis.set_yticks([])
        axis.set_ylim(-0.02, 1.02)
        axis.set_xlim(-0.35, max(len(names) - 0.65, 0.35))
        axis.spines[:].set_visible(False)
        figure.legend(loc="outside lower center", ncols=2, frameon=False)
    return Path(path)


def _plain(axis) -> None:
    axis.spines[["top", "right"]].set_visible(False)
    axis.grid(True, color=GRID, linewidth=0.7)
    axis.set_axisbelow(True)
