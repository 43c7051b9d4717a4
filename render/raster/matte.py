# mypy: disable-error-code="valid-type,index,operator"
"""A matte: how shapes that have no ground become bytes of colour and opacity, tile by tile, in its scratch memory.

What was painted is light, but programs that lay pictures over each other mix encoded values. Opacities are such that over the
ground that is to be suited this looks as shapes painted there would, and over others as near to that as one opacity for all
channels can be.
"""

import taichi as ti

from render.raster.encode import ACROSS, AREA, LANES, TILE, encoded
from render.raster.painter import SLOTS, THROUGH
from render.raster.sdf import saturated
from tiswarm.simd.lanes import larger, smaller

BLOCK = 8
"""Edge of the squares [px] in which pixels that show nothing take the colour of what is near.

Whoever scales a picture, or halves its colours as video does, mixes them in."""

SIDE = TILE // BLOCK

NOTES = 5
"""What is kept of a block: sums of its colours times opacities, of its opacities, and the colour that was near it last."""

UNKNOWN = -1
"""No colour: that of a block which was painted since."""

ALIKE = 0.01
"""Squared distance of a colour from the ground below which its own opacity counts more than what it does to the ground."""


@ti.func
def _rounded(x):
    """Round a number below 2²²: lanes know no other way."""
    return (x + ti.f32(8388608.0)) - ti.f32(8388608.0)


@ti.func
def _suit(lanes: ti.template(), windows: ti.template(), at: ti.i32, place: ti.i32, top: ti.i32, bottom: ti.i32):
    """Turn light and what shows through into bytes: colours and opacities that mix, encoded, over a ground as light does.

    at: the row of `windows` that holds the ground's colour.
    """
    nothing = ti.f32(0.0) * lanes[0]
    for c in ti.static(range(3)):
        lanes[place + SLOTS + c] = encoded(nothing + windows[at, c])
    for spot in range(place + top * ACROSS, place + bottom * ACROSS):
        through = lanes[spot + THROUGH * AREA]
        cover = ti.f32(1.0) - through
        whole = ti.f32(1.0) / larger(cover, ti.f32(1e-6))
        across, along, least = cover * ti.f32(ALIKE), nothing + ti.f32(ALIKE), nothing
        for c in ti.static(range(3)):
            under, light = lanes[place + SLOTS + c], smaller(lanes[spot + c * AREA], cover)
            there, own = encoded(light + through * windows[at, c]) - under, encoded(light * whole) - under
            lanes[spot + c * AREA] = there
            across, along = across + there * own, along + own * own
            darker = (nothing - there) / larger(under, ti.f32(1e-3))
            least = larger(least, larger(darker, there / larger(ti.f32(1.0) - under, ti.f32(1e-3))))
        opacity = _rounded(saturated(larger(across / along, least)) * ti.f32(255.0))
        lanes[spot + THROUGH * AREA] = opacity
        for c in ti.static(range(3)):
            value = lanes[place + SLOTS + c] + lanes[spot + c * AREA] * (ti.f32(255.0) / larger(opacity, ti.f32(1.0)))
            lanes[spot + c * AREA] = ti.select(opacity > ti.f32(0.0), _rounded(saturated(value) * ti.f32(255.0)), nothing)


