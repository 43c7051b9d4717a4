"""Tables: results as text, for the terminal."""

import math

from rich import box
from rich.console import Console
from rich.table import Table

from tiswarm.results import Results
from tiswarm.studies import MEASURES, Report


def print_summary(results: Results, out: Console) -> None:
    """Print the estimates of a batch."""
    table = Table(title=results.scenario.title, title_justify="left")
    for head in ("", "mean", "± stderr", "95 % interval"):
        table.add_column(head, justify="right" if head else "left")
    for name, each in results.summary().items():
        table.add_row(name, f"{each.mean:.4f}", f"{each.stderr:.4f}", f"{each.low:.4f} … {each.high:.4f}")
    out.print(table)


def print_rows(report: Report, out: Console) -> None:
    """Print a study: ours ± standard error, the published mean and z, for each row and measure."""
    table = Table(title=f"{report.study.title}\n{report.study.source}", title_justify="left", box=box.SIMPLE, padding=0)
    table.add_column("table", no_wrap=True)
    table.add_column("row", no_wrap=True)
    for measure in MEASURES:
        for head in (measure.replace("_", " "), "published", "z"):
            table.add_column(head, justify="right", no_wrap=True)
    last = None
    for row in report.rows:
        if last not in (None, row.table.name):
            table.add_section()
        cells = []
        for measure in MEASURES:
            ours, digits = row.estimate(measure), 4 if measure == "success" else 2
            published = row.published.get(measure)
            cells += [
                f"{ours.mean:.{digits}f} ± {ours.stderr:.{digits}f}",
                "" if published is None else f"{published:.{digits}f}",
            ]
            cells.append("" if published is None else f"{row.z(measure):+.2f}")
        table.add_row("" if row.table.name == last else row.table.name, row.value, *cells)
        last = row.table.name
    out.print(table)
    for name, measures in (("success and time", MEASURES[:2]), ("all three", MEASURES)):
        rms, most = report.z_summary(measures)
        if math.isfinite(rms):
            out.print(f"z over {name}: root mean square {rms:.2f}, largest |z| {most:.2f}")
