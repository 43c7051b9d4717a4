"""A canvas: shapes in, the bytes of a frame out, again and again over the same ground."""

from collections.abc import Sequence

import numpy as np

from render.raster.encode import AREA, LANES, TILE
from render.raster.framebuffer import EVERYWHERE, Framebuffer
from render.raster.glyphs import Atlas
from render.raster.kernel import CHUNKS, CONSTANTS, LAY, OVER, WHOLE, paint
from render.raster.matte import NOTES, SIDE
from render.raster.painter import SCRATCH
from render.raster.shapes import COLUMNS, Colour
from render.raster.tiles import HEAD, entries_from
from tiswarm.simd import launch, runtime

ROOM = 1024
"""So many shapes have room at first."""

Shapes = np.ndarray | Sequence[np.ndarray]
"""Rows of shapes, or several arrays of them, drawn one after the other."""


class Canvas:
    """A picture of one size that shapes are drawn on, again and again over the same ground."""

    def __init__(self, size: tuple[int, int], atlas: Atlas, *, yuv: bool, clear: bool = False):
        """Make a black canvas.

        size: width, height [px]; both even when `yuv`.
        atlas: the ink that sprites take from.
        yuv: write planar 4:2:0 for an encoder, else RGB.
        clear: write, as RGBA, shapes without a ground, which only suit the colour that is given as that.
        """
        runtime.start()
        self.width, self.height = size
        self.yuv, self.clear = yuv, clear
        self._atlas = atlas
        self._tiles = -(-self.width // TILE) * -(-self.height // TILE)
        self._bins = np.zeros(entries_from(self._tiles) + 2 * self._tiles, np.int32)
        self._light = runtime.aligned((self._tiles * (4 if clear else 3) * AREA, LANES), np.float32)
        self._lanes = runtime.aligned((CONSTANTS + CHUNKS * SCRATCH, LANES), np.float32)
        self._numbers = self._lanes.reshape(-1)
        self._lanes[0] = np.arange(LANES)
        self._lanes[1:CONSTANTS] = _bayer(4).reshape(AREA, LANES)
        self._frame = np.array([[0, 0, *size]], np.float32)
        self._rows = np.zeros((ROOM, COLUMNS), np.float32)
        self._edges = np.zeros((0, 4), np.float32)
        self._grounds, self._colour = 0, (0.0, 0.0, 0.0)

    def blank(self) -> Framebuffer:
        """Allocate the bytes of one frame."""
        pixels = self.width * self.height
        if self.clear:
            return Framebuffer(pixels * 4, self._tiles, self._tiles * SIDE * SIDE * NOTES)
        return Framebuffer(pixels * 3 // 2 if self.yuv else pixels * 3, self._tiles)

    def lay(self, colour: Colour, shapes: Shapes, windows: np.ndarray | None = None) -> None:
        """Make the ground that frames start from: a colour (linear light) and shapes that stand still.

        windows: [window, 4], what shapes are cut to, by the number that each names: x0, y0, x1, y1 [px]; the frame when None.
        """
        self._grounds, self._colour = self._grounds + 1, colour
        self._run(LAY, shapes, windows, self.blank(), colour)

    def draw(self, shapes: Shapes, windows: np.ndarray | None, out: Framebuffer) -> np.ndarray:
        """Draw shapes over the ground on a plate that `blank` allocated; return its bytes. windows: as in `lay`.

        Only what differs from what the plate shows is painted: a plate that is used again is faster than a new one.
        """
        if out.ground != self._grounds:
            out.touched[:] = EVERYWHERE
        self._run(OVER, shapes, windows, out, self._colour)
        out.ground = self._grounds
        return out.bytes

    def fill(self, colour: Colour, shapes: Shapes, windows: np.ndarray | None, out: Framebuffer) -> np.ndarray:
        """Draw all anew, a colour and shapes over it, where no ground stands still; return the plate's bytes."""
        self._run(WHOLE, shapes, windows, out, colour)
        out.ground = -1
        return out.bytes

    def light(self) -> np.ndarray:
        """Give the ground of a canvas that is not clear in linear light: [y, x, channel]."""
        columns = -(-self.width // TILE)
        tiled = self._light.reshape(-1, columns, 3, TILE, TILE)
        return tiled.transpose(0, 3, 1, 4, 2).reshape(-1, columns * TILE, 3)[: self.height, : self.width]

    def _run(self, mode: int, shapes: Shapes, windows: np.ndarray | None, out: Framebuffer, colour: Colour) -> None:
        windows = self._frame if windows is None else windows
        parts = [shapes] if isinstance(shapes, np.ndarray) else shapes
        count = sum(map(len, parts))
        if count > len(self._rows):
            self._rows = np.zeros((count * 3 // 2, COLUMNS), np.float32)
        np.concatenate(parts, out=self._rows[:count])
        if len(self._edges) != len(windows) + 1:
            self._edges = np.zeros((len(windows) + 1, 4), np.float32)
        self._edges[:-1], self._edges[-1, :3] = windows, colour
        while True:
            room = len(self._bins) - entries_from(self._tiles)
            self._bins[:HEAD] = self.width, self.height, count, mode, room, len(windows), out.calm, 0
            self._launch(out)
            needed = int(self._bins[HEAD + self._tiles])
            if needed <= room:
                return
            self._bins = np.zeros(entries_from(self._tiles) + needed * 3 // 2, np.int32)

    def _launch(self, out: Framebuffer) -> None:
        """Paint on a plate; what describes the launch is kept with it, for as long as the arrays are these."""
        taken = self._atlas.ink, self._atlas.cells, self._atlas.texels
        arrays = self._rows, self._edges, *taken, self._bins, self._light, self._lanes, self._numbers, out.whole, out.blocks
        if out.launch is None or any(new is not old for new, old in zip(arrays, out.arrays, strict=True)):
            out.arrays, out.launch = arrays, launch.prepared(paint, *arrays, self.yuv, self.clear, precision=None)
        out.launch()


def _bayer(order: int) -> np.ndarray:
    """Build the ordered dither pattern of edge 2**order with values in 0..1."""
    pattern = np.zeros((1, 1))
    for _ in range(order):
        pattern = np.block([[4 * pattern, 4 * pattern + 2], [4 * pattern + 3, 4 * pattern + 1]])
    return (pattern + 0.5) / pattern.size
