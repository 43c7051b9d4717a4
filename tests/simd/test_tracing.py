"""Tracing: Taichi's walk through a kernel's source still names the place of an error, reads each source once, copies once."""

import ast
import subprocess
import sys

import numpy as np
import pytest
import taichi as ti
from taichi.lang import impl, kernel_impl

from tiswarm.simd import runtime, tracing

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


def test_each_source_is_read_once(monkeypatch):
    read = []
    monkeypatch.setattr(kernel_impl, "getsourcelines", tracing._once(lambda func: read.append(func) or ([], 1)))

    def builder(number):
        def func():
            return number

        return func

    for number in range(3):
        assert kernel_impl.getsourcelines(builder(number)) == ([], 1)
    assert len(read) == 1


def test_equal_code_of_two_files_is_read_twice():
    reading = tracing._once(lambda func: func.__code__.co_filename)
    funcs = [{}, {}]
    for name, scope in zip(("a.py", "b.py"), funcs, strict=True):
        exec(compile("def func(): return 1", name, "exec"), scope)
    assert [reading(scope["func"]) for scope in funcs] == ["a.py", "b.py"]


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


@pytest.mark.parametrize("first", ["taichi", "tiswarm", "tiswarm.engine.trials.batch", "render.films"])
def test_taichi_is_lightened_whoever_imports_it_first(first):
    code = f"import {first}, tiswarm, taichi.lang.kernel_impl as reader; print(reader._inside_class.__module__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split()[-1] == "tiswarm.simd.tracing"


def test_a_tree_is_lent_to_one_walk_at_a_time_and_comes_back_clean():
    trees, source = tracing.Trees(), "def func(a):\n    return a.b(a)"
    one, other = trees.take(source), trees.take(source)
    assert one is not other
    as_parsed = ast.dump(one)
    one.body[0].args.args = []
    for node in ast.walk(one):
        node.ptr = node.caller = "found"
    trees.put(one)
    assert trees.take(source) is one
    assert ast.dump(one) == as_parsed
    assert not any(hasattr(node, "ptr") or hasattr(node, "caller") for node in ast.walk(one))


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
