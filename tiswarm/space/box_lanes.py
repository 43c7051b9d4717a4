"""Box lanes: ways and places in the world, as box.py has them in NumPy: along one axis, of lanes or of single numbers."""

import taichi as ti

from tiswarm.simd.lanes import components, larger, smaller
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
def confine(boundary: ti.template(), place: ti.template(), rate: ti.template(), size: ti.template(), radius):
    """Keep a body inside the world, in place. place, rate, size: lists, one number an axis; radius: of the body [m]."""
    for k in ti.static(range(len(size))):
        if ti.static(box.wraps(boundary)):
            place[k] = wrap(place[k], size[k])
        if ti.static(box.walled(boundary)):
            within = clamp(place[k], size[k], radius)
            outward = (place[k] < within) & (rate[k] < 0.0) | (place[k] > within) & (rate[k] > 0.0)
            rate[k] = ti.select(outward, 0.0, rate[k])
            place[k] = within
