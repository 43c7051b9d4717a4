"""A manuscript: an atlas that rasterises nothing and keeps what is to be written, word by word."""

from dataclasses import dataclass

import numpy as np

from render.raster import glyphs
from render.raster.glyphs import Atlas
from render.raster.shapes import NONE, Colour, sprites


@dataclass(frozen=True)
class Line:
    """A line of text: its words as they are read, its size [px], and what its place is: an edge, or its middle."""

    words: str
    size: int
    align: str


class Manuscript(Atlas):
    """Lines in place of sprites: each is one shape, whose place in the atlas is the number of its line."""

    def __init__(self) -> None:
        """Start with no lines."""
        super().__init__()
        self.lines: list[Line] = []

    def line(
        self,
        text: str,
        at: tuple[float, float],
        size: int,
        paint: Colour,
        alpha: float = 1.0,
        align: str = "left",
        *,
        tabular: bool = False,
        spacing: int = 0,
    ) -> np.ndarray:
        """Write a line, as `Atlas.line` draws it. Letters stand as their face has them: so words can be searched for."""
        if not text.strip():
            return NONE
        self.lines.append(Line(text, size, align))
        wide = glyphs.width(text, size, tabular=tabular) + spacing * len(text)
        return sprites(at, (wide, size), (len(self.lines) - 1, 0), paint, alpha)
