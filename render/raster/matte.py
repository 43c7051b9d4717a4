"""A matte: shapes in, their colours and how opaque they are out, for pictures that have no ground of their own."""

import numpy as np

from render.raster.canvas import Canvas, Shapes
from render.raster.framebuffer import Framebuffer
from render.raster.glyphs import Atlas
from render.raster.shapes import PAINT, Colour, encoded, linear

BLOCK = 8
"""Edge of the squares [px] in which pixels that show nothing take the colour of what is near.

Whoever scales a picture, or halves its colours as video does, mixes them in."""

FINE = 1 << 14
"""Steps of the table that encodes light."""

ALIKE = 0.01
"""Squared distance of a colour from the ground below which its own opacity counts more than what it does to the ground."""

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)

LIGHT = 0.2
"""Grounds above this are light [linear]."""


_LIGHT = linear(np.arange(256) / 255).astype(np.float32)
_ENCODED = encoded(np.arange(FINE + 1) / FINE).astype(np.float32)


class Matte:
    """A picture without a ground, that shapes are drawn on again and again.

    They are drawn twice: on black as they are, and all white on black, which is how much of each pixel they cover; or, where
    the ground that is to be suited is light, all black on white, which is how much of it they leave: bytes tell dark from
    darker best. Both are light, but programs that lay pictures over each other mix encoded values. Opacities are such that
    over that ground this looks as the canvas would, and over others as near to that as one opacity for all channels can be.
    """

    def __init__(self, size: tuple[int, int], atlas: Atlas):
        """Make an empty one. size: width, height [px]. atlas: as for a canvas."""
        self.width, self.height = size
        self._atlas, self._plain = atlas, Atlas()
        self._canvases = Canvas(size, atlas, yuv=False), Canvas(size, self._plain, yuv=False)
        self._plates = [canvas.blank() for canvas in self._canvases]
        self._before: list[np.ndarray] = []  # their bytes of the frame before, none at first
        self._ground, self._papers = BLACK, (BLACK, BLACK)
        self._pixels = np.zeros((self.width * self.height, 4), np.uint8)  # those that show nothing are all zero
        self._across, self._down = -(-self.width // BLOCK), -(-self.height // BLOCK)
        self._sums = np.zeros((4, self._across * self._down))  # of each block: colours times opacities, and opacities

    def blank(self) -> Framebuffer:
        """Allocate the bytes of one frame: red, green, blue and opacity of each pixel, encoded, not multiplied."""
        return Framebuffer(self.width * self.height * 4, 0)

    def lay(self, colour: Colour, shapes: Shapes, windows: np.ndarray | None = None) -> None:
        """Take shapes that stand still. colour: linear light of the ground to suit. windows: as for a canvas."""
        self._suit(colour)
        for canvas, paper, rows in zip(self._canvases, self._papers, self._both(shapes), strict=True):
            canvas.lay(paper, rows, windows)

    def draw(self, shapes: Shapes, windows: np.ndarray | None, out: Framebuffer) -> np.ndarray:
        """Draw shapes above those that stand still, on a plate that `blank` allocated; return its bytes."""
        for canvas, rows, plate in zip(self._canvases, self._both(shapes), self._plates, strict=True):
            canvas.draw(rows, windows, plate)
        return self._joined(out)

    def fill(self, colour: Colour, shapes: Shapes, windows: np.ndarray | None, out: Framebuffer) -> np.ndarray:
        """Draw all anew, where nothing stands still; return the plate's bytes. colour: as in `lay`."""
        self._suit(colour)
        for canvas, paper, rows, plate in zip(self._canvases, self._papers, self._both(shapes), self._plates, strict=True):
            canvas.fill(paper, rows, windows, plate)
        return self._joined(out)

    def _suit(self, ground: Colour) -> None:
        self._ground, self._papers = ground, (BLACK, WHITE if sum(ground) / 3 > LIGHT else BLACK)

    def _both(self, shapes: Shapes) -> tuple[np.ndarray, np.ndarray]:
        """Give shapes as they are, and in white or black, as words and clouds in the other atlas are then, too."""
        ink = 1.0 - self._papers[1][0]
        self._plain.ink, self._plain.cells = self._atlas.ink, self._atlas.cells
        self._plain.texels = self._atlas.texels[:, 3:] * np.array((ink, ink, ink, 1.0), np.float32)
        whole = shapes if isinstance(shapes, np.ndarray) else np.concatenate(shapes)
        plain = whole.copy()
        plain[:, PAINT : PAINT + 3] = ink
        return whole, plain

    def _joined(self, out: Framebuffer) -> np.ndarray:
        """Find colours and opacities of the pixels that have changed, and fill what shows nothing."""
        changed = np.full(3 * self.width * self.height, not self._before)
        for plate, before in zip(self._plates, self._before, strict=False):
            changed |= plate.bytes != before
        self._before = [plate.bytes.copy() for plate in self._plates]
        at = np.flatnonzero(changed[::3] | changed[1::3] | changed[2::3])
        cover = np.abs(_LIGHT[self._plates[1].bytes[3 * at]] - np.float32(self._papers[1][0]))[:, None]
        light = np.minimum(_LIGHT[self._plates[0].bytes.reshape(-1, 3)[at]], cover)
        self._put(at, suited(light, cover, self._ground))
        whole, shown = out.bytes.view(np.uint32), self._pixels.view(np.uint32)[:, 0]
        whole.reshape(self.height, self.width)[:] = self._spread()
        np.copyto(whole, shown, where=shown != 0)
        return out.bytes

    def _put(self, at: np.ndarray, pixels: np.ndarray) -> None:
        """Replace pixels, and count them in their blocks."""
        block = at // self.width // BLOCK * self._across + at % self.width // BLOCK
        for some, sign in ((self._pixels[at], -1.0), (pixels, 1.0)):
            alpha = some[:, 3].astype(float)
            for c in range(4):
                weights = alpha if c == 3 else alpha * some[:, c]
                self._sums[c] += sign * np.bincount(block, weights, minlength=self._sums.shape[1])
        self._pixels[at] = pixels

    def _spread(self) -> np.ndarray:
        """Give each pixel the mean colour of what is near, or the ground's where nothing is, and no opacity."""
        padded = np.pad(self._sums.reshape(4, self._down, self._across), ((0, 0), (1, 1), (1, 1)))
        padded = padded[:, :-2] + padded[:, 1:-1] + padded[:, 2:]
        sums = padded[:, :, :-2] + padded[:, :, 1:-1] + padded[:, :, 2:]
        near = np.zeros((self._down, self._across, 4), np.uint8)
        near[..., :3] = np.round(255 * encoded(self._ground))
        known = sums[3] > 0
        near[known, :3] = np.round(sums[:3, known] / sums[3, known]).T
        rows = np.repeat(near.view(np.uint32)[..., 0], BLOCK, axis=1)[:, : self.width]
        return np.repeat(rows, BLOCK, axis=0)[: self.height]


def suited(light: np.ndarray, cover: np.ndarray, ground: Colour) -> np.ndarray:
    """Give bytes of colour and opacity [pixel, 4] that mix, encoded, over a ground as light does.

    light: [pixel, 3], linear, as much as there is over black. cover: [pixel, 1], from 0 to 1, at least the light.
    """
    under = encoded(ground).astype(np.float32)
    there = _curve(light + (1 - cover) * np.asarray(ground, np.float32)) - under
    own = _curve(light / np.maximum(cover, 1e-6)) - under
    alpha = ((there * own).sum(axis=1, keepdims=True) + ALIKE * cover) / ((own * own).sum(axis=1, keepdims=True) + ALIKE)
    least = np.where(there > 0, there / np.maximum(1 - under, 1e-3), -there / np.maximum(under, 1e-3))
    alpha = np.clip(np.maximum(alpha, least.max(axis=1, keepdims=True)), 0, 1)
    pixels = np.empty((len(light), 4), np.uint8)
    opacity = np.round(255 * alpha)
    pixels[:, 3] = opacity[:, 0]
    pixels[:, :3] = np.round(np.clip(255 * (under + there * (255 / np.maximum(opacity, 1))), 0, 255))
    pixels[opacity[:, 0] == 0] = 0
    return pixels


def _curve(light: np.ndarray) -> np.ndarray:
    """Encode light from 0 to 1."""
    return _ENCODED[(light * FINE + 0.5).astype(np.int32)]
