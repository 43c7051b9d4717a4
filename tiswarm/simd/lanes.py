"""Lanes: what a term may use on its numbers, each of which is a short vector, one trial (or agent) a lane.

A place, a velocity or a way is a list of two or three such numbers, one for each axis of the world; structs hold them as x, y
and z. Lists are Python's: unrolled when a kernel is compiled, changed in place element by element, never assigned anew.
"""

from types import SimpleNamespace

import taichi as ti

from tiswarm.simd.runtime import LANES
from tiswarm.simd.width import WIDE

TINY = 1e-12
"""Keeps quotients finite where two points coincide; far below any squared distance that matters [m²]."""

NOTHING = -0.0 if LANES == WIDE else 0.0
"""What lanes that are left out add to a sum that began at 0: the same bits either way, since such a sum is never -0.0. To add
-0.0 changes no number at all, so that LLVM leaves those lanes out by masks of AVX-512, one instruction instead of two; with
AVX2 a mask turns numbers into 0.0 by one instruction, and into -0.0 by more."""

APART = True
"""`if APART:` gives statements a block of their own, which is folded away again. Taichi looks for each statement that it lowers
in all of its block, so that the time for a block of many strategies, one after the other, grows with their square."""


class Bundle(SimpleNamespace):
    """Values and arrays that funcs hand on together: made inside kernels, read there by name, never assigned to."""

    _data_oriented = True  # a kernel may give it a name
    _is_taichi_function = False  # a kernel may make one without a warning

    def of(self, name: str) -> object:
        """Give one of the values by its name."""
        return getattr(self, name)

    of._is_taichi_function = False  # type: ignore[attr-defined]


def coordinates(agent) -> list:
    """List x, y and, in three dimensions, z of a struct; inside kernels under `ti.static`, or as `place`."""
    return [getattr(agent, axis) for axis in ("x", "y", "z") if axis in agent.keys]


def rates(agent) -> list:
    """List vx, vy and, in three dimensions, vz of a struct."""
    return [getattr(agent, axis) for axis in ("vx", "vy", "vz") if axis in agent.keys]


def components(struct, name: str) -> list:
    """List NAME_x, NAME_y and, in three dimensions, NAME_z of a struct: what notes call "NAME*"."""
    return [getattr(struct, f"{name}_{axis}") for axis in "xyz" if f"{name}_{axis}" in struct.keys]


@ti.func
def place(agent: ti.template()):
    """Give where something is; an element may be assigned to."""
    return ti.static(coordinates(agent))


@ti.func
def motion(agent: ti.template()):
    """Give an agent's velocity; an element may be assigned to."""
    return ti.static(rates(agent))


@ti.func
def vector(struct: ti.template(), name: ti.template()):
    """Give NAME_x, NAME_y, ... of a struct; an element may be assigned to."""
    return ti.static(components(struct, name))


@ti.func
def bounded(row):
    """Give a row of a block's array, which is below 2³⁰, so that LLVM knows it.

    Then it folds k into the address of `array[row + k]`, which saves two instructions a load: it must not wrap around. The
    numbers an agent has must be odd, too; an even row makes LLVM write row | k, which no address can hold.
    """
    return row & 0x3FFFFFFF


@ti.func
def row_of(index, height: ti.template()):
    """Give the first row of the index-th agent (or obstacle), each of whom has `height`."""
    return bounded(index * height)


@ti.func
def anywhere(mask):
    """Tell whether a mask holds in any lane. Compiles to one movmskps and a branch; Taichi's own any() looks at lane 0 only."""
    return ti.select(mask, 1, 0).sum() > 0


@ti.func
def larger(a, b):
    """Give the larger number; ti.max also sorts out NaN, which costs three instructions instead of one."""
    return ti.select(a > b, a, b)


@ti.func
def smaller(a, b):
    """Give the smaller number."""
    return ti.select(a < b, a, b)


@ti.func
def near(distance2, reach):
    """Give 1 where a squared distance is within reach (the edge included), else 0."""
    return ti.select(distance2 <= reach * reach, 1.0, 0.0)


@ti.func
def safe(distance2):
    """Keep a squared distance away from zero, so that a quotient stays finite."""
    return larger(distance2, TINY)


@ti.func
def dot(a, b):
    """Give the scalar product."""
    total = a[0] * b[0]
    for k in ti.static(range(1, len(a))):
        total += a[k] * b[k]
    return total


@ti.func
def plus(a, b):
    """Give a + b."""
    return [p + q for p, q in ti.static(zip(a, b, strict=True))]


@ti.func
def minus(a, b):
    """Give a - b."""
    return [p - q for p, q in ti.static(zip(a, b, strict=True))]


@ti.func
def scaled(a, factor):
    """Give factor · a."""
    return [factor * p for p in ti.static(a)]


@ti.func
def capped(a, most):
    """Shorten a to at most `most`."""
    scale = most / ti.sqrt(larger(dot(a, a), most * most))
    return scaled(a, scale)


@ti.func
def unit(a):
    """Give a the length one; zero stays zero."""
    scale = 1.0 / ti.sqrt(safe(dot(a, a)))
    return scaled(a, scale)


# What lanes have no instruction for, one lane after the other: a call of the C library each, so once an agent, not once a pair.


@ti.func
def heading(y, x):
    """Give the angle of (x, y), -π to π [rad]."""
    return ti.Vector([ti.atan2(y[lane], x[lane]) for lane in ti.static(range(LANES))])


@ti.func
def cosine(angle):
    """Give the cosine of an angle [rad]."""
    return ti.Vector([ti.cos(angle[lane]) for lane in ti.static(range(LANES))])


@ti.func
def sine(angle):
    """Give the sine of an angle [rad]."""
    return ti.Vector([ti.sin(angle[lane]) for lane in ti.static(range(LANES))])


@ti.func
def logarithm(number):
    """Give the natural logarithm of a positive number."""
    return ti.Vector([ti.log(number[lane]) for lane in ti.static(range(LANES))])
