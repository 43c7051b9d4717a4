"""Framebuffer: the bytes of one frame, which are drawn on again and again."""

from collections.abc import Callable

import numpy as np

EVERYWHERE = 0 + 8 * 9
"""A note of rows: the first pair of them, and nine times the pair past the last one; here all eight pairs of a tile."""


class Framebuffer:
    """The bytes of one frame, with a note of the rows of each tile in which they may differ from the ground."""

    def __init__(self, length: int, tiles: int, blocks: int = 1):
        """Allocate `length` bytes; nothing is known of them yet. blocks: numbers to note what shows nothing by."""
        self.whole = np.zeros(length + tiles, np.uint8)  # one array: each argument costs a kernel's launch some microseconds
        self.bytes, self.touched = self.whole[:length], self.whole[length:]
        self.touched[:] = EVERYWHERE
        self.blocks = np.zeros(blocks, np.int32)
        self.calm = False  # whether nobody waits for them: then one thread draws, and leaves the others to the encoder
        self.ground = -1  # the number of the ground that they were drawn over
        self.arrays: tuple[np.ndarray, ...] = ()  # what they were drawn with, and what draws with these again
        self.launch: Callable[[], None] | None = None
