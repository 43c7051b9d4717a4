# mypy: disable-error-code="valid-type,index,operator"
"""Which tiles a shape touches: bounds in whole pixels, and for each tile the list of its shapes in drawing order."""

import taichi as ti

from render.raster.encode import TILE
from render.raster.shapes import ALPHA, BOUNDS, BOX, CAPSULE, CLOUD, DART, KIND, PLACE, QUAD, SIZE, SOFT, STROKE, TWEAK, WINDOW

HEAD = 8
"""Numbers ahead of the bins: width, height, shapes, mode, room for entries, windows, whether one thread does all, and whether
there is a cloud, which the kernel notes. Each argument costs a launch some time.

Behind it are where each tile's entries begin, and where the last ones end; for each part of the shapes a number for each tile;
then the entries: of each tile, in drawing order, the shapes that it shows."""

PARTS, FEW = 16, 1024
"""Shapes are listed side by side in so many parts at most, fewer where each would have less than FEW of them."""


def entries_from(tiles):
    """Give where entries begin, also inside kernels.

    Python's own: a `pyfunc` asks Taichi whether a kernel is built, which another thread may do just then.
    """
    return HEAD + 1 + (1 + PARTS) * tiles


entries_from._is_taichi_function = False  # type: ignore[attr-defined]  # a kernel may call it without a warning


@ti.func
def _fit(shapes: ti.template(), n: ti.i32, windows: ti.template()) -> ti.i32:
    """Store the whole-pixel bounds of shape n, cut to its window; tell whether anything of it can be seen."""
    ax, ay, bx, by = shapes[n, PLACE], shapes[n, PLACE + 1], shapes[n, PLACE + 2], shapes[n, PLACE + 3]
    p, q = shapes[n, SIZE], shapes[n, SIZE + 1]
    kind, window = ti.cast(shapes[n, KIND], ti.i32), ti.cast(shapes[n, WINDOW], ti.i32)
    around = shapes[n, SOFT] * ti.f32(0.5) + shapes[n, STROKE] + ti.f32(0.5)
    x0, y0, x1, y1 = ax, ay, ax, ay
    if kind == CAPSULE:
        x0, y0, x1, y1 = ti.min(ax, bx), ti.min(ay, by), ti.max(ax, bx), ti.max(ay, by)
        around += ti.max(p, q)
    elif kind == DART:
        around += ti.sqrt(p * p + q * q)
    elif kind == BOX:
        x0, y0, x1, y1 = ax - p, ay - q, ax + p, ay + q
    elif kind == QUAD:
        tweak, stroke, around = shapes[n, TWEAK], shapes[n, STROKE], ti.f32(1.0)
        x0, y0 = ti.min(ti.min(ax, bx), ti.min(p, tweak)), ti.min(ti.min(ay, by), ti.min(q, stroke))
        x1, y1 = ti.max(ti.max(ax, bx), ti.max(p, tweak)), ti.max(ti.max(ay, by), ti.max(q, stroke))
    else:
        x1, y1, around = ax + p, ay + q, ti.f32(0.0)
    x0, y0 = ti.max(ti.floor(x0 - around), windows[window, 0]), ti.max(ti.floor(y0 - around), windows[window, 1])
    x1, y1 = ti.min(ti.ceil(x1 + around), windows[window, 2]), ti.min(ti.ceil(y1 + around), windows[window, 3])
    shapes[n, BOUNDS], shapes[n, BOUNDS + 1], shapes[n, BOUNDS + 2], shapes[n, BOUNDS + 3] = x0, y0, x1, y1
    finite = (ax - ax) + (ay - ay) + (bx - bx) + (by - by) + (p - p) + (q - q) == ti.f32(0.0)
    inked = ti.max(shapes[n, ALPHA], shapes[n, ALPHA + 1]) > ti.f32(0.0)
    return ti.cast(finite and inked and x1 > x0 and y1 > y0, ti.i32)


@ti.func
def _corners(shapes: ti.template(), n: ti.i32):
    """Give the tiles that the bounds of shape n lie in: the first column and row, the last column and row."""
    left, top = ti.cast(shapes[n, BOUNDS], ti.i32) // TILE, ti.cast(shapes[n, BOUNDS + 1], ti.i32) // TILE
    right = (ti.cast(shapes[n, BOUNDS + 2], ti.i32) - 1) // TILE
    bottom = (ti.cast(shapes[n, BOUNDS + 3], ti.i32) - 1) // TILE
    return left, top, right, bottom


