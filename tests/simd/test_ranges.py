"""Ranges: loops of our kernels mean what Python's mean, and those of many turns, or of unknown many, are built as steps."""

import numpy as np
import pytest
import taichi as ti
from taichi.lang import impl

from tiswarm.simd import runtime

pytestmark = pytest.mark.quick


@ti.func
def _sum_to(n):
    total = 0
    for i in range(n):
        if i == 3:
            continue
        if i == 7:
            break
        total += i
    return total


def _summing():
    def sums(out: ti.types.ndarray(dtype=ti.i32, ndim=1), first: ti.i32, last: ti.i32):
        for index in range(4):
            out[3 * index] = _sum_to(last)
            count = 0
            for i in range(first, last):
                for j in range(i, last):
                    count += 10 * i + j
                for _ in range(2):  # few and known, for LLVM to unroll
                    count += 1
                for k in range(5, 40):  # known, and many
                    count += k
            out[3 * index + 1] = count
            for i in range(last, first):
                count += i
            out[3 * index + 2] = count

    return sums


def _by_hand(first, last):
    count = sum(10 * i + j for i in range(first, last) for j in range(i, last)) + (2 + sum(range(5, 40))) * len(
        range(first, last)
    )
    return [sum(i for i in range(min(last, 7)) if i != 3), count, count + sum(range(last, first))]


@pytest.fixture
def whiles(monkeypatch):
    """The loops that are built as steps, one entry each."""
    built, begin = [], impl._ti_core.ASTBuilder.begin_frontend_while
    monkeypatch.setattr(impl._ti_core.ASTBuilder, "begin_frontend_while", lambda *given: built.append(1) or begin(*given))
    return built


@pytest.mark.parametrize("bounds", [(0, 5), (2, 12), (-3, 2), (4, 4), (9, 1), (0, 0)])
@pytest.mark.parametrize(("module", "loops"), [("tiswarm.engine.made", 5), ("a_users", 0)])
def test_loops_are_pythons_and_only_ours_are_stepped(bounds, module, loops, whiles):
    runtime.init("f32")
    plain = _summing()
    plain.__module__ = module
    out = np.zeros(12, np.int32)
    ti.kernel(plain)(out, *bounds)
    assert out.reshape(4, 3).tolist() == [_by_hand(*bounds)] * 4
    assert len(whiles) == loops


def test_under_an_index_that_may_be_negative_nothing_is_stepped(whiles):
    """Whose sign would turn the stride around."""
    runtime.init("f32")

    def sums(out: ti.types.ndarray(dtype=ti.i32, ndim=1), count: ti.i32):
        for index in range(-2, 2):
            for i in range(count):
                out[index + 2] += i

    sums.__module__ = "tiswarm.engine.made"
    out = np.zeros(4, np.int32)
    ti.kernel(sums)(out, 5)
    assert out.tolist() == [10] * 4
    assert not whiles
