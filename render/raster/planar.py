# mypy: disable-error-code="valid-type,index,operator"
"""Planar: packed red, green, blue and opacity as the planes that video with opacity has."""

import numpy as np
import taichi as ti

from tiswarm.simd import launch, runtime

FAINT = 0.01
"""What an opacity [byte] counts more than it is, so that four pixels that show nothing have a colour, too."""

CHUNKS = 32
"""Rows are dealt to threads in so many sets."""

_Bytes = ti.types.ndarray(dtype=ti.u8, ndim=1)


@ti.func
def _luma(red, green, blue):
    """Weigh colours as BT.709 does."""
    return red * ti.f32(0.2126) + green * ti.f32(0.7152) + blue * ti.f32(0.0722)


@ti.func
def _split_four(pixels: ti.template(), out: ti.template(), width: ti.i32, height: ti.i32, x: ti.i32, y: ti.i32):
    """Write the luma and the opacity of four pixels, and the colour that they share."""
    count, red, green, blue, weights = width * height, ti.f32(0.0), ti.f32(0.0), ti.f32(0.0), ti.f32(0.0)
    for n in ti.static(range(4)):
        pixel = (2 * y + n // 2) * width + 2 * x + n % 2
        r, g = ti.cast(pixels[4 * pixel], ti.f32), ti.cast(pixels[4 * pixel + 1], ti.f32)
        b = ti.cast(pixels[4 * pixel + 2], ti.f32)
        opacity = pixels[4 * pixel + 3]
        weight = ti.cast(opacity, ti.f32) + ti.f32(FAINT)
        red, green, blue, weights = red + r * weight, green + g * weight, blue + b * weight, weights + weight
        out[pixel] = ti.cast(_luma(r, g, b) * ti.f32(219 / 255) + ti.f32(16.5), ti.u8)
        out[count * 3 // 2 + pixel] = opacity
    red, blue, luma = red / weights, blue / weights, _luma(red, green, blue) / weights
    spot = count + y * (width // 2) + x
    out[spot] = ti.cast((blue - luma) * ti.f32(224 / 255 / 1.8556) + ti.f32(128.5), ti.u8)
    out[spot + count // 4] = ti.cast((red - luma) * ti.f32(224 / 255 / 1.5748) + ti.f32(128.5), ti.u8)


@ti.kernel
def _split(pixels: _Bytes, out: _Bytes, width: ti.i32, height: ti.i32):
    for index in range(CHUNKS * runtime.TASK):
        if index % runtime.TASK == 0:
            chunk, rows = index // runtime.TASK, height // 2
            for y in range(rows * chunk // CHUNKS, rows * (chunk + 1) // CHUNKS):
                for x in range(width // 2):
                    _split_four(pixels, out, width, height, x, y)


def planar(pixels: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Give Y'CbCr 4:2:0, BT.709, limited range, and the plane of opacity.

    Four pixels share a colour in which each counts by its opacity: what can hardly be seen leaves no rim around what can.

    pixels: bytes of a frame, four to a pixel. size: width, height [px], both even.
    """
    runtime.start()
    out = np.empty(size[0] * size[1] * 5 // 2, np.uint8)
    launch.run(_split, pixels, out, *size)
    return out
