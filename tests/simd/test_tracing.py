"""Tracing: Taichi's walk through a kernel's source still names the place of an error, and reads each source once."""

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

    with pytest.raises(ti.TaichiCompilationError, match=r"(?s)test_tracing\.py.*line 17.*not_defined_anywhere") as told:
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
