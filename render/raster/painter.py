# mypy: disable-error-code="valid-type,index,operator,call-arg"
"""Paint shapes into the scratch memory of a tile, the uppermost first; what is hidden below them is not reckoned at all.

It holds planes of linear red, green and blue, of how much of what is below shows through, and a mask where groups are joined.

Lanes know no unary minus, no `abs` and no casts under this project's compiler settings (CONTRIBUTING): what needs one is done
on plain numbers, through a second view of the scratch memory.
"""

import taichi as ti

from render.raster.encode import ACROSS, AREA, LANES, TILE
from render.raster.sdf import Form, coverage
from render.raster.shapes import (
    ALPHA,
    BOUNDS,
    CAPSULE,
    CLOUD,
    GROUP,
    KIND,
    PAINT,
    PLACE,
    SIZE,
    SOFT,
    SPRITE,
    STROKE,
    TWEAK,
)
from render.raster.tiles import texels_along
from tiswarm.simd.lanes import anywhere, larger, smaller

THROUGH, MASK = 3, 4
"""Planes of the scratch memory after linear red, green and blue: the share of what is below that shows, and joined coverage."""

PLANES = 5

SLOTS = PLANES * AREA
"""Behind the planes are two rows of a cloud's colours and opacities: [row, channel, ACROSS] lanes."""

SCRATCH = SLOTS + 2 * 4 * ACROSS
"""Lanes of scratch memory that each tile at work needs."""

LOOK = 8
"""After so many shapes a tile is looked over for whether anything shows through yet."""


@ti.func
def _blend(lanes: ti.template(), spot: ti.i32, red: ti.f32, green: ti.f32, blue: ti.f32, cover):
    """Lay a colour under what is there already."""
    through = lanes[spot + THROUGH * AREA]
    seen = through * cover
    lanes[spot] = lanes[spot] + seen * red
    lanes[spot + AREA] = lanes[spot + AREA] + seen * green
    lanes[spot + 2 * AREA] = lanes[spot + 2 * AREA] + seen * blue
    lanes[spot + THROUGH * AREA] = through - seen


@ti.func
def _open(lanes: ti.template(), spot: ti.i32):
    """Tell whether anything shows through any of eight pixels."""
    return anywhere(lanes[spot + THROUGH * AREA] > ti.f32(0.0))


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
            spot = place + (y - y0) * TILE + x - x0
            seen = numbers[spot + THROUGH * TILE * TILE] * cover
            for c in range(3):
                numbers[spot + c * TILE * TILE] += shapes[n, PAINT + c] * seen
            numbers[spot + THROUGH * TILE * TILE] -= seen


@ti.func
def _paint_cloud(
    shapes: ti.template(),
    n: ti.i32,
    cells: ti.template(),
    texels: ti.template(),
    lanes: ti.template(),
    numbers: ti.template(),
    place: ti.i32,
    left,
    top,
    right,
    bottom,
    x0,
    y0,
):
    """Blend colours between the four nearest texels of each pixel; `place` is the tile's first lane."""
    ax, ay, per_x, per_y = shapes[n, PLACE], shapes[n, PLACE + 1], shapes[n, PLACE + 2], shapes[n, PLACE + 3]
    across, down = shapes[n, SIZE] * per_x, shapes[n, SIZE + 1] * per_y
    stride, first = ti.cast(shapes[n, TWEAK], ti.i32), ti.cast(shapes[n, STROKE], ti.i32)
    half, done = ti.f32(0.5), -1
    for y in range(top, bottom):
        v = texels_along(y, ay, per_y, down)
        row = ti.cast(v, ti.i32)
        # Rows of texels between columns, the one above and the one below, each reckoned once for all rows of pixels.
        for line in range(ti.max(row, done + 1), row + 2):
            slot = SLOTS + line % 2 * 4 * ACROSS
            for x in range(left, right):
                u = texels_along(x, ax, per_x, across)
                column = ti.cast(u, ti.i32)
                at, later = first + line * stride + column, u - ti.cast(column, ti.f32)
                near, far = texels[cells[at]], texels[cells[at + 1]]
                light = near + (far - near) * later
                for c in ti.static(range(4)):
                    numbers[(place + slot + c * ACROSS) * LANES + x - x0] = light[c]
        done = row + 1
        lower = v - ti.cast(row, ti.f32)
        for column in range(ACROSS):
            spot = place + (y - y0) * ACROSS + column
            above, below = place + SLOTS + row % 2 * 4 * ACROSS + column, place + SLOTS + (row + 1) % 2 * 4 * ACROSS + column
            x = lanes[0] + (ti.cast(x0 + column * LANES, ti.f32) + half)
            inside = smaller(x - ti.cast(left, ti.f32), ti.cast(right, ti.f32) - x) > ti.f32(0.0)
            through = ti.select(inside, lanes[spot + THROUGH * AREA], ti.f32(0.0))
            for c in ti.static(range(3)):
                light = lanes[above + c * ACROSS] + (lanes[below + c * ACROSS] - lanes[above + c * ACROSS]) * lower
                lanes[spot + c * AREA] = lanes[spot + c * AREA] + through * light
            veil = lanes[above + 3 * ACROSS] + (lanes[below + 3 * ACROSS] - lanes[above + 3 * ACROSS]) * lower
            lanes[spot + THROUGH * AREA] = lanes[spot + THROUGH * AREA] - through * veil


