"""Export: a report written as CSV and Parquet."""

import csv
import importlib.util
import io
import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from tiswarm.studies.axes import label
from tiswarm.studies.report import Report, figures_of
from tiswarm.system.files import replacing, write_text


def against_published(report: Report) -> str:
    """Write one line per row: our mean and standard error, the published mean and z for each measure."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    measures = report.study.measures
    heads = [f"{measure}{end}" for measure in measures for end in ("", "_stderr", "_published", "_z")]
    writer.writerow(["table", "row", "trials", *heads])
    for row in report.rows:
        cells: list[Any] = [row.cell.table.name, row.cell.row, row.trials]
        for measure in measures:
            ours = row.estimate(measure)
            cells += [f"{ours.mean:.6f}", f"{ours.stderr:.6f}", row.published.get(measure, ""), f"{row.z(measure):.3f}"]
        writer.writerow(cells)
    return text.getvalue()


def paired_csv(report: Report) -> str:
    """Write one line per row and measure: its paired difference to the first row of its table, p, and p after Holm."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["table", "row", "first", "measure", "difference", "stderr", "low", "high", "p", "p_holm"])
    for rows in report.tables:
        for measure in report.study.measures:
            for row, each in zip(rows[1:], report.pairs(rows, measure), strict=True):
                numbers = (*asdict(each.difference).values(), each.p, each.p_holm)
                place = [row.cell.table.name, row.cell.row, rows[0].cell.row, measure]
                writer.writerow([*place, *(_number(number) for number in numbers)])
    return text.getvalue()


def write(report: Report, folder: Path, per_trial: bool = False, parquet: bool = False) -> None:
    """Write cells.csv; rows.csv where something was published; trials.csv and Parquet files where wanted."""
    lines = report.cells()
    write_text(folder / "cells.csv", _csv(lines))
    if report.study.published is not None:
        write_text(folder / "rows.csv", against_published(report))
    if "pairs" in figures_of(report.study):
        write_text(folder / "pairs.csv", paired_csv(report))
    if per_trial:
        with replacing(folder / "trials.csv") as part, part.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            for k, columns in enumerate(_trials(report)):
                if k == 0:
                    writer.writerow(columns)
                writer.writerows(zip(*columns.values(), strict=True))
    if parquet:
        _parquet(folder / "cells.parquet", {name: [line[name] for line in lines] for name in lines[0]})
        if per_trial:
            parts = list(_trials(report))
            columns = {name: [value for part in parts for value in part[name]] for name in parts[0]}
            _parquet(folder / "trials.parquet", columns)


def _trials(report: Report) -> Iterator[dict[str, list[Any]]]:
    """Give the columns of all trials, cell by cell."""
    for row in report.rows:
        n = row.trials
        place = {key: [_plain(value)] * n for key, value in report.place(row).items()}
        yield place | {"trial": list(range(n))} | {name: values.tolist() for name, values in row.outcomes.items()}


def _plain(value: Any) -> Any:
    return value if value is None or isinstance(value, str | int | float) else label(value)


def _number(value: Any) -> Any:
    """Write a number so that it reads back to nine digits; what cannot be known stays empty."""
    if isinstance(value, float):
        return f"{value:.9g}" if math.isfinite(value) else ""
    return "" if value is None else _plain(value)


def _csv(lines: list[dict[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(lines[0])
    writer.writerows([_number(value) for value in line.values()] for line in lines)
    return text.getvalue()


def check_parquet() -> None:
    """Raise ValueError unless Parquet files can be written."""
    if importlib.util.find_spec("pyarrow") is None:
        raise ValueError("--parquet: pyarrow is not installed; pip install 'tiswarm[parquet]'")


def _parquet(path: Path, columns: Mapping[str, list[Any]]) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    plain = {}
    for name, values in columns.items():
        kinds = {type(value) for value in values if value is not None}
        mixed = (len(kinds) > 1 and not kinds <= {int, float}) or kinds & {list, tuple}
        plain[name] = [None if value is None else label(value) for value in values] if mixed else values
    with replacing(path) as part:
        parquet.write_table(pa.table(plain), part)
