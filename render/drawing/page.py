"""A page of vectors, which matplotlib (extra `plot`) writes as PDF or SVG: shapes as paths, words as text to be searched."""

import base64
import unicodedata
import warnings
from collections.abc import Iterator, Sequence
from io import BytesIO
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from render.drawing.manuscript import Line, Manuscript
from render.drawing.outlines import Mark, outlined
from render.raster import faces
from render.raster.shapes import ALPHA, CLOUD, KIND, PAINT, PLACE, SIZE, SPRITE, STROKE, TWEAK, WINDOW, encoded
from tiswarm.system.extras import needed

FAMILY = ["Aileron", "Helvetica", "Arial", "DejaVu Sans", "Noto Sans CJK SC", "sans-serif"]
"""Faces of an SVG's words: the films' own, which lies in the file, and those that readers are likely to have."""

FINER = 4
"""So many pixels across make a cell of a cloud, which is the one thing on a page that is no vector."""

STYLE: dict[Any, Any] = {
    "pdf.fonttype": 42,  # letters stay letters
    "svg.fonttype": "none",
    "svg.hashsalt": "tiswarm",  # the same page has the same bytes
    "path.simplify": False,
    "pdf.compression": 9,
}


class Page:
    """A page of some size [px], of which each makes `scale` points."""

    def __init__(
        self, size: tuple[int, int], scale: float, manuscript: Manuscript, backdrop: Sequence[float] | None, kind: str
    ):
        """Begin it. backdrop: linear light; None for no ground. kind: "pdf" or "svg". Errors: MissingExtra."""
        needed("plot", "matplotlib")
        from matplotlib.figure import Figure

        self._size, self._scale, self._manuscript, self._kind = size, scale, manuscript, kind
        points = size[0] * scale, size[1] * scale
        paper = "none" if backdrop is None else tuple(encoded(backdrop))
        self._figure = Figure(figsize=(points[0] / 72, points[1] / 72), dpi=72, facecolor=paper)
        self._axes = self._figure.add_axes((0, 0, 1, 1), xlim=(0, points[0]), ylim=(0, points[1]))
        self._axes.set_axis_off()
        self._above = 0

    def draw(self, rows: np.ndarray, windows: np.ndarray, ground: np.ndarray) -> None:
        """Draw shapes. windows: as for a canvas. ground: what lies under most of them, linear light."""
        kinds = np.where(rows[:, KIND] == SPRITE, 1, np.where(rows[:, KIND] == CLOUD, 2, 0))
        runs = np.flatnonzero(np.diff(kinds, prepend=-1) | np.diff(rows[:, WINDOW], prepend=-1).astype(int))
        for start, end in zip(runs, np.append(runs[1:], len(rows)), strict=True):
            some, window = rows[start:end], windows[int(rows[start, WINDOW])]
            if kinds[start] == 1:
                for row in some:
                    self._write(self._manuscript.lines[int(row[PLACE + 2])], row)
            elif kinds[start] == 2:
                for row in some:
                    self._cloud(row, window)
            else:
                self._paths(outlined(some[np.isfinite(some).all(axis=1)], ground), window)

    def save(self, part: Path, about: dict[str, str]) -> None:
        """Write the page. about: its title and what it comes from."""
        import matplotlib as mpl

        if self._kind == "pdf":
            notes: dict[str, Any] = {"Title": about["title"], "Subject": about["comment"], "Author": about["artist"]}
            notes |= {"CreationDate": None}
        else:
            notes = {"Title": about["title"], "Description": about["comment"], "Creator": about["artist"], "Date": None}
        written = BytesIO()
        with mpl.rc_context(STYLE), warnings.catch_warnings():
            if self._kind == "svg":  # whose words are laid out by who shows them, in faces that matplotlib need not have
                warnings.filterwarnings("ignore", "Glyph .* missing from font")
            self._figure.savefig(written, format=self._kind, metadata=notes, facecolor=self._figure.get_facecolor())
        whole = written.getvalue()
        if self._kind == "svg":
            font = base64.b64encode(_face(0).read_bytes())
            face = b"<style>@font-face{font-family:'Aileron';src:url(data:font/ttf;base64," + font + b")}</style>\n <defs>"
            whole = whole.replace(b"<defs>", face, 1)
        part.write_bytes(whole)

    def _place(self, points: np.ndarray) -> np.ndarray:
        """Turn pixels, y downwards, into points, y upwards."""
        return np.round((points * (1, -1) + (0, self._size[1])) * self._scale, 2)

    def _add(self, artist: Any, window: np.ndarray | None = None) -> None:
        """Put something above all that is there, cut to a window."""
        from matplotlib.transforms import Bbox

        self._above += 1
        artist.set_zorder(self._above)
        self._axes.add_artist(artist)
        artist.set_clip_path(None)
        if window is not None:
            low, high = self._place(window[[0, 3]]), self._place(window[[2, 1]])
            artist.set_clip_box(Bbox([low, high]))
        artist.set_clip_on(window is not None)

    def _paths(self, marks: list[Mark], window: np.ndarray) -> None:
        from matplotlib.collections import PathCollection
        from matplotlib.path import Path as Curve
        from matplotlib.transforms import IdentityTransform

        for lines, group in groupby(_seen(marks, window), key=lambda mark: mark.width > 0):
            some = list(group)
            curves = [Curve(self._place(mark.points), mark.codes) for mark in some]
            paints = np.array([(*mark.paint, round(mark.alpha, 2)) for mark in some])
            widths = np.round([mark.width * self._scale for mark in some], 2)
            look: dict[str, Any] = {"facecolors": paints, "edgecolors": "none", "linewidths": 0}
            if lines:
                look = {"facecolors": "none", "edgecolors": paints, "linewidths": widths, "capstyle": "round"}
            self._add(PathCollection(curves, transform=IdentityTransform(), joinstyle="round", **look), window)

    def _write(self, line: Line, row: np.ndarray) -> None:
        from matplotlib.font_manager import FontProperties
        from matplotlib.text import Text

        x, y = self._place(row[PLACE : PLACE + 2].astype(float))
        paint, align = (*encoded(row[PAINT : PAINT + 3]), float(row[ALPHA])), line.align.replace("centre", "center")
        pieces = [(max((face for face, _ in faces.runs(faces.seen(line.words))), default=0), line.words, 0.0)]
        if self._kind == "pdf":  # its letters come in the order in which they are seen, and each face by itself
            pieces, align = _pieces(line), "left"
            x -= {"left": 0.0, "centre": 0.5, "right": 1.0}[line.align] * _extent(line) * self._scale
        for face, words, along in pieces:
            font = FontProperties(family=FAMILY, size=line.size * self._scale, fname=_face(face))
            text = Text(
                x + along * self._scale, y, words, color=paint, fontproperties=font, ha=align, va="baseline", parse_math=False
            )
            self._add(text)

    def _cloud(self, row: np.ndarray, window: np.ndarray) -> None:
        """Draw a cloud as a picture with a few pixels for each of its cells."""
        from matplotlib.image import AxesImage
        from PIL import Image

        stride, first = int(row[TWEAK]), int(row[STROKE])
        extent = row[SIZE : SIZE + 2].astype(float)
        down = round(float(row[PLACE + 3]) * extent[1])
        cells = self._manuscript.cells[first : first + (down + 2) * stride].reshape(down + 2, stride)
        texels = self._manuscript.texels[cells]
        layers = []
        for n in range(4):
            layer = Image.fromarray(texels[..., n].astype(np.float32))
            fine = layer.resize((FINER * stride, FINER * (down + 2)), Image.Resampling.BILINEAR)
            layers.append(np.asarray(fine)[FINER:-FINER, FINER:-FINER])
        alpha = np.clip(layers[3], 0, 1)
        light = np.stack(layers[:3], axis=-1) / np.maximum(alpha, 1e-4)[..., None]
        bytes_ = np.round(255 * np.concatenate([encoded(np.clip(light, 0, 1)), alpha[..., None]], axis=-1)).astype(np.uint8)
        low = row[PLACE : PLACE + 2].astype(float)
        left, top = self._place(low)
        right, bottom = self._place(low + extent)
        image = AxesImage(self._axes, extent=(left, right, bottom, top), interpolation="none", origin="upper")
        image.set_data(bytes_)
        self._add(image, window)


