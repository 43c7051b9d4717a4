# mypy: disable-error-code="valid-type,index,operator"
"""Which tiles a shape touches: bounds in whole pixels, and for each tile the list of its shapes in drawing order."""

import taichi as ti

from render.raster.encode import TILE
from render.raster.shapes import ALPHA, BOUNDS, BOX, CAPSULE, DART, KIND, PLACE, QUAD, SIZE, SOFT, STROKE, TWEAK, WINDOW

HEAD = 8
"""Numbers ahead of the bins: width, height, shapes, mode, room for entries, windows. Each argument costs a launch some time."""


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
def bin_shapes(shapes: ti.template(), windows: ti.template(), bins: ti.template(), columns: ti.i32, tiles: ti.i32):
    """List for each tile, in drawing order, the shapes that it shows: after the head, starts of the tiles, end, entries."""
    count = bins[2]
    for tile in range(tiles + 1):
        bins[HEAD + tile] = 0
    for n in range(count):
        if _fit(shapes, n, windows):
            left, top = ti.cast(shapes[n, BOUNDS], ti.i32) // TILE, ti.cast(shapes[n, BOUNDS + 1], ti.i32) // TILE
            right = (ti.cast(shapes[n, BOUNDS + 2], ti.i32) - 1) // TILE
            bottom = (ti.cast(shapes[n, BOUNDS + 3], ti.i32) - 1) // TILE
            for row in range(top, bottom + 1):
                for column in range(left, right + 1):
                    bins[HEAD + row * columns + column] += 1
        else:
            shapes[n, BOUNDS + 2] = ti.f32(-1.0)
    for tile in range(tiles):
        bins[HEAD + tile + 1] += bins[HEAD + tile]
    if bins[HEAD + tiles] <= bins[4]:
        for back in range(count):
            n = count - 1 - back
            if shapes[n, BOUNDS + 2] >= ti.f32(0.0):
                left, top = ti.cast(shapes[n, BOUNDS], ti.i32) // TILE, ti.cast(shapes[n, BOUNDS + 1], ti.i32) // TILE
                right = (ti.cast(shapes[n, BOUNDS + 2], ti.i32) - 1) // TILE
                bottom = (ti.cast(shapes[n, BOUNDS + 3], ti.i32) - 1) // TILE
                for row in range(top, bottom + 1):
                    for column in range(left, right + 1):
                        tile = HEAD + row * columns + column
                        bins[tile] -= 1
                        bins[HEAD + tiles + 1 + bins[tile]] = n


@ti.func
def rows(shapes: ti.template(), bins: ti.template(), first: ti.i32, entries: ti.i32, y0: ti.i32):
    """Give the rows of a tile that its entries touch, in pairs, which share their chroma: the first and one past the last."""
    top, bottom = TILE, 0
    for entry in range(first, first + entries):
        n = bins[entry]
        top = ti.min(top, ti.cast(shapes[n, BOUNDS + 1], ti.i32) - y0)
        bottom = ti.max(bottom, ti.cast(shapes[n, BOUNDS + 3], ti.i32) - y0)
    return ti.max(top, 0) // 2, (ti.min(bottom, TILE) + 1) // 2
