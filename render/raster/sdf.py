# mypy: disable-error-code="valid-type,index,operator"
"""How much of each pixel a shape covers, from its signed distance: functions of lanes, eight pixels of a row at once."""

import taichi as ti

from render.raster.shapes import DART, QUAD
from tiswarm.simd.lanes import larger, smaller


@ti.dataclass
class Form:
    """What says how a shape covers pixels.

    ax, ay, bx, by, p, q: place and size, as in `render.shapes`. per_soft, per_length2: one over the ramp's width [1/px], and
    over a capsule's squared length [1/px²]. alpha, more_alpha: opacity at the near end, and how much more at the far one.
    """

    kind: ti.i32
    ax: ti.f32
    ay: ti.f32
    bx: ti.f32
    by: ti.f32
    p: ti.f32
    q: ti.f32
    tweak: ti.f32
    per_soft: ti.f32
    stroke: ti.f32
    alpha: ti.f32
    more_alpha: ti.f32
    per_length2: ti.f32


@ti.func
def saturated(x):
    """Cut to 0..1."""
    return smaller(larger(x, ti.f32(0.0)), ti.f32(1.0))


@ti.func
def _magnitude(x):
    return larger(x, ti.f32(0.0) - x)


@ti.func
def _edge_distance2(u, v, au, av, bu, bv):
    """Squared distance of the points (u, v) from the segment a-b."""
    eu, ev = bu - au, bv - av
    h = saturated(((u - au) * eu + (v - av) * ev) * (ti.f32(1.0) / larger(eu * eu + ev * ev, ti.f32(1e-12))))
    du, dv = u - au - h * eu, v - av - h * ev
    return du * du + dv * dv


@ti.func
def _dart_distance(u, v, length, width, notch):
    """Signed distance from a swept dart: nose at (length, 0), wing tips at (-length, ±width), notch at (notch - length, 0)."""
    v = _magnitude(v)
    nothing = ti.f32(0.0)
    d = ti.sqrt(
        smaller(
            _edge_distance2(u, v, length, nothing, nothing - length, width),
            _edge_distance2(u, v, nothing - length, width, notch - length, nothing),
        )
    )
    under_wing = (length - u) * width - v * (ti.f32(2.0) * length)
    before_tail = (u + length) * width - (width - v) * notch
    return ti.select(smaller(under_wing, before_tail) > ti.f32(0.0), nothing - d, d)


@ti.func
def _beyond(x, y, ax, ay, bx, by):
    """Signed distance of (x, y) from the line from a to b, above zero on its left."""
    ex, ey = bx - ax, by - ay
    return ((x - ax) * ey - (y - ay) * ex) * (ti.f32(1.0) / ti.sqrt(larger(ex * ex + ey * ey, ti.f32(1e-12))))


@ti.func
def coverage(capsule: ti.template(), form: ti.template(), x, y):
    """Share of the pixels centred at (x, y) that a shape covers, times its opacity there.

    capsule: whether it is one, known when this is compiled, for most are.
    """
    nothing = x * ti.f32(0.0)
    d, along, most = nothing, nothing, nothing + ti.f32(1.0)
    ax, ay, bx, by, p, q = form.ax, form.ay, form.bx, form.by, form.p, form.q
    if ti.static(capsule):
        ex, ey = bx - ax, by - ay
        along = saturated(((x - ax) * ex + (y - ay) * ey) * form.per_length2)
        dx, dy = x - ax - along * ex, (y - ay) - along * ey
        radius = p + along * (q - p)
        d = ti.sqrt(dx * dx + dy * dy) - radius
        most = smaller(larger(ti.f32(2.0) * radius, form.stroke * ti.f32(1e6)), most)
    elif form.kind == DART:
        d = _dart_distance((x - ax) * bx + (y - ay) * by, (y - ay) * bx - (x - ax) * by, p, q, form.tweak)
    elif form.kind == QUAD:
        near = larger(_beyond(x, y, ax, ay, bx, by), _beyond(x, y, bx, by, p, q))
        d = larger(near, larger(_beyond(x, y, p, q, form.tweak, form.stroke), _beyond(x, y, form.tweak, form.stroke, ax, ay)))
    else:
        dx = _magnitude(x - ax) - p + form.tweak
        dy = larger(y - ay, ay - y) - q + form.tweak
        ox, oy = larger(dx, ti.f32(0.0)), larger(dy, ti.f32(0.0))
        d = ti.sqrt(ox * ox + oy * oy) + smaller(larger(dx, dy), ti.f32(0.0)) - form.tweak
        along = nothing + saturated((y - ay + q) / larger(ti.f32(2.0) * q, ti.f32(1e-6)))
    if form.stroke > ti.f32(0.0) and form.kind != QUAD:
        d = _magnitude(d) - form.stroke
        most = smaller(ti.f32(2.0) * form.stroke, most)
    return smaller(saturated(ti.f32(0.5) - d * form.per_soft), most) * (form.alpha + along * form.more_alpha)