@ti.func
def tiles_of(bins: ti.template()):
    """Give how many tiles a frame has, in a row and in all."""
    across = (bins[0] + TILE - 1) // TILE
    return across, across * ((bins[1] + TILE - 1) // TILE)


@ti.func
def _parts(count: ti.i32) -> ti.i32:
    """Give in how many parts so many shapes are listed; no bit depends on it, for entries keep their order."""
    return ti.select(count > 0, ti.min(count // FEW + 1, PARTS), 0)


@ti.func
def _share(count: ti.i32, part: ti.i32):
    """Give the first shape of a part and the one past its last: none of parts that so few shapes do not need."""
    parts = ti.max(_parts(count), 1)
    return ti.min(count * part // parts, count), ti.min(count * (part + 1) // parts, count)


@ti.func
def count_shapes(shapes: ti.template(), windows: ti.template(), bins: ti.template(), part: ti.i32):
    """Find the bounds of a part of the shapes, and count how many of them each tile shows."""
    columns, tiles = tiles_of(bins)
    begin, end = _share(bins[2], part)
    own = HEAD + tiles + 1 + part * tiles
    if end > begin:
        for tile in range(tiles):
            bins[own + tile] = 0
    for n in range(begin, end):
        if shapes[n, KIND] == CLOUD:
            bins[7] = 1
        if _fit(shapes, n, windows):
            left, top, right, bottom = _corners(shapes, n)
            for row in range(top, bottom + 1):
                for column in range(left, right + 1):
                    bins[own + row * columns + column] += 1
        else:
            shapes[n, BOUNDS + 2] = ti.f32(-1.0)


@ti.func
def place_parts(bins: ti.template()):
    """Turn counts into places: where each tile's entries begin, and within them those of each part."""
    tiles = tiles_of(bins)[1]
    parts, total = _parts(bins[2]), 0
    for tile in range(tiles):
        bins[HEAD + tile] = total
        for part in range(parts):
            spot = HEAD + tiles + 1 + part * tiles + tile
            own = bins[spot]
            bins[spot] = total
            total += own
    bins[HEAD + tiles] = total


@ti.func
def list_shapes(shapes: ti.template(), bins: ti.template(), part: ti.i32):
    """Write the entries of a part of the shapes, in drawing order, where there is room for all."""
    columns, tiles = tiles_of(bins)
    begin, end = _share(bins[2], part)
    if bins[HEAD + tiles] > bins[4]:
        end = begin
    own, first = HEAD + tiles + 1 + part * tiles, entries_from(tiles)
    for n in range(begin, end):
        if shapes[n, BOUNDS + 2] >= ti.f32(0.0):
            left, top, right, bottom = _corners(shapes, n)
            for row in range(top, bottom + 1):
                for column in range(left, right + 1):
                    spot = own + row * columns + column
                    bins[first + bins[spot]] = n
                    bins[spot] += 1


@ti.func
def texels_along(at: ti.i32, origin: ti.f32, per: ti.f32, most: ti.f32) -> ti.f32:
    """Give where the middle of a pixel lies between a cloud's texels along an axis: those before and behind it.

    at: the pixel. origin: where the cloud begins [px]; per: cells a pixel; most: cells in all.
    """
    half = ti.f32(0.5)
    return ti.min(ti.max((ti.cast(at, ti.f32) + half - origin) * per, ti.f32(0.0)), most) + half


@ti.func
def _cloudy(shapes: ti.template(), n: ti.i32, cells: ti.template(), texels: ti.template(), x0: ti.i32, y0: ti.i32) -> ti.i32:
    """Tell whether anything of cloud n shows in a tile: most of many clouds is nothing, and need not be drawn."""
    ax, ay, per_x, per_y = shapes[n, PLACE], shapes[n, PLACE + 1], shapes[n, PLACE + 2], shapes[n, PLACE + 3]
    across, down = shapes[n, SIZE] * per_x, shapes[n, SIZE + 1] * per_y
    stride, begin = ti.cast(shapes[n, TWEAK], ti.i32), ti.cast(shapes[n, STROKE], ti.i32)
    left, top = ti.max(ti.cast(shapes[n, BOUNDS], ti.i32), x0), ti.max(ti.cast(shapes[n, BOUNDS + 1], ti.i32), y0)
    right = ti.min(ti.cast(shapes[n, BOUNDS + 2], ti.i32), x0 + TILE) - 1
    bottom = ti.min(ti.cast(shapes[n, BOUNDS + 3], ti.i32), y0 + TILE) - 1
    west, east = ti.cast(texels_along(left, ax, per_x, across), ti.i32), ti.cast(texels_along(right, ax, per_x, across), ti.i32)
    north, south = ti.cast(texels_along(top, ay, per_y, down), ti.i32), ti.cast(texels_along(bottom, ay, per_y, down), ti.i32)
    most = ti.f32(0.0)
    for row in range(north, south + 2):
        if most <= ti.f32(0.0):
            for at in range(begin + row * stride + west, begin + row * stride + east + 2):
                most = ti.max(most, texels[cells[at]][3])
    return ti.cast(most > ti.f32(0.0), ti.i32)


@ti.func
def rows(
    shapes: ti.template(),
    cells: ti.template(),
    texels: ti.template(),
    bins: ti.template(),
    first: ti.i32,
    entries: ti.i32,
    x0: ti.i32,
    y0: ti.i32,
):
    """Give the rows of a tile that its entries touch, in pairs, which share their chroma: the first and one past the last."""
    top, bottom = TILE, 0
    if bins[7] == 0:  # a loop of its own: thousands of shapes may lie in a tile
        for entry in range(first, first + entries):
            n = bins[entry]
            top = ti.min(top, ti.cast(shapes[n, BOUNDS + 1], ti.i32) - y0)
            bottom = ti.max(bottom, ti.cast(shapes[n, BOUNDS + 3], ti.i32) - y0)
    else:
        for entry in range(first, first + entries):
            n, seen = bins[entry], 1
            if shapes[n, KIND] == CLOUD:
                seen = _cloudy(shapes, n, cells, texels, x0, y0)
            if seen:
                top = ti.min(top, ti.cast(shapes[n, BOUNDS + 1], ti.i32) - y0)
                bottom = ti.max(bottom, ti.cast(shapes[n, BOUNDS + 3], ti.i32) - y0)
    return ti.max(top, 0) // 2, (ti.min(bottom, TILE) + 1) // 2
