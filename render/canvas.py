"""A canvas: shapes in, the bytes of a frame out, again and again over the same ground."""

import numpy as np

from render.raster import AREA, CHUNKS, CONSTANTS, LANES, PLANES, TILE, paint
from render.shapes import BOUNDS, COLUMNS, Colour, clipped
from render.text import Atlas
from tiswarm import runtime


class Canvas:
    """A picture of one size that shapes are drawn on, again and again over the same ground."""

    def __init__(self, size: tuple[int, int], atlas: Atlas, *, yuv: bool):
        """Make a black canvas.

        size: width, height [px]; both even when `yuv`.
        atlas: the ink that sprites take from.
        yuv: write planar 4:2:0 for an encoder, else RGB.
        """
        runtime.start()
        self.width, self.height = size
        self.yuv = yuv
        self._atlas = atlas
        self._tiles = -(-self.width // TILE) * -(-self.height // TILE)
        self._bins = np.zeros(2 * self._tiles, np.int32)
        self._light = runtime.aligned((self._tiles * 3 * AREA, LANES), np.float32)
        self._lanes = runtime.aligned((CONSTANTS + CHUNKS * PLANES * AREA, LANES), np.float32)
        self._lanes[0] = np.arange(LANES)
        self._lanes[1:CONSTANTS] = _bayer(4).reshape(AREA, LANES)
        self._ground = self.blank()
        self._frame = np.array([0, 0, *size], np.float32)

    def blank(self) -> np.ndarray:
        """Allocate the bytes of one frame."""
        pixels = self.width * self.height
        return np.zeros(pixels * 3 // 2 if self.yuv else pixels * 3, np.uint8)

    def lay(self, colour: Colour, shapes: np.ndarray, windows: np.ndarray | None = None) -> None:
        """Make the ground that frames start from: a colour (linear light) and shapes that stand still.

        windows: [shape, 4], what each shape is cut to: x0, y0, x1, y1 [px].
        """
        self._light.reshape(self._tiles, 3, -1)[:] = np.reshape(colour, (3, 1))
        self._run(shapes, windows, self._ground, laying=True)

    def draw(self, shapes: np.ndarray, windows: np.ndarray | None, out: np.ndarray) -> np.ndarray:
        """Draw shapes over the ground into the bytes of a frame, which `blank` allocated; return them. windows: as in `lay`."""
        np.copyto(out, self._ground)
        self._run(shapes, windows, out, laying=False)
        return out

    def light(self) -> np.ndarray:
        """Give the ground in linear light: [y, x, channel]."""
        columns = -(-self.width // TILE)
        tiled = self._light.reshape(-1, columns, 3, TILE, TILE)
        return tiled.transpose(0, 3, 1, 4, 2).reshape(-1, columns * TILE, 3)[: self.height, : self.width]

    def _run(self, shapes: np.ndarray, windows: np.ndarray | None, out: np.ndarray, *, laying: bool) -> None:
        shapes = clipped(shapes, self._frame if windows is None else windows)
        boxes = shapes[:, BOUNDS : BOUNDS + 4].astype(np.int32)
        spans = (boxes[:, 2:] - 1) // TILE - boxes[:, :2] // TILE + 1
        room = self._tiles + 2 + int((spans[:, 0] * spans[:, 1]).sum())
        if room > self._bins.size:
            self._bins = np.zeros(room * 3 // 2, np.int32)
        count = len(shapes)
        if not count:  # an empty array is no kernel argument
            shapes = np.zeros((1, COLUMNS), np.float32)
        numbers = self._lanes.reshape(-1)
        paint(
            shapes,
            count,
            self._atlas.ink,
            self._bins,
            self._light,
            self._lanes,
            numbers,
            out,
            self.width,
            self.height,
            int(laying),
            self.yuv,
        )


def _bayer(order: int) -> np.ndarray:
    """Build the ordered dither pattern of edge 2**order with values in 0..1."""
    pattern = np.zeros((1, 1))
    for _ in range(order):
        pattern = np.block([[4 * pattern, 4 * pattern + 2], [4 * pattern + 3, 4 * pattern + 1]])
    return (pattern + 0.5) / pattern.size
