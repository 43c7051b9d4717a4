# mypy: disable-error-code="valid-type,index,operator"
"""Rasterise shapes in linear light with Taichi kernels: signed distance, analytic coverage, one thread per tile.

A tile is painted in scratch memory that stays in the nearest cache, eight pixels of a row at a time (lanes), then encoded into
the bytes of the frame. Only rows of tiles that a shape touches, or that one touched when the same bytes were drawn on last,
are painted: all others show the ground already. Lanes know no unary minus, no `abs` and no casts under this project's compiler
settings (CONTRIBUTING): what needs one is done on plain numbers, through a second view of the scratch memory.
"""

import taichi as ti

from render.distance import coverage, larger, smaller
from render.pixels import ACROSS, AREA, LANES, TILE, encoded, write_rgb, write_yuv
from render.shapes import (
    ALPHA,
    BOUNDS,
    BOX,
    CAPSULE,
    DART,
    GROUP,
    KIND,
    PAINT,
    PLACE,
    QUAD,
    SIZE,
    SOFT,
    SPRITE,
    STROKE,
    TWEAK,
    WINDOW,
)
from tiswarm import runtime

CHUNKS = 32
"""Tiles are dealt to threads in this many interleaved sets, so that a crowded corner is shared."""

MASK = 3  # plane of joined coverage in the scratch memory, after linear red, green and blue
PLANES = 4
CONSTANTS = 1 + AREA  # lanes ahead of the planes: 0 1 2 .. 7, then the dither pattern

OVER, LAY, WHOLE = 0, 1, 2
"""Paint over the ground; paint all and keep it as the ground; paint all and keep nothing."""

HEAD = 8
"""Numbers ahead of the bins: width, height, shapes, mode, room for entries, windows. Each argument costs a launch some time."""

_TASK = runtime.TASK
_LANE = ti.types.vector(LANES, ti.f32)
_Lanes = ti.types.ndarray(dtype=_LANE, ndim=1)
_Numbers = ti.types.ndarray(dtype=ti.f32, ndim=1)
_Bytes = ti.types.ndarray(dtype=ti.u8, ndim=1)


@ti.func
def _blend(lanes: ti.template(), spot: ti.i32, red: ti.f32, green: ti.f32, blue: ti.f32, cover):
    old_red, old_green, old_blue = lanes[spot], lanes[spot + AREA], lanes[spot + 2 * AREA]
    lanes[spot] = old_red + cover * (red - old_red)
    lanes[spot + AREA] = old_green + cover * (green - old_green)
    lanes[spot + 2 * AREA] = old_blue + cover * (blue - old_blue)


@ti.func
def _paint_sprite(
    shapes: ti.template(),
    n: ti.i32,
    atlas: ti.template(),
    numbers: ti.template(),
    place: ti.i32,
    left,
    top,
    right,
    bottom,
    x0,
    y0,
):
    """Blend a piece of the atlas; `place` is the tile's first number in the scratch memory."""
    shift_x = ti.cast(shapes[n, PLACE + 2] - shapes[n, PLACE], ti.i32)
    shift_y = ti.cast(shapes[n, PLACE + 3] - shapes[n, PLACE + 1], ti.i32)
    for y in range(top, bottom):
        for x in range(left, right):
            cover = ti.cast(atlas[y + shift_y, x + shift_x], ti.f32) * (ti.f32(1.0 / 255.0) * shapes[n, ALPHA])
            for c in range(3):
                spot = place + c * TILE * TILE + (y - y0) * TILE + x - x0
                numbers[spot] += (shapes[n, PAINT + c] - numbers[spot]) * cover


