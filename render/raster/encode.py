# mypy: disable-error-code="valid-type,index,operator"
"""From light to bytes: gamma, then packed RGB or planar YUV, tile by tile in its scratch memory."""

import numpy as np
import taichi as ti

from render.raster import shapes
from render.raster.sdf import saturated
from tiswarm.simd import runtime
from tiswarm.simd.lanes import smaller

TILE = 16
"""Edge of a tile [px]: small enough that a dart wakes few pixels, large enough that a trail is binned into few tiles."""

LANES = runtime.LANES
ACROSS = TILE // LANES
AREA = TILE * ACROSS  # lanes of one plane of a tile


def _gamma_fit() -> tuple[float, ...]:
    """Fit the sRGB curve above its linear foot by a polynomial in the square root of light: lanes have no power function."""
    root = np.linspace(0.0031308**0.5, 1, 4000)
    fit = np.polynomial.Chebyshev.fit(root, shapes.encoded(root**2), 7).convert(kind=np.polynomial.Polynomial)
    return tuple(float(c) for c in fit.coef)


_GAMMA = _gamma_fit()


@ti.func
def encoded(light):
    """Gamma-encode linear light."""
    x = saturated(light)
    root = ti.sqrt(x)
    curve = root * ti.f32(_GAMMA[7])
    for power in ti.static(range(6, 0, -1)):
        curve = (curve + ti.f32(_GAMMA[power])) * root
    return ti.select(x < ti.f32(0.0031308), x * ti.f32(12.92), curve + ti.f32(_GAMMA[0]))


@ti.func
def _write_rgb(lanes: ti.template(), numbers: ti.template(), place: ti.i32, out: ti.template(), width, x0, y0, x1, top, bottom):
    """Write packed red, green and blue bytes of the rows from top to before bottom, whose planes hold encoded colours."""
    for c in range(3):
        for row in range(top * ACROSS, bottom * ACROSS):
            spot = place + c * AREA + row
            lanes[spot] = smaller(lanes[spot] * ti.f32(255.0) + lanes[1 + row], ti.f32(255.0))
    for y in range(top, bottom):
        for x in range(x0, x1):
            for c in range(3):
                number = numbers[place * LANES + c * TILE * TILE + y * TILE + x - x0]
                out[((y0 + y) * width + x) * 3 + c] = ti.cast(number, ti.u8)


@ti.func
def _write_yuv(
    lanes: ti.template(), numbers: ti.template(), place: ti.i32, out: ti.template(), width, height, x0, y0, x1, top, bottom
):
    """Write planar Y'CbCr 4:2:0, BT.709, limited range; one chroma sample stands for the mean of its four pixels.

    The rows from top to before bottom, both even. A row is read whole before it is written: sixteen reads and sixteen writes of
    their own would be compiled one by one.
    """
    for spot in range(place + top * ACROSS, place + bottom * ACROSS):
        red, green, blue = lanes[spot], lanes[spot + AREA], lanes[spot + 2 * AREA]
        luma = red * ti.f32(0.2126) + green * ti.f32(0.7152) + blue * ti.f32(0.0722)
        lanes[spot] = luma * ti.f32(219.0) + (lanes[1 + spot - place] + ti.f32(16.0))
        lanes[spot + AREA] = (blue - luma) * ti.f32(56.0 / 1.8556)
        lanes[spot + 2 * AREA] = (red - luma) * ti.f32(56.0 / 1.5748)
    for y in range(top, bottom):
        first, row = place * LANES + y * TILE, (y0 + y) * width + x0
        if x1 - x0 == TILE:
            level = [numbers[first + n] for n in ti.static(range(TILE))]
            for n in ti.static(range(TILE)):
                out[row + n] = ti.cast(level[n], ti.u8)
        else:
            for n in range(x1 - x0):
                out[row + n] = ti.cast(numbers[first + n], ti.u8)
    for c in range(2):
        plane = height * width * (4 + c) // 4
        for y in range(top // 2, bottom // 2):
            above = place + (1 + c) * AREA + 2 * y * ACROSS
            for column in range(ACROSS):
                lanes[above + column] = lanes[above + column] + lanes[above + ACROSS + column]
            first, row = above * LANES, plane + (y0 // 2 + y) * (width // 2) + x0 // 2
            if x1 - x0 == TILE:
                four = [numbers[first + 2 * n] + numbers[first + 2 * n + 1] for n in ti.static(range(TILE // 2))]
                for n in ti.static(range(TILE // 2)):
                    out[row + n] = ti.cast(four[n] + ti.f32(128.5), ti.u8)
            else:
                for n in range((x1 - x0) // 2):
                    out[row + n] = ti.cast(numbers[first + 2 * n] + numbers[first + 2 * n + 1] + ti.f32(128.5), ti.u8)


@ti.func
def write(
    lanes: ti.template(),
    numbers: ti.template(),
    place: ti.i32,
    out: ti.template(),
    width,
    height,
    x0,
    y0,
    x1,
    top,
    bottom,
    as_yuv: ti.template(),
):
    """Write the bytes of the rows from top to before bottom, whose planes hold encoded colours."""
    if ti.static(as_yuv):
        _write_yuv(lanes, numbers, place, out, width, height, x0, y0, x1, top, bottom)
    else:
        _write_rgb(lanes, numbers, place, out, width, x0, y0, x1, top, bottom)
