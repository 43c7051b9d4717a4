"""Tune figures: how a search went, how much each number matters, and where good candidates lie."""

from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.learning import halving
from tiswarm.learning.sensitivity import sensitivities

MOST_LINES = 400
"""Candidates that a parallel plot draws, evenly taken from all generations."""


def draw(tuned: Any, folder: Path) -> list[Path]:
    """Draw progress.png, and sensitivity.png and candidates.png where numbers were searched; give the files."""
    from render.plots.search import Progress, Response, progress, responses

    checked = [made for made in tuned.history if made.check is not None]
    gains = [made.check.gain for made in checked]
    numbers = np.array([made.number + 1 for made in tuned.history])
    away = [each.difference for each in tuned.validations]
    told = Progress(
        numbers,
        np.array([made.best for made in tuned.history]),
        np.array([made.scores.mean() for made in tuned.history]),
        np.array([made.number + 1 for made in checked]),
        *_ends(gains),
        [each.title for each in tuned.validations],
        *_ends(away),
    )
    title = tuned.starts[0].title
    note = f"seed {tuned.seed}, {tuned.trials:,} validation trials that no search saw"
    files = [progress(told, folder / "progress.png", title, note, str(tuned.objective))]
    found = sensitivities(tuned)
    if found:
        panels = [
            Response(each.range.path, each.range.scale == "log", each.values, *_ends(each.estimates), each.found)
            for each in found
        ]
        files.append(
            responses(panels, folder / "sensitivity.png", title, "one number moved, the others as found", str(tuned.objective))
        )
        files.append(_candidates(tuned, folder, title))
    return files


def _ends(estimates: list[Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return tuple(np.array([getattr(each, end) for each in estimates]) for end in ("mean", "low", "high"))  # type: ignore[return-value]


def _candidates(tuned: Any, folder: Path, title: str) -> Path:
    from render.plots.search import parallel

    own = [made for made in tuned.history if made.arm_number == tuned.best.arm]
    arm = own[0].arm
    units = np.concatenate([made.units[:, : len(arm.ranges)] for made in own])
    standings = [halving.standing(made.scores, made.met) for made in own]
    rank = np.concatenate([np.argsort(np.argsort(each)) / max(len(each) - 1, 1) for each in standings])
    some = np.linspace(0, len(units) - 1, min(MOST_LINES, len(units))).astype(int)
    ends = [(f"{each.low:g}", f"{each.high:g}") for each in arm.ranges]
    best = np.array([each.unit(value) for each, value in zip(arm.ranges, tuned.best.values, strict=False)])
    names = [each.path for each in arm.ranges]
    return parallel(
        names,
        ends,
        units[some],
        rank[some],
        arm.start[: len(arm.ranges)],
        best,
        folder / "candidates.png",
        title,
        "lines: candidates by their rank in a generation",
    )
