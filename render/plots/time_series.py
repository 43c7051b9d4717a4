"""Time series: places, velocities, distances and swept ground against time. Needs matplotlib (pip install "tiswarm[plot]")."""

import importlib.util
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from render.plots.figure import FAINT, GRID, INK, OURS, PUBLISHED, sheet
from tiswarm.measures import recorded
from tiswarm.records.recording import Recording, Swarm
from tiswarm.space import box

HUES = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#8A6D00")
"""Okabe and Ito's, yellow darkened to be seen on white: few prey have one each, so that they are found again in every plot."""

MOST_LINES = 100
"""Prey that are drawn; of more, evenly chosen ones, since others would cover each other."""

PASSED = (0.5, 0.9, 0.99)
"""Shares of the ground whose times are marked."""


def check_matplotlib() -> None:
    """Raise ModuleNotFoundError unless there is matplotlib to draw with."""
    if importlib.util.find_spec("matplotlib") is None:
        raise ModuleNotFoundError("plots need matplotlib; pip install 'tiswarm[plot]'")


def draw(recordings: Sequence[Recording], folder: Path) -> list[Path]:
    """Draw the first recording as the sanitation report does, and the ground that all of them sweep; give the files.

    positions.png, velocities.png, neighbours.png, velocity-sum.png, and coverage.png where the scenario has a coverage grid.
    Each appears whole or not at all.
    """
    first = recordings[0]
    files = [
        _paths(first, "position", "m", folder / "positions.png"),
        _paths(first, "velocity", "m/s", folder / "velocities.png"),
        _neighbours(first, folder / "neighbours.png"),
        _velocity_sum(first, folder / "velocity-sum.png"),
    ]
    return [*files, _coverage(recordings, folder / "coverage.png")] if first.scenario.coverage.cell else files


def _paths(recording: Recording, what: str, unit: str, path: Path) -> Path:
    """Draw positions or velocities against time, a panel for each axis."""
    world = recording.scenario.world
    wraps = box.wraps(world.boundary) and what == "position"
    prey, hunters = (_values(swarm, what, world.size if wraps else None) for swarm in (recording.prey, recording.predators))
    with _panels(recording, recording.dim, path) as axes:
        for k, axis in enumerate(axes):
            _lines(axis, recording, prey[..., k])
            if not wraps and prey.shape[1] > len(HUES):
                _mean(axis, recording, prey[..., k])
            if hunters.shape[1]:
                own = axis.plot(_time(recording), hunters[..., k], color=PUBLISHED, linewidth=0.8, alpha=0.6, zorder=1.5)
                own[0].set_label("predator" if len(own) == 1 else "predators")
            if what == "position" and box.bounded(world.boundary):
                axis.set_ylim(0, world.size[k])
            axis.set_ylabel(f"{'xyz'[k]} {what} [{unit}]")
    return path


def _neighbours(recording: Recording, path: Path) -> Path:
    """Draw the distances to nearest neighbours and their mean against time."""
    distances = recorded.neighbour_distances(recording)
    with _panels(recording, 1, path, 3.4) as (axis,):
        if np.isfinite(distances).any():
            pair = recording.prey.count == 2  # each is the other's nearest
            if not pair:
                _lines(axis, recording, distances)
            _mean(axis, recording, distances, "both prey" if pair else "mean")
            spacing = recording.scenario.prey.spacing
            axis.axhline(spacing, color=INK, linewidth=1.0, linestyle=":", label=f"spacing, {spacing:g} m", zorder=2)
            axis.set_ylim(bottom=0)
        else:
            middle: Any = {"transform": axis.transAxes, "ha": "center", "va": "center", "backgroundcolor": "white"}
            axis.text(0.5, 0.5, "never two prey at a time", color=FAINT, **middle)
            axis.set_ylim(0, 1)
        axis.set_ylabel("distance to the nearest neighbour [m]")
    return path


def _velocity_sum(recording: Recording, path: Path) -> Path:
    """Draw the sum of the prey's velocities against time, a line for each axis."""
    total = np.nansum(recording.prey.velocity, axis=1)
    with _panels(recording, 1, path, 3.4) as (axis,):
        axis.axhline(0, color=FAINT, linewidth=0.9, zorder=1)
        for k, hue in zip(range(recording.dim), (OURS, PUBLISHED, HUES[2]), strict=False):
            axis.plot(_time(recording), total[:, k], color=hue, linewidth=1.5, label=f"{'xyz'[k]} component")
        axis.set_ylabel("sum of the prey's velocities [m/s]")
    return path


