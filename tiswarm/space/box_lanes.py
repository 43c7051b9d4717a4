"""Box lanes: ways and places in the world, as box.py has them in NumPy: along one axis, of lanes or of single numbers."""

import taichi as ti

from tiswarm.simd.lanes import components, dot, larger, safe, scaled, smaller
from tiswarm.space import box


@ti.func
def displacement(way, size):
    """Take the shortest image of a difference of coordinates along a periodic axis of a length `size`."""
    return way - size * ti.floor(way / size + 0.5)


@ti.func
def shortest(me: ti.template(), way: ti.template()):
    """Take the shortest image of a way, across the edges of a periodic world if the agent sees across them.

    What hooks are given is near `me` already; this is for ways between two others, and to places that a strategy remembers.
    """
    lengths = ti.static(components(me, "period"))
    short = [1.0 * w for w in ti.static(way)]
    for k in ti.static(range(len(lengths))):
        short[k] = displacement(short[k], lengths[k])
    return short


@ti.func
def adjacent(way, size):
    """Take the shortest image of a difference of two coordinates that are both inside, without a division.

    Who waits far away, as a grid's empty lanes do, stays far away: `displacement` would bring them back.
    """
    way = ti.select(way > 0.5 * size, way - size, way)
    return ti.select(way < -0.5 * size, way + size, way)


@ti.func
def wrap(place, size):
    """Bring a coordinate back to 0 <= place < size."""
    inside = place - size * ti.floor(place / size)
    return ti.select(inside >= size, 0.0, inside)  # rounding may lift a tiny negative number to the size itself


@ti.func
def clamp(place, size, radius):
    """Keep the centre of a body between walls, in their middle if it is wider than the world."""
    low = smaller(radius, 0.5 * size)
    return larger(low, smaller(size - low, place))  # in this order, so that no number stays none


@ti.func
def from_middle(place: ti.template(), size: ti.template()):
    """Give the way to a place from the middle of the world."""
    return [p - 0.5 * side for p, side in ti.static(zip(place, size, strict=True))]


@ti.func
def radius_of(size: ti.template()):
    """Give the radius of the largest disc, or ball, in the world's box."""
    least = 1.0 * size[0]
    for k in ti.static(range(1, len(size))):
        least = smaller(least, size[k])
    return 0.5 * least


@ti.func
def beyond(boundary: ti.template(), place: ti.template(), size: ti.template()):
    """Tell whether a place lies outside the world."""
    out = place[0] > size[0]
    if ti.static(box.rounded(boundary)):
        off, radius = from_middle(place, size), radius_of(size)
        out = dot(off, off) > radius * radius
    else:
        for k in ti.static(range(1, len(size))):
            out = out | (place[k] > size[k])
    return out


@ti.func
def reversed_across(line: ti.template(), rate: ti.template(), out):
    """Reverse the part of a velocity along a unit vector, where `out` is 1."""
    along = 2.0 * out * dot(rate, line)
    return [v - along * u for v, u in ti.static(zip(rate, line, strict=True))]


@ti.func
def reflection(place: ti.template(), rate: ti.template(), size: ti.template()):
    """Give the unit vector outward, how far from the middle a place is mirrored at the circle, and 1 where it is to be.

    In one list, the last one 1 where the velocity leads outward there, too. Whoever is beyond twice the circle, in one step,
    ends at the far side: nobody is outside after a tick.
    """
    off, radius = from_middle(place, size), radius_of(size)
    distance = ti.sqrt(dot(off, off))
    line = scaled(off, 1.0 / ti.sqrt(safe(dot(off, off))))
    out = ti.select(distance > radius, 1.0, 0.0)
    leaves = ti.select(dot(rate, line) > 0.0, out, 0.0)
    return line + [larger(2.0 * radius - distance, 0.0 - radius), out, leaves]  # noqa: RUF005 - Taichi knows no stars in lists


@ti.func
def confine(boundary: ti.template(), place: ti.template(), rate: ti.template(), size: ti.template(), radius):
    """Keep a body inside the world, in place. place, rate, size: lists, one number an axis; radius: of the body [m].

    Walls stop bodies; the circle of a disc mirrors the centres' places, and reverses what of the velocity leads through it.
    """
    if ti.static(box.rounded(boundary)):
        dim = ti.static(len(size))
        found = reflection(place, rate, size)
        line = [found[k] for k in ti.static(range(dim))]
        turned = reversed_across(line, rate, found[dim + 2])
        for k in ti.static(range(dim)):
            place[k] = ti.select(found[dim + 1] > 0.5, 0.5 * size[k] + found[dim] * line[k], place[k])
            rate[k] = turned[k]
    for k in ti.static(range(len(size))):
        if ti.static(box.wraps(boundary)):
            place[k] = wrap(place[k], size[k])
        if ti.static(box.walled(boundary)):
            within = clamp(place[k], size[k], radius)
            outward = (place[k] < within) & (rate[k] < 0.0) | (place[k] > within) & (rate[k] > 0.0)
            rate[k] = ti.select(outward, 0.0, rate[k])
            place[k] = within