@ti.func
def _sum_blocks(
    lanes: ti.template(), numbers: ti.template(), place: ti.i32, blocks: ti.template(), columns: ti.i32, tile, top, bottom
):
    """Note how much colour and opacity the blocks of a tile hold that has been suited: those in the rows from top to bottom.

    columns: tiles in a row.
    """
    stride = columns * SIDE
    first = tile // columns * SIDE * stride + tile % columns * SIDE
    for down in range(top // BLOCK, (bottom + BLOCK - 1) // BLOCK):
        for c in ti.static(range(4)):
            for column in range(ACROSS):
                total = ti.f32(0.0) * lanes[0]
                begin = place + down * BLOCK * ACROSS + column
                for row in range(ti.min(BLOCK, bottom - down * BLOCK)):
                    weight = lanes[begin + row * ACROSS + THROUGH * AREA]
                    if ti.static(c == THROUGH):
                        total = total + weight
                    else:
                        total = total + weight * lanes[begin + row * ACROSS + c * AREA]
                lanes[place + SLOTS + column] = total
            for side in range(SIDE):
                total = ti.f32(0.0)
                for n in range(BLOCK):
                    total += numbers[(place + SLOTS) * LANES + side * BLOCK + n]
                blocks[(first + down * stride + side) * NOTES + c] = ti.cast(total, ti.i32)
        for side in range(SIDE):
            blocks[(first + down * stride + side) * NOTES + 4] = UNKNOWN


@ti.func
def write_clear(
    lanes: ti.template(),
    numbers: ti.template(),
    windows: ti.template(),
    bins: ti.template(),
    blocks: ti.template(),
    place: ti.i32,
    out: ti.template(),
    tile,
    x0,
    y0,
    x1,
    top,
    bottom,
):
    """Write colours and opacities of the rows from top to before bottom, whose planes hold light and what shows through."""
    width = bins[0]
    _suit(lanes, windows, bins[5], place, top, bottom)
    _sum_blocks(lanes, numbers, place, blocks, (width + TILE - 1) // TILE, tile, top, bottom)
    for y in range(top, bottom):
        for x in range(x0, x1):
            for c in ti.static(range(4)):
                number = numbers[place * LANES + c * TILE * TILE + y * TILE + x - x0]
                out[((y0 + y) * width + x) * 4 + c] = ti.cast(number, ti.u8)


@ti.func
def _near(blocks: ti.template(), windows: ti.template(), at: ti.i32, columns: ti.i32, rows: ti.i32, x: ti.i32, y: ti.i32):
    """Give the mean colour in and around a block, as one number, or the ground's where nothing is."""
    sums = ti.Vector([0, 0, 0, 0])
    for v in range(ti.max(y - 1, 0), ti.min(y + 2, rows)):
        for u in range(ti.max(x - 1, 0), ti.min(x + 2, columns)):
            for c in ti.static(range(4)):
                sums[c] += blocks[(v * columns + u) * NOTES + c]
    near = 0
    for c in ti.static(range(3)):
        level = ti.cast(encoded(windows[at, c]) * ti.f32(255.0) + ti.f32(0.5), ti.i32)
        if sums[3] > 0:
            level = (2 * sums[c] + sums[3]) // (2 * sums[3])
        near += level << (8 * c)
    return near


@ti.func
def _fill(out: ti.template(), near: ti.i32, width: ti.i32, left: ti.i32, top: ti.i32, right: ti.i32, bottom: ti.i32):
    """Give pixels that show nothing a colour."""
    for y in range(top, bottom):
        for x in range(left, right):
            spot = (y * width + x) * 4
            if out[spot + 3] == ti.u8(0):
                for c in ti.static(range(3)):
                    out[spot + c] = ti.cast((near >> (8 * c)) & 255, ti.u8)


@ti.func
def fill_blocks(
    blocks: ti.template(), windows: ti.template(), bins: ti.template(), out: ti.template(), chunk: ti.i32, chunks: ti.i32
):
    """Give the pixels of a share of the blocks that show nothing the colour of what is near, wherever that is another now."""
    width, height = bins[0], bins[1]
    columns, rows = (width + TILE - 1) // TILE * SIDE, (height + TILE - 1) // TILE * SIDE
    for block in range(rows * chunk // chunks * columns, rows * (chunk + 1) // chunks * columns):
        x, y, note = block % columns, block // columns, block * NOTES + 4
        near = _near(blocks, windows, bins[5], columns, rows, x, y)
        if near != blocks[note]:
            blocks[note] = near
            right, bottom = ti.min((x + 1) * BLOCK, width), ti.min((y + 1) * BLOCK, height)
            _fill(out, near, width, x * BLOCK, y * BLOCK, right, bottom)
