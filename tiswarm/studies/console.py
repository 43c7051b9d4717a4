"""Console: results as text, for the terminal."""

import math
from collections.abc import Sequence

import numpy as np
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Table

from tiswarm.records.results import Estimate, Results
from tiswarm.studies.axes import label
from tiswarm.studies.payoffs import SHOWN, Contest
from tiswarm.studies.report import Report, Row
from tiswarm.studies.statistics import Correlation
from tiswarm.system.words import safe

WIDEST = 10_000


def _heading(*lines: str) -> str:
    """Give lines from a user's file as a heading: data, never markup or control characters."""
    return "\n".join(escape(safe(line)) for line in lines if line.strip())


def print_summary(results: Results, out: Console) -> None:
    """Print the estimates of a batch."""
    table = Table(title=_heading(results.scenario.title), title_justify="left")
    for head in ("", "mean", "± stderr", "95 % interval"):
        table.add_column(head, justify="right" if head else "left")
    for name, each in results.summary().items():
        table.add_row(name, f"{each.mean:.4f}", f"{each.stderr:.4f}", f"{each.low:.4f} … {each.high:.4f}")
    out.print(table)


def print_report(report: Report, out: Console, played: Contest | None = None) -> None:
    """Print a study: as the game that it is, against what was published, or its cells; correlations; what was computed."""
    if played is not None:
        print_contest(played, _heading(report.study.title, report.study.source), out)
    elif report.study.published is not None:
        _print_rows(report, out)
    else:
        _print_cells(report, out)
    for each in report.correlations:
        out.print(_correlated(each))
    for line in report.computed.values():
        out.print(f"  {line}", style="dim")
    if played is not None:
        out.print(f"  {played.computed}", style="dim")


def _print_cells(report: Report, out: Console) -> None:
    """Print all cells; a file is as wide as it takes."""
    named = report.study.tables is not None
    if not out.is_terminal:
        out.width = max(out.width, _width(cell_table(report.rows, report.shown, report.study.measures, named), out))
    table = fitting(report.rows, report.shown, report.study.measures, named, out)
    table.title = _heading(report.study.title, report.study.source)
    out.print(table)


def fitting(rows: Sequence[Row], keys: Sequence[str], measures: Sequence[str], named: bool, out: Console) -> Table:
    """Lay cells out; intervals are left to cells.csv where a terminal is too narrow for them."""
    table = cell_table(rows, keys, measures, named)
    return table if _width(table, out) <= out.width else cell_table(rows, keys, measures, named, intervals=False)


def _width(table: Table, out: Console) -> int:
    """Tell how wide a table would like to be."""
    return Measurement.get(out, out.options.update(max_width=WIDEST), table).maximum


def _print_rows(report: Report, out: Console) -> None:
    """Print ours ± standard error, the published mean and z, for each row and measure."""
    measures = report.study.measures
    table = Table(title=_heading(report.study.title, report.study.source), title_justify="left", box=box.SIMPLE, padding=0)
    table.add_column("table", no_wrap=True)
    table.add_column("row", no_wrap=True)
    for measure in measures:
        for head in (measure.replace("_", " "), "published", "z"):
            table.add_column(head, justify="right", no_wrap=True)
    last = None
    for row in report.rows:
        name = row.cell.table.name
        if last not in (None, name):
            table.add_section()
        cells = []
        for measure in measures:
            ours, digits = row.estimate(measure), digits_of(measure, row.estimate(measure))
            published = row.published.get(measure)
            cells += [
                f"{ours.mean:.{digits}f} ± {ours.stderr:.{digits}f}",
                "" if published is None else f"{published:.{digits}f}",
            ]
            cells.append("" if published is None else f"{row.z(measure):+.2f}")
        table.add_row("" if name == last else name, row.cell.row, *cells)
        last = name
    out.print(table)
    subsets = (("success and time", ("success", "time")), ("all three", measures))
    for name, subset in subsets if set(measures) >= {"success", "time"} else (("all", measures),):
        rms, most = report.z_summary(subset)
        if math.isfinite(rms):
            out.print(f"z over {name}: root mean square {rms:.2f}, largest |z| {most:.2f}")


