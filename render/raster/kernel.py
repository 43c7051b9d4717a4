# mypy: disable-error-code="valid-type,index,operator"
"""Rasterise shapes in linear light with Taichi kernels: signed distance, analytic coverage, one thread per tile.

A tile is painted in scratch memory that stays in the nearest cache, eight pixels of a row at a time (lanes), then encoded into
the bytes of the frame. Only rows of tiles that a shape touches, or that one touched when the same bytes were drawn on last,
are painted: all others show the ground already.
"""

import taichi as ti

from render.raster.encode import ACROSS, AREA, LANES, TILE, encoded, write_rgb, write_yuv
from render.raster.painter import PLANES, paint_entries
from render.raster.tiles import HEAD, bin_shapes, rows
from tiswarm.simd import runtime

CHUNKS = 32
"""Tiles are dealt to threads in this many interleaved sets, so that a crowded corner is shared."""

CONSTANTS = 1 + AREA  # lanes ahead of the planes: 0 1 2 .. 7, then the dither pattern

OVER, LAY, WHOLE = 0, 1, 2
"""Paint over the ground; paint all and keep it as the ground; paint all and keep nothing."""

_TASK = runtime.TASK
_LANE = ti.types.vector(LANES, ti.f32)
_Lanes = ti.types.ndarray(dtype=_LANE, ndim=1)
_Texels = ti.types.ndarray(dtype=ti.types.vector(4, ti.f32), ndim=1)
_Numbers = ti.types.ndarray(dtype=ti.f32, ndim=1)
_Bytes = ti.types.ndarray(dtype=ti.u8, ndim=1)


@ti.func
def _begin(
    lanes: ti.template(),
    ground: ti.template(),
    windows: ti.template(),
    bins: ti.template(),
    place,
    tile,
    mode,
    top,
    bottom,
):
    """Fill a tile's scratch memory: with the ground in its rows `top` to `bottom`, or with the colour that all begins with."""
    for c in range(3):
        plane = c * AREA
        if mode == OVER:
            for spot in range(plane + top * ACROSS, plane + bottom * ACROSS):
                lanes[place + spot] = ground[tile * 3 * AREA + spot]
        else:
            base = windows[bins[5], c]
            for spot in range(plane, plane + AREA):
                lanes[place + spot] = ti.f32(0.0) * lanes[0] + base


@ti.func
def _finish(lanes: ti.template(), ground: ti.template(), place, tile, mode, top, bottom):
    """Keep a painted tile as the ground where that is wanted, and encode its light."""
    if mode == LAY:
        for spot in range(3 * AREA):
            ground[tile * 3 * AREA + spot] = lanes[place + spot]
    for c in range(3):
        for spot in range(place + c * AREA + top * ACROSS, place + c * AREA + bottom * ACROSS):
            lanes[spot] = encoded(lanes[spot])


@ti.kernel
def paint(
    shapes: ti.types.ndarray(dtype=ti.f32, ndim=2),
    windows: ti.types.ndarray(dtype=ti.f32, ndim=2),
    atlas: ti.types.ndarray(dtype=ti.u8, ndim=2),
    texels: _Texels,
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
        bin_shapes(shapes, windows, bins, across, across * ((bins[1] + TILE - 1) // TILE))
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
                now_top, now_bottom = rows(shapes, bins, HEAD + tiles + 1 + start, end - start, y0)
                out[length + tile] = ti.cast(now_top + now_bottom * (TILE // 2 + 1), ti.u8)
                top, bottom = ti.min(now_top, touched % (TILE // 2 + 1)), ti.max(now_bottom, touched // (TILE // 2 + 1))
                top, bottom = 2 * top, ti.min(2 * bottom, high)
                if mode != OVER:
                    top, bottom = 0, high
                if bottom > top:
                    _begin(lanes, ground, windows, bins, place, tile, mode, top, bottom)
                    first = HEAD + tiles + 1 + start
                    paint_entries(shapes, atlas, texels, bins, lanes, numbers, place, first, end - start, x0, y0)
                    _finish(lanes, ground, place, tile, mode, top, bottom)
                    if ti.static(as_yuv):
                        write_yuv(lanes, numbers, place, out, width, height, x0, y0, x1, top, bottom)
                    else:
                        write_rgb(lanes, numbers, place, out, width, x0, y0, x1, top, bottom)
