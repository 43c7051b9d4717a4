"""Cells: how a world is cut into boxes, and where each box has its place in a table.

Space is cut into boxes, half a reach wide along x and a reach along the other axes. A cell's place in the table is
x + stride_y y + stride_z z. Worlds with edges have a place for each cell. Open worlds take that sum modulo a power of two
above the number of agents, with strides such that the rows that one agent looks at lie far apart in the table: agents of
other rows may share a place, their distance tells them apart, and no agent is met twice.
"""

from dataclasses import dataclass
from math import floor, prod

from tiswarm.simd.runtime import LANES
from tiswarm.space import box
from tiswarm.space.box import Boundary

# What the head of a grid's whole numbers holds, before the sections of slots: sizes, and places as described above.
SLOTS, TRIALS, CHUNKS, CELLS, MASK, LONGEST, COUNT_X, COUNT_Y, COUNT_Z = range(9)
STRIDE_Y, STRIDE_Z, REACH_X, REACH_Y, REACH_Z, TABLE, ONE, SUMS = range(9, 17)
# What the head of its real numbers holds: cells per metre and the period, per axis.
PER_METRE, PERIOD = 0, 3

MOST_CHUNKS = 8
"""Each chunk of agents counts in a table of its own; more of them cost memory."""

HEAD = -(-(SUMS + MOST_CHUNKS) // LANES) * LANES  # what the parts of the tables sum up to, during a scan


@dataclass(frozen=True)
class Space:
    """A world: its size along each axis (two or three) [m], and what its edge does."""

    size: tuple[float, ...]
    boundary: Boundary

    @property
    def dimensions(self) -> int:
        """Count the axes."""
        return len(self.size)

    @property
    def wraps(self) -> bool:
        """Tell whether who leaves on one side comes back on the other."""
        return box.wraps(self.boundary)


@dataclass(frozen=True)
class CellGrid:
    """How a space is cut into cells, per axis; the last of the `cells` of a trial holds those who are gone.

    narrow: periodic axes less than three cells long; they have one cell, and images are compared pair by pair.
    """

    per_metre: tuple[float, ...]
    counts: tuple[int, ...]
    strides: tuple[int, ...]
    reach: tuple[int, ...]
    narrow: tuple[bool, ...]
    mask: int
    longest: int
    cells: int


def plan(space: Space, reach: float, count: int, epsilon: float) -> CellGrid:
    """Cut a space into cells for a number of agents, each of which sees as far as `reach` [m].

    epsilon: relative spacing of the reals that positions are stored in; cells are wider by what rounding may shift.
    """
    if not reach > 0:
        raise ValueError(f"reach: {reach} is not possible; use a positive number")
    if reach == float("inf"):
        return _everybody(space)
    wide = reach * (1 + 1e-5 + 16 * epsilon)
    most = 4 * count + 64
    sparse = prod(max(1, side / wide) for side in space.size) > most
    if not box.bounded(space.boundary) or (sparse and not space.wraps):
        return _hashed(space.dimensions, wide, count)
    widths = [wide / 2] + [wide] * (space.dimensions - 1)
    excess = prod(max(1.0, side / width) for side, width in zip(space.size, widths, strict=True)) / most
    while excess > 1:  # a sparse world has few, large cells
        widths = [width * max(excess ** (1 / space.dimensions), 1.01) for width in widths]
        excess = prod(max(1.0, side / width) for side, width in zip(space.size, widths, strict=True)) / most
    counts = [max(1, floor(side / width)) for side, width in zip(space.size, widths, strict=True)]
    reaches = [1 if side >= wide * number else 2 for side, number in zip(space.size, counts, strict=True)]
    narrow = [space.wraps and number < 2 * k + 1 for number, k in zip(counts, reaches, strict=True)]
    counts = [1 if thin else number for number, thin in zip(counts, narrow, strict=True)]
    reaches = [0 if number == 1 else k for number, k in zip(counts, reaches, strict=True)]
    return CellGrid(
        per_metre=tuple(number / side for number, side in zip(counts, space.size, strict=True)),
        counts=tuple(counts),
        strides=tuple(prod(counts[:axis]) for axis in range(1, space.dimensions)),
        reach=tuple(reaches),
        narrow=tuple(narrow),
        mask=-1,
        longest=counts[0] if space.wraps and not narrow[0] else 2**30,
        cells=prod(counts) + 1,
    )


def _everybody(space: Space) -> CellGrid:
    """Plan one cell, so that everybody meets everybody."""
    ones = (1,) * space.dimensions
    narrow = (space.wraps,) * space.dimensions
    return CellGrid((0.0,) * space.dimensions, ones, ones[1:], (0,) * space.dimensions, narrow, mask=-1, longest=2**30, cells=2)


def _hashed(dimensions: int, wide: float, count: int) -> CellGrid:
    """Plan a table for a world without end: rows start at multiples of an irrational share of it."""
    size = 1 << max(6 if dimensions == 2 else 9, (2 * count - 1).bit_length())
    shares = [0.6180339887498949] if dimensions == 2 else [0.7548776662466927, 0.5698402909980532]
    strides = [int(share * size) | 1 for share in shares]
    steps = range(-2, 3)
    rows = [(a, b) for a in steps for b in (steps if dimensions == 3 else (0,)) if (a, b) != (0, 0)]
    offsets = [(a * strides[0] + b * strides[-1]) % size for a, b in rows]
    return CellGrid(
        per_metre=(2 / wide,) + (1 / wide,) * (dimensions - 1),
        counts=(size,) * dimensions,
        strides=tuple(strides),
        reach=(2,) + (1,) * (dimensions - 1),
        narrow=(False,) * dimensions,
        mask=size - 1,
        longest=min(min(offset, size - offset) for offset in offsets),
        cells=size + 1,
    )
