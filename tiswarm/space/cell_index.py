"""Cell index: which cell a position lies in, the cell's place in the table, and where images of a periodic world lie.

Cells are found in double precision: they then never shift against the reach, however far away.
"""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.lanes import larger, smaller
from tiswarm.simd.runtime import LANES, Func, Types
from tiswarm.space.box_lanes import adjacent
from tiswarm.space.cells import COUNT_X, MASK, PER_METRE, PERIOD, STRIDE_Y

FAR_CELL = 2.0**29
"""Cells beyond this one are one cell: whole numbers end soon after."""


@dataclass(frozen=True)
class CellIndex:
    """From positions to cells and their places."""

    cells_of: Func  # give the cell along each of three axes, 0 along one that the world does not have
    lane_cells: Func  # give the cells of lanes along an axis, as reals
    place_of: Func  # give the place of a position in its trial's table
    places_of: Func
    image_of: Func  # tell in which image of a periodic world a cell lies: -1, 0 or 1
    shift: Func  # give how far an image lies off [m]
    across: Func


def build(types: Types, dimensions: int, periodic: bool, hashed: bool, narrow: tuple[bool, ...]) -> CellIndex:
    """Build the funcs for a kind of grid."""
    real = types.real
    doubles, integers = ti.types.vector(LANES, ti.f64), ti.types.vector(LANES, ti.i32)

    @ti.func
    def possible(cell, axis: ti.template(), whole: ti.template()):
        """Give the nearest cell that the table knows, of one position or of lanes."""
        if ti.static(hashed):
            cell = smaller(larger(cell, -FAR_CELL), FAR_CELL)
        else:
            cell = smaller(larger(cell, 0.0), ti.cast(whole[COUNT_X + axis] - 1, ti.f64))
        return ti.floor(cell)

    @ti.func
    def cell_of(x, axis: ti.template(), whole: ti.template(), reals: ti.template()):
        """Give the cell along an axis."""
        return ti.cast(possible(ti.cast(x, ti.f64) * reals[PER_METRE + axis], axis, whole), ti.i32)

    @ti.func
    def cells_of(agent, whole: ti.template(), reals: ti.template()):
        """Give the cell along each of three axes, 0 along one that the world does not have."""
        return ti.Vector([cell_of(agent[k], k, whole, reals) for k in ti.static(range(dimensions))] + [0] * (3 - dimensions))

    @ti.func
    def place_of(p, whole: ti.template(), reals: ti.template()):
        """Give the place of a position in its trial's table."""
        place = cell_of(p[0], 0, whole, reals)
        for axis in ti.static(range(1, dimensions)):
            place += cell_of(p[axis], axis, whole, reals) * whole[STRIDE_Y + axis - 1]
        if ti.static(hashed):
            place = place & whole[MASK]
        return place

    @ti.func
    def lane_cells(x, axis: ti.template(), whole: ti.template(), reals: ti.template()):
        """Give the cells of lanes along an axis, as reals."""
        wide = doubles([ti.cast(x[lane], ti.f64) for lane in ti.static(range(LANES))])
        return possible(wide * reals[PER_METRE + axis], axis, whole)

    @ti.func
    def places_of(p, whole: ti.template(), reals: ti.template()):
        """Give the places of the positions of lanes; Taichi converts numbers one by one, LLVM puts them together again."""
        places = integers(0)
        for axis in ti.static(range(dimensions)):
            cell = lane_cells(p[axis], axis, whole, reals)
            along = integers([ti.cast(cell[lane], ti.i32) for lane in ti.static(range(LANES))])
            if ti.static(axis > 0):
                along *= whole[STRIDE_Y + axis - 1]
            places += along
        if ti.static(hashed):
            places = places & whole[MASK]
        return places

    @ti.func
    def image_of(cell, axis: ti.template(), whole: ti.template()):
        """Tell in which image of a periodic world a cell lies: -1, 0 or 1."""
        image = 0
        if ti.static(periodic):
            if cell < 0:
                image = -1
            elif cell >= whole[COUNT_X + axis]:
                image = 1
        return image

    @ti.func
    def shift(image, axis: ti.template(), reals: ti.template()):
        """Give how far an image lies off [m]."""
        return ti.cast(ti.cast(image, ti.f64) * reals[PERIOD + axis], real)

    @ti.func
    def across(difference, axis: ti.template(), reals: ti.template()):
        """Give the difference of two coordinates to the nearest image along a narrow axis; elsewhere images are walked."""
        if ti.static(narrow[axis]):
            difference = adjacent(difference, ti.cast(reals[PERIOD + axis], real))
        return difference

    return CellIndex(
        cells_of=cells_of,
        lane_cells=lane_cells,
        place_of=place_of,
        places_of=places_of,
        image_of=image_of,
        shift=shift,
        across=across,
    )
