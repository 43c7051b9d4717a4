"""Tracing: Taichi's walk through a kernel's source still names the place of an error, copies once, and leaves garbage alone."""

import gc
import subprocess
import sys

import numpy as np
import pytest
import taichi as ti
from taichi.lang import impl, kernel_impl

from tiswarm.simd import runtime

pytestmark = pytest.mark.quick


def test_error_names_file_line_and_source():
    runtime.init("f32")

    @ti.func
    def wrong(x):
        return x + not_defined_anywhere  # noqa: F821

    @ti.kernel
    def calls() -> ti.f32:
        return wrong(1.0)

    with pytest.raises(ti.TaichiCompilationError, match=r"(?s)test_tracing\.py.*line 22.*not_defined_anywhere") as told:
        calls()
    assert "in wrong" in str(told.value)


def test_funcs_of_classes_are_known_as_such_without_a_look_at_the_source(monkeypatch):
    runtime.init("f32")
    monkeypatch.setattr(kernel_impl.inspect, "getframeinfo", None)  # what Taichi looks with, at every decorator

    @ti.data_oriented
    class Counter:
        def __init__(self, step):
            self.step = step

        @ti.func
        def next(self, number):
            return number + self.step

        @ti.kernel
        def run(self, number: ti.i32) -> ti.i32:
            return self.next(number)

    @ti.func
    def alone(number):
        return number - 1

    @ti.kernel
    def calls(number: ti.i32) -> ti.i32:
        return alone(number)

    assert Counter(2).run(40) == 42
    assert calls(43) == 42


def test_an_error_within_a_func_names_each_place_once():
    runtime.init("f32")

    @ti.func
    def inner(x):
        return x @ 1

    @ti.func
    def outer(x):
        return inner(x) + 1.0

    @ti.kernel
    def calls() -> ti.f32:
        return outer(1.0)

    with pytest.raises(ti.TaichiCompilationError) as told:
        calls()
    said = str(told.value)
    assert [said.count(f"in {name}:") for name in ("calls", "outer", "inner")] == [1, 1, 1]


def test_garbage_is_collected_again_after_a_walk(monkeypatch):
    runtime.init("f32")
    during = []

    @ti.kernel
    def looks() -> ti.i32:
        ti.static(during.append(gc.isenabled()))
        return 1

    for before in (True, False):
        (gc.enable if before else gc.disable)()
        try:
            kernel_impl.Kernel.materialize(looks._primal, None, (), [])
            looks._primal.compiled_kernels.clear()
            assert gc.isenabled() is before
        finally:
            gc.enable()
    assert during == [False, False]


@pytest.mark.parametrize("first", ["taichi", "tiswarm", "tiswarm.engine.trials.batch", "render.films"])
def test_taichi_is_lightened_whoever_imports_it_first(first):
    code = f"import {first}, tiswarm, taichi.lang.kernel_impl as reader; print(reader._inside_class.__module__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split()[-1] == "tiswarm.simd.tracing"


@ti.func
def _nth(n):
    return n


@ti.func
def _twice(x):
    x += x
    return x


def test_assignments_copy_once_and_mean_what_python_means_by_them(monkeypatch):
    copies, copy = [], impl.expr_init
    monkeypatch.setattr(impl, "expr_init", lambda value: copies.append(value) or copy(value))
    runtime.init("f32")

    @ti.kernel
    def assigns(out: ti.types.ndarray(dtype=ti.f32, ndim=1)):
        a = 1.0
        b = a
        a = a + 1.0  # b keeps its own
        c = d = a
        c = c + 1.0
        c, d = d, c
        out[0] = a
        out[1] = b
        out[2] = c
        out[3] = d
        out[4] = _twice(a)  # whose argument stays
        out[_nth(5)] = a
        lengths = [a, b]
        lengths[0] = lengths[1]
        out[6] = lengths[0]
        out[7] = a

    out = np.zeros(8, np.float32)
    assigns(out)
    assert out.tolist() == [2, 1, 2, 3, 4, 2, 1, 2]

    @ti.kernel
    def once() -> ti.f32:
        x = 1.0
        x = x + 1.0
        return 2.0 * x

    copies.clear()
    assert once() == 4
    assert len(copies) == 1
