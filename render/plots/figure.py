"""Figures: plots of studies and results, for papers and pages. Needs matplotlib (pip install "tiswarm[plot]")."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from render.raster import faces

OURS = "#0072B2"  # Okabe-Ito blue and vermilion: apart for every kind of colour vision, and in grey
PUBLISHED = "#D55E00"
INK = "#333333"
FAINT = "#8A8A8A"
GRID = "#DDDDDD"
DPI = 160


@contextmanager
def sheet(
    rows: int, columns: int, size: tuple[float, float], path: str | os.PathLike, title: str, note: str = ""
) -> Iterator[tuple[Any, Any]]:
    """Give a figure and its axes, [row, column], and write it as a PNG at the end; it appears whole or not at all.

    size: width and height [inches].
    """
    import matplotlib as mpl
    from matplotlib.font_manager import fontManager

    from tiswarm.system.files import replacing

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    for file in faces.FILES[1:]:
        fontManager.addfont(faces.FOLDER / file)
    style: Any = {
        "font.family": ["DejaVu Sans", "Noto Sans CJK SC"],
        "font.size": 9,
        "axes.edgecolor": INK,
        "text.color": INK,
        "axes.labelcolor": INK,
        "xtick.color": INK,
        "ytick.color": INK,
    }
    with plt.rc_context(style):
        figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")
        try:
            yield figure, axes
            figure.suptitle("\n".join(_written(line) for line in (title, note) if line), fontsize=11)
            with replacing(Path(path)) as part:
                figure.savefig(part, dpi=DPI, format="png")
        finally:
            plt.close(figure)


def _written(line: str) -> str:
    """Give a line as matplotlib wants it: from 3.11 on it joins letters and turns them round by itself."""
    import matplotlib as mpl

    return line if mpl.__version_info__ >= (3, 11) else faces.seen(line)