def _seen(marks: list[Mark], window: np.ndarray) -> Iterator[Mark]:
    """Leave out what lies beyond a window."""
    for mark in marks:
        low, high = mark.points.min(axis=0) - mark.width, mark.points.max(axis=0) + mark.width
        if (high > window[:2]).all() and (low < window[2:]).all():
            yield mark


def _pieces(line: Line) -> list[tuple[int, str, float]]:
    """Part a line, as it is seen, by its faces, and give where each begins [px]; letters that are turned round stand alone."""
    shown, pieces, along = faces.seen(line.words), [], 0.0
    turned = shown != line.words
    for face, letters in faces.runs(shown):
        for piece in _clusters(letters) if turned else [letters]:
            pieces.append((face, piece, along))
            along += faces.font(face, line.size).getlength(piece)
    return pieces


def _clusters(letters: str) -> list[str]:
    """Part turned letters, each with its marks behind it: turned they come before it, and alone they get a dotted ring."""
    found, marks = [], ""
    for letter in letters:
        if unicodedata.category(letter) == "Mn":
            marks += letter
        else:
            found.append(letter + marks)
            marks = ""
    return found + [marks] * bool(marks)


def _extent(line: Line) -> float:
    return faces.advance(faces.seen(line.words), line.size)


def _face(face: int) -> Path:
    """Give the file of a face: Aileron's own for what Pillow carries of it within itself."""
    return faces.FOLDER / (faces.FILES[face] or "Aileron.ttf")
