"""Card: what a notebook shows of an object: a title, a small drawing, a small table."""

from collections.abc import Iterable, Sequence
from html import escape
from math import isfinite
from typing import Any

MOST_ROWS = 12
"""Rows of a table that are shown: the first ones, and how many there are."""

_CELL = 'style="text-align:left;padding:1px 10px 1px 0;border:0;vertical-align:top"'


def card(title: str, *parts: str) -> str:
    """Put a title over parts in HTML, which stand side by side where there is room."""
    boxes = "".join(f'<div style="flex:0 1 auto">{part}</div>' for part in parts if part)
    row = f'<div style="display:flex;flex-wrap:wrap;gap:8px 24px;align-items:flex-start">{boxes}</div>'
    return f'<div style="font-size:90%"><b>{escape(title)}</b>{row}</div>'


def table(rows: Sequence[Sequence[Any]], heads: Sequence[str] = ()) -> str:
    """Write rows as a table; of many the first ones."""
    lines = [f"<tr>{''.join(f'<th {_CELL}>{escape(head)}</th>' for head in heads)}</tr>"] if heads else []
    for row in rows[:MOST_ROWS]:
        lines.append(f"<tr>{''.join(f'<td {_CELL}>{escape(told(each))}</td>' for each in row)}</tr>")
    more = f"<div>… {len(rows):,} rows in all</div>" if len(rows) > MOST_ROWS else ""
    return f'<table style="border-collapse:collapse;border:0">{"".join(lines)}</table>{more}'


def told(value: Any) -> str:
    """Write a value as a table shows it: real numbers to four digits, none as a dash."""
    if isinstance(value, float):
        return f"{value:.4g}" if isfinite(value) else "–"
    return "–" if value is None else str(value)


def drawing(low: Sequence[float], high: Sequence[float], shapes: Iterable[str], width: int = 360) -> str:
    """Draw shapes, whose places are metres with y upwards, in a frame from `low` to `high` [x, y] as SVG."""
    wide, tall = max(high[0] - low[0], 1e-9), max(high[1] - low[1], 1e-9)
    width = min(width, int(width * max(wide / tall, 0.2)) + 1) if tall > wide else width
    height = max(int(width * tall / wide), 24)
    view = f"{low[0]:.6g} {-high[1]:.6g} {wide:.6g} {tall:.6g}"
    inside = "".join(shapes)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="{view}" '
        f'style="max-width:100%;border:1px solid #8886"><g transform="scale(1 -1)">{inside}</g></svg>'
    )


def disc(place: Sequence[float], radius: float, fill: str, opacity: float = 1.0) -> str:
    """Draw a disc."""
    return f'<circle cx="{place[0]:.5g}" cy="{place[1]:.5g}" r="{radius:.5g}" fill="{fill}" fill-opacity="{opacity:g}"/>'


def box(low: Sequence[float], high: Sequence[float], stroke: str, opacity: float = 0.15) -> str:
    """Draw a box with a thin edge, whatever its size."""
    wide, tall = high[0] - low[0], high[1] - low[1]
    return (
        f'<rect x="{low[0]:.6g}" y="{low[1]:.6g}" width="{wide:.6g}" height="{tall:.6g}" fill="{stroke}" '
        f'fill-opacity="{opacity:g}" stroke="{stroke}" vector-effect="non-scaling-stroke"/>'
    )


def line(points: Iterable[Sequence[float]], stroke: str, opacity: float = 0.7) -> str:
    """Draw a thin line through points."""
    joined = " ".join(f"{x:.5g},{y:.5g}" for x, y, *_ in points)
    return (
        f'<polyline points="{joined}" fill="none" stroke="{stroke}" stroke-opacity="{opacity:g}" '
        'stroke-width="1.2" vector-effect="non-scaling-stroke"/>'
    )
