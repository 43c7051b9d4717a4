"""Launch: run a kernel, in the runtime that it was built for; and run one again and again on the same arrays.

Taichi 1.7.4 spends some 25 µs a call on every array it is given, several times what it takes to wake the threads. A prepared
launch makes the call's description once and keeps it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from taichi import u32
from taichi.lang import impl

from tiswarm.simd import backend, runtime
from tiswarm.simd.runtime import Precision


def run(kernel: Any, *arguments: Any, precision: Precision | None = None) -> None:
    """Run a kernel once. precision: what its arrays were made in. Errors: as runtime.held."""
    with runtime.held(precision):
        runtime.check_choices()
        kernel(*arguments)


def prepared(kernel: Any, *arguments: np.ndarray | int, precision: Precision | None) -> Callable[..., None]:
    """Give what runs a kernel on these arrays (contiguous ones, which stay where they are) and whole numbers.

    It takes new values for the last of the numbers; a kernel's templates come last, as bool. precision: what the arrays were
    made in, None where it does not matter. Errors, of what is given: as runtime.held.
    """
    bound: Callable[..., None]
    of = -1

    def launch(*last: int) -> None:
        nonlocal bound, of
        with runtime.held(precision):
            if of != runtime.generation():  # Taichi was started anew, and with it went all that it had compiled
                runtime.check_choices()
                bound, of = _bound(kernel, arguments), runtime.generation()
            bound(*last)

    return launch


def _bound(kernel: Any, arguments: tuple[np.ndarray | int, ...]) -> Callable[..., None]:
    if backend.name() != "taichi":  # Quadrants keeps descriptions itself
        return lambda *last: kernel(*arguments[: len(arguments) - len(last)], *last)
    primal = kernel._primal
    built = primal.compiled_kernels[primal.ensure_compiled(*arguments)]
    call = built.make_launch_context()
    for at, (value, about) in enumerate(zip(arguments, primal.arguments, strict=True)):
        if isinstance(value, np.ndarray):
            shape = value.shape[: value.ndim - getattr(about.annotation.dtype, "ndim", 0)]  # of vectors, not of numbers
            call.set_arg_external_array_with_shape((at,), value.ctypes.data, value.nbytes, shape, 0)
        elif about.annotation == u32:
            call.set_arg_uint((at,), value)
        elif not isinstance(value, bool):
            call.set_arg_int((at,), value)
    program = impl.get_runtime().prog
    compiled = program.compile_kernel(program.config(), program.get_device_caps(), built)

    def launch(*last: int) -> None:
        for at, value in enumerate(last, len(arguments) - len(last)):
            call.set_arg_int((at,), value)
        program.launch_kernel(compiled, call)

    return launch