@ti.func
def _form(shapes: ti.template(), n: ti.i32):
    """Read what says how shape n covers pixels."""
    ax, ay, bx, by = shapes[n, PLACE], shapes[n, PLACE + 1], shapes[n, PLACE + 2], shapes[n, PLACE + 3]
    return Form(
        ti.cast(shapes[n, KIND], ti.i32),
        ax,
        ay,
        bx,
        by,
        shapes[n, SIZE],
        shapes[n, SIZE + 1],
        shapes[n, TWEAK],
        ti.f32(1.0) / shapes[n, SOFT],
        shapes[n, STROKE],
        shapes[n, ALPHA],
        shapes[n, ALPHA + 1] - shapes[n, ALPHA],
        ti.f32(1.0) / ti.max((bx - ax) * (bx - ax) + (by - ay) * (by - ay), ti.f32(1e-12)),
    )


@ti.func
def _covered(
    capsule: ti.template(), form: ti.template(), lanes: ti.template(), left: ti.i32, right: ti.i32, x0: ti.i32, y: ti.i32
):
    """Give how much of the eight pixels from (x0, y) on a shape covers, nothing outside its bounds."""
    x = lanes[0] + (ti.cast(x0, ti.f32) + ti.f32(0.5))
    cover = coverage(capsule, form, x, ti.cast(y, ti.f32) + ti.f32(0.5))
    inside = smaller(x - ti.cast(left, ti.f32), ti.cast(right, ti.f32) - x) > ti.f32(0.0)
    return ti.select(inside, cover, ti.f32(0.0))


