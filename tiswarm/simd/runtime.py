"""Start Taichi once per process: precision, threads, kernel cache, and the types that kernels are built from."""

import os
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from typing import Any, Literal

import numpy as np

Precision = Literal["f32", "f64"]

Func = Callable[..., Any]
"""A func or kernel of Taichi, or what builds one: typed by how it is called."""

LANES = 8
"""Trials (or agents) that one thread carries in lock-step; 8 beat 4 and 16 (CONTRIBUTING, "How a kernel becomes fast")."""

TASK = 512
"""Taichi deals a parallel loop out to threads 512 iterations at a time, whatever `block_dim` says: a loop whose iterations
are whole blocks of work runs over `blocks * TASK` and acts on every TASK-th index."""


MOST_THREADS = 1024


@dataclass(frozen=True)
class Settings:
    """What one Taichi runtime was started with."""

    precision: Precision
    threads: int


_settings: Settings | None = None
_generation = 0


def init(precision: Precision = "f32", threads: int | None = None) -> None:
    """Start Taichi on the CPU, or start it anew when the settings differ from the running ones.

    precision: "f32" (fast) or "f64" (conformance).
    threads: CPU threads, all of them when None. Results are the same bits at any number.

    Errors: ValueError for an unknown precision or a number of threads that cannot be.
    """
    global _settings, _generation
    if precision not in ("f32", "f64"):
        raise ValueError(f"precision: {precision!r} is not known; use 'f32' or 'f64'")
    if threads is not None and not 1 <= threads <= MOST_THREADS:
        raise ValueError(f"threads: {threads} is not possible; use 1 to {MOST_THREADS}")
    wanted = Settings(precision, threads or available_threads())
    if wanted == _settings:
        return
    os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "False")
    import taichi as ti

    # fast_math off keeps results exact and repeatable. real_matrix_scalarize off hands vectors of lanes to LLVM whole, as
    # <8 x float>, which compiles in a third of the time that lanes unrolled into scalars take, to better code. Taichi's own
    # advanced_optimization takes a stored lane and a loaded vector for strangers and would drop the refill's stores; LLVM
    # does that work again anyway, and right.
    with redirect_stdout(StringIO()):  # Taichi prints a banner
        ti.init(
            arch=ti.cpu,
            default_fp=ti.f32 if precision == "f32" else ti.f64,
            cpu_max_num_threads=wanted.threads,
            fast_math=False,
            real_matrix_scalarize=False,
            advanced_optimization=False,
            log_level=ti.ERROR,
        )
    _settings = wanted
    _generation += 1


def available_threads() -> int:
    """Count the CPUs that this process may use (fewer than the machine has under a cpuset or taskset)."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def start() -> Settings:
    """Start Taichi with the defaults unless it runs already; return its settings."""
    if _settings is None:
        init()
    assert _settings is not None
    return _settings


def generation() -> int:
    """Count the runtimes of this process so far: kernels built under an earlier one are gone."""
    start()
    return _generation


@dataclass(frozen=True)
class Types:
    """What kernels of the running precision are built from.

    real, dtype: a number in Taichi and in NumPy; lanes, integer_lanes: LANES of them in one value;
    lane_array(n): a kernel argument of `lanes` with n indices.
    """

    real: Any
    dtype: Any
    lanes: Any
    integer_lanes: Any
    lane_array: Callable[[int], Any]


def types() -> Types:
    """Give the types that kernels of the running precision are built from."""
    import taichi as ti

    double = start().precision == "f64"
    real: Any = ti.f64 if double else ti.f32
    lanes = ti.types.vector(LANES, real)
    return Types(
        real=real,
        dtype=np.float64 if double else np.float32,
        lanes=lanes,
        integer_lanes=ti.types.vector(LANES, ti.u32),
        lane_array=lambda n: ti.types.ndarray(dtype=lanes, ndim=n),
    )


def aligned(shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    """Allocate zeros at a 64-byte boundary, which whole-vector loads of lanes need and NumPy does not promise."""
    bytes_needed = int(np.prod(shape)) * np.dtype(dtype).itemsize
    buffer = np.zeros(bytes_needed + 64, np.uint8)
    offset = -buffer.ctypes.data % 64
    return buffer[offset : offset + bytes_needed].view(dtype).reshape(shape)
