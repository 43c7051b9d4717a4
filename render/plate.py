"""A plate: the bytes of one frame, which are drawn on again and again."""

import numpy as np


class Plate:
    """The bytes of one frame, with a note of the tiles in which they differ from the ground."""

    def __init__(self, length: int, tiles: int):
        """Allocate `length` bytes; nothing is known of them yet."""
        self.whole = np.ones(length + tiles, np.uint8)  # one array: each argument costs a kernel's launch some microseconds
        self.bytes, self.touched = self.whole[:length], self.whole[length:]
        self.ground = -1  # the number of the ground that they were drawn over
