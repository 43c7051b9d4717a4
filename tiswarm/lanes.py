"""Lanes: what a term may use on its numbers, each of which is a short vector, one trial (or agent) a lane."""

import taichi as ti

TINY = 1e-12
"""Keeps quotients finite where two points coincide; far below any squared distance that matters [m²]."""


@ti.func
def anywhere(mask):
    """Tell whether a mask holds in any lane. Compiles to one movmskps and a branch; Taichi's own any() looks at lane 0 only."""
    return ti.select(mask, 1, 0).sum() > 0


@ti.func
def larger(a, b):
    """Give the larger number; ti.max also sorts out NaN, which costs three instructions instead of one."""
    return ti.select(a > b, a, b)


@ti.func
def near(distance2, reach):
    """Give 1 where a squared distance is within reach (the edge included), else 0."""
    return ti.select(distance2 <= reach * reach, 1.0, 0.0)


@ti.func
def safe(distance2):
    """Keep a squared distance away from zero, so that a quotient stays finite."""
    return larger(distance2, TINY)


@ti.func
def capped(x, y, most):
    """Shorten (x, y) to at most `most`."""
    scale = most / ti.sqrt(larger(x * x + y * y, most * most))
    return scale * x, scale * y


@ti.func
def unit(x, y):
    """Give (x, y) the length one; zero stays zero."""
    scale = 1.0 / ti.sqrt(safe(x * x + y * y))
    return scale * x, scale * y