@ti.func
def paint_shape(
    shapes: ti.template(),
    n: ti.i32,
    atlas: ti.template(),
    cells: ti.template(),
    texels: ti.template(),
    lanes: ti.template(),
    numbers: ti.template(),
    place: ti.i32,
    x0,
    y0,
):
    """Blend shape n into a tile; a grouped capsule only raises the mask. `place` is the tile's first lane."""
    left = ti.max(ti.cast(shapes[n, BOUNDS], ti.i32), x0)
    top = ti.max(ti.cast(shapes[n, BOUNDS + 1], ti.i32), y0)
    right = ti.min(ti.cast(shapes[n, BOUNDS + 2], ti.i32), x0 + TILE)
    bottom = ti.min(ti.cast(shapes[n, BOUNDS + 3], ti.i32), y0 + TILE)
    # Everything is read before the loops: the compiler cannot tell that writing pixels leaves the shapes alone.
    form, grouped = _form(shapes, n), shapes[n, GROUP] > ti.f32(0.0)
    red, green, blue = shapes[n, PAINT], shapes[n, PAINT + 1], shapes[n, PAINT + 2]
    if form.kind == SPRITE:
        _paint_sprite(shapes, n, atlas, numbers, place * LANES, left, top, right, bottom, x0, y0)
    elif form.kind == CLOUD:
        _paint_cloud(shapes, n, cells, texels, lanes, numbers, place, left, top, right, bottom, x0, y0)
    elif form.kind == CAPSULE:  # lanes of a row are written out: a loop over two would double the time to compile
        for y in range(top, bottom):
            for column in ti.static(range(ACROSS)):
                spot = place + (y - y0) * ACROSS + column
                if left < x0 + column * LANES + LANES and right > x0 + column * LANES and _open(lanes, spot):
                    cover = _covered(True, form, lanes, left, right, x0 + column * LANES, y)
                    if grouped:
                        lanes[spot + MASK * AREA] = larger(lanes[spot + MASK * AREA], cover)
                    else:
                        _blend(lanes, spot, red, green, blue, cover)
    else:
        for y in range(top, bottom):
            for column in ti.static(range(ACROSS)):
                spot = place + (y - y0) * ACROSS + column
                if _open(lanes, spot):
                    cover = _covered(False, form, lanes, left, right, x0 + column * LANES, y)
                    _blend(lanes, spot, red, green, blue, cover)


@ti.func
def _paint_mask(shapes: ti.template(), n: ti.i32, lanes: ti.template(), place: ti.i32, top: ti.i32, bottom: ti.i32):
    """Blend what the group of shape n left in rows of the mask, and clear them."""
    red, green, blue = shapes[n, PAINT], shapes[n, PAINT + 1], shapes[n, PAINT + 2]
    for spot in range(place + top * ACROSS, place + bottom * ACROSS):
        cover = lanes[spot + MASK * AREA]
        _blend(lanes, spot, red, green, blue, cover)
        lanes[spot + MASK * AREA] = ti.f32(0.0) * cover


@ti.func
def _shows(lanes: ti.template(), place: ti.i32, top: ti.i32, bottom: ti.i32) -> ti.i32:
    """Tell whether anything shows through anywhere in some rows of a tile."""
    through = ti.f32(0.0) * lanes[0]
    for spot in range(place + top * ACROSS, place + bottom * ACROSS):
        through = through + lanes[spot + THROUGH * AREA]
    return ti.cast(anywhere(through > ti.f32(0.0)), ti.i32)


@ti.func
def paint_entries(
    shapes: ti.template(),
    atlas: ti.template(),
    cells: ti.template(),
    texels: ti.template(),
    bins: ti.template(),
    lanes: ti.template(),
    numbers: ti.template(),
    place: ti.i32,
    first: ti.i32,
    entries: ti.i32,
    x0,
    y0,
    high: ti.i32,
    low: ti.i32,
):
    """Lay the shapes of a tile, whose entries begin at `first`, into its rows `high` to `low`: each under those after it."""
    joined = -1  # a shape of the group whose coverage the mask holds, between two rows of the tile
    top, bottom = TILE, 0
    left = entries  # how many have yet to be laid; none any more where nothing shows through
    while left >= 0:
        left -= 1
        n = ti.select(left >= 0, bins[first + ti.max(left, 0)], -1)
        group = ti.select(n < 0, ti.f32(0.0), shapes[ti.max(n, 0), GROUP])
        if joined >= 0 and (n < 0 or group != shapes[ti.max(joined, 0), GROUP]):
            _paint_mask(shapes, joined, lanes, place, top, bottom)
            top, bottom, joined = TILE, 0, -1
        if n >= 0:
            paint_shape(shapes, n, atlas, cells, texels, lanes, numbers, place, x0, y0)
            if group > ti.f32(0.0):
                top = ti.min(top, ti.max(ti.cast(shapes[n, BOUNDS + 1], ti.i32) - y0, 0))
                bottom = ti.max(bottom, ti.min(ti.cast(shapes[n, BOUNDS + 3], ti.i32) - y0, TILE))
                joined = ti.select(joined < 0, n, joined)
            elif left % LOOK == 0 and left > 0:
                left *= _shows(lanes, place, high, low)