def _coverage(recordings: Sequence[Recording], path: Path) -> Path:
    """Draw the swept share against time: trials thin, their mean thick, with the times at which it passes certain shares."""
    shares = [recorded.coverage(recording) for recording in recordings]
    longest = max(recordings, key=lambda recording: recording.ticks)
    ends = [longest.ticks + 1 - len(share) for share in shares]
    # A trial that ends early sweeps no more: what it has swept stays swept.
    percent = 100 * np.stack([np.pad(share, (0, end), mode="edge") for share, end in zip(shares, ends, strict=True)], axis=1)
    mean = percent.mean(axis=1)
    time = _time(longest)
    many = len(recordings) > 1
    with _panels(longest, 1, path, 3.8, _all_trials(recordings)) as (axis,):
        if many:
            axis.plot(time, percent, color=OURS, linewidth=0.7, alpha=0.4)[0].set_label("one trial each")
        axis.plot(time, mean, color=OURS, linewidth=2.4, label="mean" if many else "_", zorder=3)
        passed = [(100 * share, time[mean >= 100 * share][:1]) for share in PASSED if mean[-1] >= 100 * share]
        if passed:
            told = ", ".join(f"{share:g} % after {_seconds(at.item())}" for share, at in passed)
            marks: Any = {"markersize": 6, "mfc": "white", "mec": OURS, "mew": 1.6, "zorder": 4}
            axis.plot([at.item() for _, at in passed], [share for share, _ in passed], "o", label=told, **marks)
        axis.set_ylim(0, min(104, 1.3 * percent.max() + 1))
        axis.set_ylabel("swept share of the ground [%]")
    return path


def _seconds(time: float) -> str:
    return f"{time:,.0f} s" if time >= 100 else f"{time:.3g} s"


@contextmanager
def _panels(recording: Recording, count: int, path: Path, height: float = 2.3, trial: str = "") -> Iterator[Any]:
    """Give panels below each other that share their time; title, note and legend are the recording's."""
    told = trial or f"trial {recording.trial}"
    drawn, there = len(_chosen(recording)), recording.prey.count
    note = f"{told}, seed {recording.seed}; " + (f"{drawn} of {there:,} prey" if drawn < there else f"{there} prey")
    with sheet(count, 1, (8.0, 1.3 + height * count), path, recording.scenario.title, note) as (figure, axes):
        panels = axes[:, 0]
        yield panels
        for axis in panels:
            axis.set_xlim(0, max(recording.ticks, 1) * recording.scenario.world.dt)
            axis.spines[["top", "right"]].set_visible(False)
            axis.grid(True, color=GRID, linewidth=0.7)
            axis.set_axisbelow(True)
            axis.tick_params(labelbottom=axis is panels[-1])
            axis.locator_params(axis="y", nbins=6)
        panels[-1].set_xlabel("time [s]")
        figure.align_ylabels(panels)
        handles, labels = panels[0].get_legend_handles_labels()
        if handles:
            tight = {"columnspacing": 1.3, "handlelength": 1.4, "handletextpad": 0.5}
            legend = figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), frameon=False, **tight)
            for line in legend.get_lines():
                line.set(linewidth=max(line.get_linewidth(), 1.4), alpha=1.0 if line.get_linewidth() > 1 else 0.6)


def _lines(axis: Any, recording: Recording, values: np.ndarray) -> None:
    """Draw a line for each prey, values: [tick, agent]: few in colours of their own, many thin in one."""
    chosen = _chosen(recording)
    few = recording.prey.count <= len(HUES)
    for k in chosen:
        look = {"color": HUES[k], "linewidth": 1.3} if few else {"color": OURS, "linewidth": 0.6, "alpha": _faint(len(chosen))}
        label = f"prey {k + 1}" if few else "each prey" if k == 0 else "_"
        axis.plot(_time(recording), values[:, k], label=label, **look)


def _mean(axis: Any, recording: Recording, values: np.ndarray, label: str = "mean") -> None:
    """Draw the mean over the prey that have a value: [tick, agent]."""
    count = np.isfinite(values).sum(axis=1)
    mean = np.divide(np.nansum(values, axis=1), count, out=np.full(len(values), np.nan), where=count > 0)
    axis.plot(_time(recording), mean, color=INK, linewidth=2.0, label=label, zorder=3)


def _values(swarm: Swarm, what: str, size: tuple[float, ...] | None) -> np.ndarray:
    """Give positions or velocities, [tick, agent, dim], broken where a path crosses the edge of a periodic world."""
    values = getattr(swarm, what)
    if size is None:
        return values
    jumps = np.abs(np.diff(values, axis=0, prepend=values[:1])) > 0.5 * np.array(size)
    return np.where(jumps, np.nan, values)


def _chosen(recording: Recording) -> np.ndarray:
    """Choose the prey that are drawn."""
    count = recording.prey.count
    return np.unique(np.linspace(0, count - 1, min(count, MOST_LINES)).astype(int))


def _faint(lines: int) -> float:
    return float(np.clip(8 / lines, 0.15, 0.6))


def _time(recording: Recording) -> np.ndarray:
    return np.arange(recording.ticks + 1) * recording.scenario.world.dt


def _all_trials(recordings: Sequence[Recording]) -> str:
    numbers = [recording.trial for recording in recordings]
    return f"trials {numbers[0]} to {numbers[-1]}" if len(numbers) > 1 else f"trial {numbers[0]}"