@ti.func
def _paint_shape(
    shapes: ti.template(), n: ti.i32, atlas: ti.template(), lanes: ti.template(), numbers: ti.template(), place: ti.i32, x0, y0
):
    """Blend shape n into a tile; a grouped shape only raises the mask. `place` is the tile's first lane."""
    left = ti.max(ti.cast(shapes[n, BOUNDS], ti.i32), x0)
    top = ti.max(ti.cast(shapes[n, BOUNDS + 1], ti.i32), y0)
    right = ti.min(ti.cast(shapes[n, BOUNDS + 2], ti.i32), x0 + TILE)
    bottom = ti.min(ti.cast(shapes[n, BOUNDS + 3], ti.i32), y0 + TILE)
    # Everything is read before the loops: the compiler cannot tell that writing pixels leaves the shapes alone.
    kind, grouped = ti.cast(shapes[n, KIND], ti.i32), shapes[n, GROUP] > ti.f32(0.0)
    ax, ay, bx, by = shapes[n, PLACE], shapes[n, PLACE + 1], shapes[n, PLACE + 2], shapes[n, PLACE + 3]
    p, q, tweak, stroke = shapes[n, SIZE], shapes[n, SIZE + 1], shapes[n, TWEAK], shapes[n, STROKE]
    alpha, more_alpha = shapes[n, ALPHA], shapes[n, ALPHA + 1] - shapes[n, ALPHA]
    red, green, blue = shapes[n, PAINT], shapes[n, PAINT + 1], shapes[n, PAINT + 2]
    per_soft = ti.f32(1.0) / shapes[n, SOFT]
    per_length2 = ti.f32(1.0) / ti.max((bx - ax) * (bx - ax) + (by - ay) * (by - ay), ti.f32(1e-12))
    first, last = ti.cast(left, ti.f32), ti.cast(right, ti.f32)
    if kind == SPRITE:
        _paint_sprite(shapes, n, atlas, numbers, place * LANES, left, top, right, bottom, x0, y0)
    elif kind == CAPSULE:
        for y in range(top, bottom):
            for column in range((left - x0) // LANES, (right - 1 - x0) // LANES + 1):
                x = lanes[0] + (ti.cast(x0 + column * LANES, ti.f32) + ti.f32(0.5))
                cover = coverage(
                    True,
                    kind,
                    ax,
                    ay,
                    bx,
                    by,
                    p,
                    q,
                    tweak,
                    per_soft,
                    stroke,
                    alpha,
                    more_alpha,
                    per_length2,
                    x,
                    ti.cast(y, ti.f32) + ti.f32(0.5),
                )
                cover = ti.select(smaller(x - first, last - x) > ti.f32(0.0), cover, ti.f32(0.0))
                spot = place + (y - y0) * ACROSS + column
                if grouped:
                    lanes[spot + MASK * AREA] = larger(lanes[spot + MASK * AREA], cover)
                else:
                    _blend(lanes, spot, red, green, blue, cover)
    else:
        for y in range(top, bottom):
            for column in range((left - x0) // LANES, (right - 1 - x0) // LANES + 1):
                x = lanes[0] + (ti.cast(x0 + column * LANES, ti.f32) + ti.f32(0.5))
                cover = coverage(
                    False,
                    kind,
                    ax,
                    ay,
                    bx,
                    by,
                    p,
                    q,
                    tweak,
                    per_soft,
                    stroke,
                    alpha,
                    more_alpha,
                    per_length2,
                    x,
                    ti.cast(y, ti.f32) + ti.f32(0.5),
                )
                cover = ti.select(smaller(x - first, last - x) > ti.f32(0.0), cover, ti.f32(0.0))
                _blend(lanes, place + (y - y0) * ACROSS + column, red, green, blue, cover)


@ti.func
def _paint_mask(shapes: ti.template(), n: ti.i32, lanes: ti.template(), place: ti.i32, top: ti.i32, bottom: ti.i32):
    """Blend what the group of shape n left in rows of the mask, and clear them."""
    red, green, blue = shapes[n, PAINT], shapes[n, PAINT + 1], shapes[n, PAINT + 2]
    for spot in range(place + top * ACROSS, place + bottom * ACROSS):
        cover = lanes[spot + MASK * AREA]
        _blend(lanes, spot, red, green, blue, cover)
        lanes[spot + MASK * AREA] = ti.f32(0.0) * cover


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
def _bin(shapes: ti.template(), windows: ti.template(), bins: ti.template(), columns: ti.i32, tiles: ti.i32):
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
def _rows(shapes: ti.template(), bins: ti.template(), first: ti.i32, entries: ti.i32, y0: ti.i32):
    """Give the rows of a tile that its entries touch, in pairs, which share their chroma: the first and one past the last."""
    top, bottom = TILE, 0
    for entry in range(first, first + entries):
        n = bins[entry]
        top = ti.min(top, ti.cast(shapes[n, BOUNDS + 1], ti.i32) - y0)
        bottom = ti.max(bottom, ti.cast(shapes[n, BOUNDS + 3], ti.i32) - y0)
    return ti.max(top, 0) // 2, (ti.min(bottom, TILE) + 1) // 2


@ti.func
def _paint_entries(
    shapes: ti.template(),
    atlas: ti.template(),
    bins: ti.template(),
    lanes: ti.template(),
    numbers: ti.template(),
    place: ti.i32,
    first: ti.i32,
    entries: ti.i32,
    x0,
    y0,
):
    """Blend the shapes of a tile, whose entries begin at `first`, into its scratch memory."""
    joined = -1  # a shape of the group whose coverage the mask holds, between two rows of the tile
    top, bottom = TILE, 0
    for entry in range(entries + 1):
        n = ti.select(entry < entries, bins[first + entry], -1)
        group = ti.select(n < 0, ti.f32(0.0), shapes[ti.max(n, 0), GROUP])
        if joined >= 0 and (n < 0 or group != shapes[ti.max(joined, 0), GROUP]):
            _paint_mask(shapes, joined, lanes, place, top, bottom)
            top, bottom = TILE, 0
        if n >= 0:
            _paint_shape(shapes, n, atlas, lanes, numbers, place, x0, y0)
            if group > ti.f32(0.0):
                top = ti.min(top, ti.max(ti.cast(shapes[n, BOUNDS + 1], ti.i32) - y0, 0))
                bottom = ti.max(bottom, ti.min(ti.cast(shapes[n, BOUNDS + 3], ti.i32) - y0, TILE))
        joined = ti.select(group > ti.f32(0.0), n, -1)


@ti.kernel
def paint(
    shapes: ti.types.ndarray(dtype=ti.f32, ndim=2),
    windows: ti.types.ndarray(dtype=ti.f32, ndim=2),
    atlas: ti.types.ndarray(dtype=ti.u8, ndim=2),
    bins: ti.types.ndarray(dtype=ti.i32, ndim=1),
    ground: _Lanes,
    lanes: _Lanes,
    numbers: _Numbers,
    out: _Bytes,
    as_yuv: ti.template(),
):
    """Paint tiles and write their bytes: those that shapes touch or touched last in `out`, or all of them.

    windows: rows of x0, y0, x1, y1, and one more with the colour that all begins with unless it is the ground. lanes and
    numbers are two views of the scratch memory. When bins have no room for all entries nothing is painted: their end says how
    many there are.
    """
    for _ in range(1):
        across = (bins[0] + TILE - 1) // TILE
        _bin(shapes, windows, bins, across, across * ((bins[1] + TILE - 1) // TILE))
    for index in range(CHUNKS * _TASK):
        if index % _TASK == 0:
            width, height, mode = bins[0], bins[1], bins[3]
            columns = (width + TILE - 1) // TILE
            tiles = columns * ((height + TILE - 1) // TILE)
            length = width * height * 3
            if ti.static(as_yuv):
                length = length // 2
            chunk = index // _TASK
            place = CONSTANTS + chunk * PLANES * AREA
            some = ti.cast(bins[HEAD + tiles] <= bins[4], ti.i32)
            for step in range(some * ((tiles - chunk + CHUNKS - 1) // CHUNKS)):
                tile = step * CHUNKS + chunk
                start, end = bins[HEAD + tile], bins[HEAD + tile + 1]
                x0, y0 = tile % columns * TILE, tile // columns * TILE
                x1, high = ti.min(x0 + TILE, width), ti.min(TILE, height - y0)
                # The rows that shapes touch now, and those that they touched when this plate was drawn last.
                touched = ti.cast(out[length + tile], ti.i32)
                now_top, now_bottom = _rows(shapes, bins, HEAD + tiles + 1 + start, end - start, y0)
                out[length + tile] = ti.cast(now_top + now_bottom * (TILE // 2 + 1), ti.u8)
                top, bottom = ti.min(now_top, touched % (TILE // 2 + 1)), ti.max(now_bottom, touched // (TILE // 2 + 1))
                top, bottom = 2 * top, ti.min(2 * bottom, high)
                if mode != OVER:
                    top, bottom = 0, high
                if bottom > top:
                    for c in range(3):
                        plane = c * AREA
                        if mode == OVER:
                            for spot in range(plane + top * ACROSS, plane + bottom * ACROSS):
                                lanes[place + spot] = ground[tile * 3 * AREA + spot]
                        else:
                            base = windows[bins[5], c]
                            for spot in range(plane, plane + AREA):
                                lanes[place + spot] = ti.f32(0.0) * lanes[0] + base
                    _paint_entries(shapes, atlas, bins, lanes, numbers, place, HEAD + tiles + 1 + start, end - start, x0, y0)
                    if mode == LAY:
                        for spot in range(3 * AREA):
                            ground[tile * 3 * AREA + spot] = lanes[place + spot]
                    for c in range(3):
                        for spot in range(place + c * AREA + top * ACROSS, place + c * AREA + bottom * ACROSS):
                            lanes[spot] = encoded(lanes[spot])
                    if ti.static(as_yuv):
                        write_yuv(lanes, numbers, place, out, width, height, x0, y0, x1, top, bottom)
                    else:
                        write_rgb(lanes, numbers, place, out, width, x0, y0, x1, top, bottom)
