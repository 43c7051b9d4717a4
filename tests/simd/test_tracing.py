"""Tracing: Taichi's walk through a kernel's source still names the place of an error, and reads each source once."""

import subprocess
import sys

import pytest
import taichi as ti
from taichi.lang import kernel_impl

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

    with pytest.raises(ti.TaichiCompilationError, match=r"(?s)test_tracing\.py.*line 20.*not_defined_anywhere") as told:
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
    code = (
        f"import {first}, tiswarm, taichi.lang.kernel_impl as k; print(k._inside_class.__module__, k.getsourcelines.__module__)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split()[-2] == "tiswarm.simd.tracing"
