# mypy: disable-error-code="valid-type,index,operator"
"""Rasterise shapes in linear light with Taichi kernels: signed distance, analytic coverage, one thread per tile.

A tile is painted in scratch memory that stays in the nearest cache, eight pixels of a row at a time (lanes), then encoded into
the bytes of the frame. Only rows of tiles that a shape touches, or that one touched when the same bytes were drawn on last,
are painted: all others show the ground already.
"""

import taichi as ti

from render.raster.encode import ACROSS, AREA, LANES, TILE, encoded, write
from render.raster.matte import BLOCK, fill_blocks, write_clear
from render.raster.painter import SCRATCH, THROUGH, paint_entries
from render.raster.tiles import HEAD, PARTS, count_shapes, entries_from, list_shapes, place_parts, rows, tiles_of
from tiswarm.simd import runtime

CHUNKS, RUN = 32, 4
"""Tiles are dealt to threads in this many sets, so that a crowded corner is shared: so many neighbours to each in turn, which
take what lies side by side in memory."""

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
def _begin(lanes: ti.template(), place, top, bottom):
    """Empty the rows `top` to `bottom` of a tile's scratch memory."""
    for spot in range(place + top * ACROSS, place + bottom * ACROSS):
        for c in ti.static(range(3)):
            lanes[spot + c * AREA] = ti.f32(0.0) * lanes[0]
        lanes[spot + THROUGH * AREA] = ti.f32(0.0) * lanes[0] + ti.f32(1.0)


