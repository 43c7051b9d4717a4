"""Figures: which figures a study gets, laid out for render."""

from pathlib import Path
from typing import Any, get_args

import numpy as np

from tiswarm.cli.options import WrongInput
from tiswarm.records.results import Z95
from tiswarm.studies.axes import NAME, label
from tiswarm.studies.design import Figure
from tiswarm.studies.payoffs import SHOWN, Contest
from tiswarm.studies.report import Report, Row, figures_of
from tiswarm.system.words import did_you_mean

AXES = {"success": "share of prey that arrive", "time": "trial time [s]", "impact_spread": "last minus first arrival [s]"}


def chosen(text: str | None) -> tuple[Any, ...] | None:
    """Read --figures: names, or none. Errors: WrongInput."""
    if text is None:
        return None
    names = [] if text.strip() == "none" else [name.strip() for name in text.split(",") if name.strip()]
    for name in names:
        if name not in get_args(Figure):
            raise WrongInput(f"--figures {text}: unknown '{name}'; {did_you_mean(name, [*get_args(Figure), 'none'])}")
    return tuple(names)


def draw(report: Report, folder: Path, played: Contest | None = None) -> None:
    """Draw what the study asks for, or what its shape suggests; a game as its pay-off matrix, too."""
    draws = {"bars": _bars, "heat": _heat, "pairs": _pairs, "scatter": _scatter}
    for rows in report.tables:
        for figure in figures_of(report.study):
            draws[figure](report, rows, folder)
    if played is not None:
        _game(report, played, folder)


def _axis(measure: str) -> str:
    return AXES.get(measure, measure.replace("_", " "))


def _note(report: Report, rows: list[Row]) -> str:
    return f"{rows[0].cell.table.name}: {rows[0].trials:,} trials a row, seed {report.seed}"