def cell_table(
    rows: Sequence[Row], keys: Sequence[str], measures: Sequence[str], named: bool = False, intervals: bool = True
) -> Table:
    """Lay cells out: number, table if named, values on the axes, trials; mean ± stderr and interval of each measure."""
    table = Table(title_justify="left", box=box.SIMPLE, padding=(0, 1, 0, 0))
    for head in ("cell", *(["table"] if named else []), *keys, "n"):
        table.add_column(head, no_wrap=True, justify="right" if head in ("cell", "n") else "left")
    for measure in measures:
        table.add_column(measure.replace("_", " "), justify="right", no_wrap=True)
        if intervals:
            table.add_column("95 %", justify="left", no_wrap=True)
    for row in rows:
        point = row.cell.point
        places = [label(point[key]) if key in point else "" for key in keys]
        cells = []
        for measure in measures:
            ours = row.estimate(measure)
            digits = digits_of(measure, ours)
            cells.append(f"{ours.mean:.{digits}f} ± {ours.stderr:.{digits}f}" if math.isfinite(ours.mean) else "–")
            if intervals:
                cells.append(f"{ours.low:.{digits}f} … {ours.high:.{digits}f}" if math.isfinite(ours.stderr) else "–")
        table.add_row(str(row.cell.number), *([row.cell.table.name] if named else []), *places, f"{row.trials:,}", *cells)
    for column in (
        table.columns[0],
        *table.columns[-len(measures) * (1 + intervals) - 1 :],
    ):  # numbers stay whole, names give way
        column.min_width = max((len(str(each)) for each in column.cells), default=0)
    return table


def digits_of(measure: str, each: Estimate) -> int:
    """Choose how many digits after the point a measure is printed with: those that its standard error leaves, for new ones."""
    known = {"success": 4, "time": 2, "impact_spread": 2}.get(measure)
    if known is not None:
        return known
    size = each.stderr if math.isfinite(each.stderr) and each.stderr > 0 else abs(each.mean) / 1000
    return min(max(1 - math.floor(math.log10(size)), 0), 9) if size > 0 else 2


def _correlated(each: Correlation) -> str:
    pearson, spearman = (f"{value:+.3f} ({low:+.3f} … {high:+.3f})" for value, low, high in (each.pearson, each.spearman))
    return f"{each.x} against {each.y}, {each.n} cells: Pearson r {pearson}, Spearman rho {spearman}"


def print_contest(played: Contest, title: str, out: Console) -> None:
    """Print a pay-off matrix with intervals, best responses, what is dominated, and the game's value and mixtures."""
    table = Table(title=title, title_justify="left", box=box.SIMPLE, padding=(0, 1, 0, 0))
    table.add_column("prey", no_wrap=True)
    for column in played.columns:
        table.add_column(f"against {column}", justify="right", no_wrap=True)
    table.add_column("dominated by")
    for r, name in enumerate(played.rows):
        cells = []
        for c in range(len(played.columns)):
            each = played.estimate(r, c)
            marks = ("+" if played.best[0][r, c] else " ") + ("-" if played.best[1][r, c] else " ")
            cells.append(f"{each.mean:.4f} ({each.low:.4f} … {each.high:.4f}) {marks}")
        table.add_row(name, *cells, played.dominator("rows", r))
    out.width = out.width if out.is_terminal else max(out.width, _width(table, out))
    out.print(table)
    out.print(
        f"{played.measure} with its 95 % interval; + the prey's best answer to the column, - the predators' best to the row"
    )
    for c, column in enumerate(played.columns):
        answers = [r for r in range(len(played.rows)) if played.best[0][r, c]]
        best = ", ".join(f"{played.rows[r]} (in {played.spread.best[r, c]:.0%} of resamples)" for r in answers)
        beaten = int(played.best[1][:, c].sum())
        worse = played.dominator("columns", c)
        out.print(
            f"against {column}: prey's best answer {best}; the predators' best answer to {beaten} of {len(played.rows)} rows"
            + (f"; dominated by {worse}" if worse else "")
        )
    out.print(f"value of the game {played.solution.value:.4f} ({played.spread.value[0]:.4f} … {played.spread.value[1]:.4f})")
    for side, names, shares, ends in (
        ("prey", played.rows, played.solution.rows, played.spread.rows),
        ("predators", played.columns, played.solution.columns, played.spread.columns),
    ):
        for k in np.argsort(-shares, kind="stable"):
            if shares[k] >= SHOWN or ends[k, 1] >= 10 * SHOWN:
                out.print(f"  {side} play {names[k]}: {shares[k]:.1%} ({ends[k, 0]:.1%} … {ends[k, 1]:.1%})")