@ti.func
def _finish(
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
    """Lay the ground under a painted tile, or the colour that all begins with; keep it as the ground where that is wanted.

    Then encode its light.
    """
    for c in range(3):
        base = windows[bins[5], c]
        for row in range(top * ACROSS, bottom * ACROSS):
            spot, under = place + c * AREA + row, (tile * 3 + c) * AREA + row
            below = ti.f32(0.0) * lanes[0] + base
            if mode == OVER:
                below = ground[under]
            light = lanes[spot] + lanes[place + THROUGH * AREA + row] * below
            if mode == LAY:
                ground[under] = light
            lanes[spot] = encoded(light)


@ti.func
def _lay_below(lanes: ti.template(), ground: ti.template(), place, tile, mode, top, bottom):
    """Lay what stands still under a painted tile that has no ground of its own; keep both where that is wanted."""
    for row in range(top * ACROSS, bottom * ACROSS):
        spot, under = place + row, tile * (THROUGH + 1) * AREA + row
        if mode == OVER:
            through = lanes[spot + THROUGH * AREA]
            for c in ti.static(range(3)):
                lanes[spot + c * AREA] = lanes[spot + c * AREA] + through * ground[under + c * AREA]
            lanes[spot + THROUGH * AREA] = through * ground[under + THROUGH * AREA]
        if mode == LAY:
            for c in ti.static(range(4)):
                ground[under + c * AREA] = lanes[spot + c * AREA]


@ti.func
def _due(
    shapes: ti.template(),
    cells: ti.template(),
    texels: ti.template(),
    bins: ti.template(),
    out: ti.template(),
    note,
    first,
    entries,
    x0,
    y0,
):
    """Give the rows of a tile that shapes touch now, or touched when this plate was drawn last, and note the former."""
    touched = ti.cast(out[note], ti.i32)
    top, bottom = rows(shapes, cells, texels, bins, first, entries, x0, y0)
    out[note] = ti.cast(top + bottom * (TILE // 2 + 1), ti.u8)
    return 2 * ti.min(top, touched % (TILE // 2 + 1)), 2 * ti.max(bottom, touched // (TILE // 2 + 1))


@ti.func
def _dealt(tiles: ti.i32, chunk: ti.i32, calm: ti.i32) -> ti.i32:
    """Give how many tiles a chunk has: the first one has all where one thread is to do."""
    rest = tiles % (CHUNKS * RUN)
    share = tiles // (CHUNKS * RUN) * RUN + ti.min(ti.max(rest - chunk * RUN, 0), RUN)
    return ti.select(calm == 0, share, ti.select(chunk == 0, tiles, 0))


@ti.func
def _tile(step: ti.i32, chunk: ti.i32, calm: ti.i32) -> ti.i32:
    """Give the number of a chunk's tile."""
    return ti.select(calm == 0, (step // RUN * CHUNKS + chunk) * RUN + step % RUN, step)


@ti.kernel
def paint(
    shapes: ti.types.ndarray(dtype=ti.f32, ndim=2),
    windows: ti.types.ndarray(dtype=ti.f32, ndim=2),
    atlas: ti.types.ndarray(dtype=ti.u8, ndim=2),
    cells: ti.types.ndarray(dtype=ti.i32, ndim=1),
    texels: _Texels,
    bins: ti.types.ndarray(dtype=ti.i32, ndim=1),
    ground: _Lanes,
    lanes: _Lanes,
    numbers: _Numbers,
    out: _Bytes,
    blocks: ti.types.ndarray(dtype=ti.i32, ndim=1),
    as_yuv: ti.template(),
    clear: ti.template(),
):
    """Paint tiles and write their bytes: those that shapes touch or touched last in `out`, or all of them.

    windows: rows of x0, y0, x1, y1, and one more with the colour that all begins with unless it is the ground. lanes and
    numbers are two views of the scratch memory. When bins have no room for all entries nothing is painted: their end says how
    many there are. clear: write colours and opacities, without a ground; blocks: what is known of those of `out` then.
    """
    for index in range(PARTS * _TASK):
        if index % _TASK == 0:
            count_shapes(shapes, windows, bins, index // _TASK)
    for _ in range(1):
        place_parts(bins)
    for index in range(PARTS * _TASK):
        if index % _TASK == 0:
            list_shapes(shapes, bins, index // _TASK)
    for index in range(CHUNKS * _TASK):
        if index % _TASK == 0:
            width, height, mode = bins[0], bins[1], bins[3]
            columns, tiles = tiles_of(bins)
            length = width * height * (4 if clear else 3) // (2 if as_yuv else 1)
            chunk, place = index // _TASK, CONSTANTS + index // _TASK * SCRATCH
            some = ti.cast(bins[HEAD + tiles] <= bins[4], ti.i32)
            for step in range(some * _dealt(tiles, chunk, bins[6])):
                tile = _tile(step, chunk, bins[6])
                start, end = bins[HEAD + tile], bins[HEAD + tile + 1]
                x0, y0 = tile % columns * TILE, tile // columns * TILE
                x1, high = ti.min(x0 + TILE, width), ti.min(TILE, height - y0)
                first, count = entries_from(tiles) + start, end - start
                top, bottom = _due(shapes, cells, texels, bins, out, length + tile, first, count, x0, y0)
                if mode != OVER:
                    top, bottom = 0, TILE
                if ti.static(clear):
                    top, bottom = top // BLOCK * BLOCK, (bottom + BLOCK - 1) // BLOCK * BLOCK
                bottom = ti.min(bottom, high)
                if bottom > top:
                    _begin(lanes, place, top, bottom)
                    paint_entries(shapes, atlas, cells, texels, bins, lanes, numbers, place, first, count, x0, y0, top, bottom)
                    if ti.static(clear):
                        _lay_below(lanes, ground, place, tile, mode, top, bottom)
                        write_clear(lanes, numbers, windows, bins, blocks, place, out, tile, x0, y0, x1, top, bottom)
                    else:
                        _finish(lanes, ground, windows, bins, place, tile, mode, top, bottom)
                        write(lanes, numbers, place, out, width, height, x0, y0, x1, top, bottom, as_yuv)
    for index in range((CHUNKS if clear else 0) * _TASK):
        if index % _TASK == 0 and bins[HEAD + tiles_of(bins)[1]] <= bins[4]:
            fill_blocks(blocks, windows, bins, out, index // _TASK, CHUNKS)
