"""Glyphs: strings rasterised once by Pillow's FreeType into an atlas, from which the canvas draws them as sprites."""

import re
from functools import cache, lru_cache

import numpy as np

from render.raster import faces
from render.raster.shapes import NONE, Colour, sprites

WIDTH = 1024
GAP = 1


@lru_cache(4096)
def width(text: str, size: int, *, tabular: bool = False) -> int:
    """Measure a line of text [px]."""
    if tabular:
        return sum(_advance(each, size) for each in text)
    return round(faces.advance(faces.seen(text), size))


@cache
def _advance(letter: str, size: int) -> int:
    """Measure a letter of tabular text, as it is seen."""
    return round(faces.advance(letter, size))


def wrapped(text: str, size: int, room: int, lines: int) -> list[str]:
    """Break text into one to `lines` lines that fit into `room` pixels; what is left over ends in an ellipsis."""
    pieces = faces.breakable(text)
    out: list[str] = []
    while pieces and len(out) < lines:
        taken = 1
        while taken < len(pieces) and width("".join(pieces[: taken + 1]).rstrip(), size) <= room:
            taken += 1
        out.append("".join(pieces[:taken]).rstrip())
        pieces = pieces[taken:]
    if pieces:
        out[-1] += "…"
    return [_shortened(line, size, room) for line in out or [""]]


def _shortened(line: str, size: int, room: int) -> str:
    if width(line, size) <= room:
        return line
    while len(line) > 1 and width(line + "…", size) > room:
        line = line[:-1].rstrip(" …")
    return line + "…"


def _pieces(text: str, size: int) -> list[str]:
    """Take a line that is wider than the atlas word by word."""
    return [text] if faces.advance(text, size) <= WIDTH else re.findall(r"\S+\s*|\s+", text)


class Atlas:
    """What sprites and clouds take from.

    ink: the strings drawn so far, [y, x] of uint8; it grows downwards, so places stay valid.
    cells, texels: of the frame's clouds; numbers of texels, [cell] of int32, and these, [texel, 4] of float32: linear light
    times opacity, and opacity. Both have more room than they need.
    """

    def __init__(self, weight: float = 1.0):
        """Start empty. weight: power of the ink's coverage; below 1 makes type bolder."""
        self._weight = weight
        self.ink = np.zeros((64, WIDTH), np.uint8)
        self.cells, self.texels = np.zeros(1, np.int32), np.zeros((1, 4), np.float32)
        self._known: dict[tuple[str, int], tuple[int, ...]] = {}
        self._pen = [0, 0]  # where the next string goes
        self._shelf = 0  # height of the row being filled

    def take(self, cells: list[np.ndarray], texels: list[np.ndarray]) -> None:
        """Take over what the frame's clouds are made of, where that of the frame before was: see `cells`."""
        many, colours = sum(map(len, cells)), sum(map(len, texels))
        if many > len(self.cells):
            self.cells = np.zeros(many * 3 // 2, np.int32)
        if colours > len(self.texels):
            self.texels = np.zeros((colours * 3 // 2, 4), np.float32)
        np.concatenate(cells, out=self.cells[:many])
        np.concatenate(texels, out=self.texels[:colours])

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
        """Draw a line of text as sprites.

        at: x of its left edge, centre or right edge by `align`, and y of its baseline [px].
        tabular: give all digits one width, so that a running number stands still.
        spacing: extra pixels between letters.
        """
        text = faces.seen(text)
        pieces = list(text) if tabular or spacing else _pieces(text, size)
        advances = [
            _advance(each, size) + spacing if spacing or tabular else round(faces.advance(each, size)) for each in pieces
        ]
        total = sum(advances) - spacing
        x = round(at[0] - {"left": 0.0, "centre": 0.5, "right": 1.0}[align] * total)
        placed = []
        for piece, advance in zip(pieces, advances, strict=True):
            if piece.strip():
                left, top, wide, high, right, down = self._placed(piece, size)
                placed.append((left, top, wide, high, x + right, down))
            x += advance
        if not placed:
            return NONE
        numbers = np.array(placed, float)
        return sprites(numbers[:, 4:] + (0, round(at[1])), numbers[:, 2:4], numbers[:, :2], paint, alpha)

    def _placed(self, text: str, size: int) -> tuple[int, ...]:
        """Rasterise a string unless it is known: its place in the atlas, its size, its offset from the baseline; x before y."""
        key = (text, size)
        if key not in self._known:
            from PIL import Image, ImageDraw

            pieces, pen = [], 0.0
            for face, letters in faces.runs(text) or ((0, " "),):
                pieces.append((round(pen), faces.font(face, size), letters))
                pen += pieces[-1][1].getlength(letters)
            boxes = [face.getbbox(letters, anchor="ls") for _, face, letters in pieces]
            left, right = (
                int(edge(x + box[k] for (x, *_), box in zip(pieces, boxes, strict=True))) for edge, k in ((min, 0), (max, 2))
            )
            top, bottom = int(min(box[1] for box in boxes)), int(max(box[3] for box in boxes))
            image = Image.new("L", (min(right - left, WIDTH), bottom - top))
            for x, face, letters in pieces:
                ImageDraw.Draw(image).text((x - left, -top), letters, fill=255, font=face, anchor="ls")
            ink = np.round(255 * (np.asarray(image) / 255) ** self._weight)
            place = self._room(image.width, image.height)
            self.ink[place[1] : place[1] + image.height, place[0] : place[0] + image.width] = ink
            self._known[key] = (*place, *image.size, left, top)
        return self._known[key]

    def _room(self, wide: int, high: int) -> tuple[int, int]:
        """Find room for a string, in rows from top to bottom."""
        if self._pen[0] + wide > WIDTH:
            self._pen = [0, self._pen[1] + self._shelf + GAP]
            self._shelf = 0
        place = self._pen[0], self._pen[1]
        while place[1] + high > len(self.ink):
            self.ink = np.concatenate([self.ink, np.zeros_like(self.ink)])
        self._pen[0] += wide + GAP
        self._shelf = max(self._shelf, high)
        return place