def _ends(rows: list[Row], measure: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    each = [row.estimate(measure) for row in rows]
    return tuple(np.array([getattr(e, end) for e in each]) for end in ("mean", "low", "high"))  # type: ignore[return-value]


def _bars(report: Report, rows: list[Row], folder: Path) -> None:
    from render.plots.bars import Bars, bars

    panels = []
    for measure in report.study.measures:
        published = np.array([row.published.get(measure, np.nan) for row in rows])
        away = np.array([Z95 * row.published_stderr(measure) for row in rows])
        names = [row.cell.row for row in rows]
        panels.append(Bars(measure.replace("_", " "), _axis(measure), names, *_ends(rows, measure), published, away))
    table = rows[0].cell.table
    bars(panels, folder / f"{table.name}.png", table.title, _note(report, rows))


def _heat(report: Report, rows: list[Row], folder: Path) -> None:
    """Draw a heat map for each measure: the last two axes as rows and columns, a panel for each stop of those before."""
    from render.plots.heat import Heat, heat

    table = rows[0].cell.table
    stops = [[tuple(label(stop[key]) for key in axis.shown if key in stop) for stop in axis.stops()] for axis in table.axes]
    if table.combine != "grid" or len(stops) < 2:
        raise WrongInput(f"--figures heat: {table.name} is no grid of two axes or more; draw bars, pairs or scatter")
    shape = (-1, len(stops[-2]), len(stops[-1]))
    names = [["/".join(stop) for stop in each] for each in stops]
    heads = [" / ".join(key for key in axis.shown if key != NAME) for axis in table.axes]
    titles = [", ".join(f"{head} {name}" for head, name in zip(heads[:-2], row, strict=True)) for row in _product(names[:-2])]
    for measure in report.study.measures:
        mean, low, high = (each.reshape(shape) for each in _ends(rows, measure))
        if not np.isfinite(mean).any():
            continue  # no trial had a value
        panels = [
            Heat(title, names[-2], names[-1], m, (h - lo) / 2) for title, m, lo, h in zip(titles, mean, low, high, strict=True)
        ]
        note = f"{_note(report, rows)}; ± is half a 95 % interval"
        heat(panels, folder / f"{table.name}-heat-{measure}.png", table.title, note, _axis(measure), heads[-2], heads[-1])


def _product(names: list[list[str]]) -> list[tuple[str, ...]]:
    from itertools import product

    return list(product(*names))


def _pairs(report: Report, rows: list[Row], folder: Path) -> None:
    from render.plots.pairs import Differences, pairs

    table = rows[0].cell.table
    if report.study.independent or len(rows) < 2:
        return  # nothing is paired
    panels = []
    for measure in report.study.measures:
        tested = report.pairs(rows, measure)
        mean, low, high = (np.array([getattr(each.difference, end) for each in tested]) for end in ("mean", "low", "high"))
        names = [row.cell.row for row in rows[1:]]
        panels.append(Differences(f"Δ {_axis(measure)}", names, mean, low, high, np.array([each.p_holm for each in tested])))
    note = f"{_note(report, rows)}; differences between trials that meet the same luck, 95 % intervals"
    title = f"{table.title}: differences to {rows[0].cell.row}"
    pairs(panels, folder / f"{table.name}-pairs.png", title, note)


def _scatter(report: Report, rows: list[Row], folder: Path) -> None:
    from render.plots.scatter import Cloud, scatter

    table = rows[0].cell.table
    names = [] if table.combine == "latin" else [row.cell.row for row in rows]
    if {"success", "time"} <= set(report.study.measures):
        x, x_low, x_high = _ends(rows, "time")
        y, y_low, y_high = _ends(rows, "success")
        cloud = Cloud(names, x, y, (x_high - x_low) / 2, (y_high - y_low) / 2)
        note = f"{_note(report, rows)}; crosses are 95 % intervals"
        scatter(cloud, folder / f"{table.name}-scatter.png", table.title, note, _axis("time"), _axis("success"))
    if rows[0] is report.rows[0]:
        _correlations(report, folder)


def _correlations(report: Report, folder: Path) -> None:
    from render.plots.scatter import Cloud, scatter

    rows, measures = report.rows, report.study.measures
    for each in report.correlations:
        y, low, high = _ends(rows, each.y)
        x = _ends(rows, each.x)[0] if each.x in measures else np.array([float(row.cell.point[each.x]) for row in rows])
        logarithmic = any(each.x in axis.keys and axis.scale == "log" for axis in rows[0].cell.table.axes)
        names = [] if rows[0].cell.table.combine == "latin" else [row.cell.row for row in rows]
        cloud = Cloud(names, x, y, np.zeros(len(rows)), (high - low) / 2, logarithmic)
        r, rho = each.pearson, each.spearman
        note = (
            f"Pearson r {r[0]:.2f} ({r[1]:.2f} to {r[2]:.2f}), Spearman rho {rho[0]:.2f} ({rho[1]:.2f} to {rho[2]:.2f}), "
            f"{len(rows)} cells"
        )
        path = folder / f"{report.name}-{each.x.rpartition('.')[2]}-{each.y}.png"
        scatter(cloud, path, report.study.title, note, _axis(each.x), _axis(each.y))


def _game(report: Report, played: Contest, folder: Path) -> None:
    """Draw a pay-off matrix: where prey choose two things, these span a panel for each choice of the predators."""
    from render.plots.heat import Heat, heat

    rules = report.study.game
    assert rules is not None
    mean = played.payoff
    each = [[cell.estimate(played.measure) for cell in cells] for cells in played.cells]
    away = np.array([[(e.high - e.low) / 2 for e in row] for row in each])
    framed = np.repeat(played.solution.rows[:, None] >= SHOWN, mean.shape[1], axis=1)
    head = f"value {played.solution.value:.3f} ({played.spread.value[0]:.3f} to {played.spread.value[1]:.3f})"
    note = (
        f"{report.rows[0].trials:,} trials a cell, seed {report.seed}, ± half a 95 % interval; {head}\n"
        "frame: in the prey's optimal mixture; dot: the prey's best answer"
    )
    shares = [
        f"against {name}, played {share:.0%}" for name, share in zip(played.columns, played.solution.columns, strict=True)
    ]
    axes = [axis.keys for axis in report.rows[0].cell.table.axes]
    if len(rules.prey) == 2 and all((key,) in axes for key in rules.prey):  # a grid, not two keys that change together
        points = [cells[0].cell.point for cells in played.cells]
        names = [list(dict.fromkeys(label(point[key]) for point in points)) for key in rules.prey]
        shape = tuple(map(len, names))
        panels = [
            Heat(shares[c], names[0], names[1], *(of[:, c].reshape(shape) for of in (mean, away, framed, played.best[0])))
            for c in range(mean.shape[1])
        ]
        heads = rules.prey
    else:
        panels = [Heat("", played.rows, played.columns, mean, away, framed, played.best[0])]
        heads = (" / ".join(rules.prey), " / ".join(rules.predators))
    heat(panels, folder / f"{report.name}-payoff.png", report.study.title, note, _axis(played.measure), heads[0], heads[1])
