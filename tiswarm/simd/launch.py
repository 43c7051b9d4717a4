"""Launch: a kernel that runs again and again on the same arrays, without Taichi's look at each of them every time.

Taichi 1.7.4 spends some 25 µs a call on every array it is given, several times what it takes to wake the threads. Here the
call's description is made once and kept.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from taichi.lang import impl

from tiswarm.simd import runtime


def prepared(kernel: Any, *arguments: np.ndarray | int) -> Callable[..., None]:
    """Give what runs a kernel on these arrays (contiguous ones, which stay where they are) and whole numbers.

    It takes new values for the last of the numbers.
    """
    bound, of = _bound(kernel, arguments), runtime.generation()

    def run(*last: int) -> None:
        nonlocal bound, of
        if of != runtime.generation():  # Taichi was started anew, and with it went all that it had compiled
            bound, of = _bound(kernel, arguments), runtime.generation()
        bound(*last)

    return run


def _bound(kernel: Any, arguments: tuple[np.ndarray | int, ...]) -> Callable[..., None]:
    primal = kernel._primal
    built = primal.compiled_kernels[primal.ensure_compiled(*arguments)]
    call = built.make_launch_context()
    for at, (value, about) in enumerate(zip(arguments, primal.arguments, strict=True)):
        if isinstance(value, np.ndarray):
            shape = value.shape[: value.ndim - getattr(about.annotation.dtype, "ndim", 0)]  # of vectors, not of numbers
            call.set_arg_external_array_with_shape((at,), value.ctypes.data, value.nbytes, shape, 0)
        else:
            call.set_arg_int((at,), value)
    program = impl.get_runtime().prog
    compiled = program.compile_kernel(program.config(), program.get_device_caps(), built)

    def launch(*last: int) -> None:
        for at, value in enumerate(last, len(arguments) - len(last)):
            call.set_arg_int((at,), value)
        program.launch_kernel(compiled, call)

    return launch
