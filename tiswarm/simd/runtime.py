"""Runtime: Taichi on a CPU, started once for a process: precision, threads, and the kernels built for it.

A process has one Taichi. Whoever else starts it in the same process ends ours with all that it had compiled; this is noticed
before every launch, and ours is started anew. What was built is forgotten then, and built again when it is asked for.
"""

import ctypes
import gc
import os
import sys
import threading
import warnings
import weakref
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from typing import Any, Literal

import numpy as np

from tiswarm.simd import backend, kernel_cache, width
from tiswarm.simd.threads import available_threads, check_threads

Precision = Literal["f32", "f64"]

Func = Callable[..., Any]
"""A func or kernel of Taichi, or what builds one: typed by how it is called."""

LANES = width.lanes()
"""Trials (or agents) that one thread carries in lock-step: 8, or 16 where vectors are wide enough (width.py)."""

EIGHT = 8
"""Numbers in which sums over the agents of a swarm are kept on every machine, so that their order is everywhere the same."""

TASK = 512
"""Taichi deals a parallel loop out to threads 512 iterations at a time, whatever `block_dim` says: a loop whose iterations
are whole blocks of work runs over `blocks * TASK` and acts on every TASK-th index."""

MOST_COMPILED = 48
"""With so many kernels compiled Taichi is started anew before more are built: it frees none by itself, some MiB each."""

MOST_KEPT = 512 << 20
"""Bytes of compiled kernels that are kept on disk, the latest used of them: some 2 000. Taichi keeps 100 MiB if it is not told:
a study of many strategies needs more, and so do the tests; kernels were thrown away before they were asked for again."""


@dataclass(frozen=True)
class Settings:
    """What one Taichi runtime was started with."""

    precision: Precision
    threads: int


_settings: Settings | None = None
_generation = 0
_impl: Any = None  # the module of Taichi's that knows the running one, once it is imported
_own: Any = None  # what it knew when we had started it
_chosen: tuple[Any, ...] = ()  # what our results depend on, as it was then
_kept: dict[Hashable, Any] = {}
_forked = False
_lock = threading.RLock()


def init(precision: Precision = "f32", threads: int | None = None) -> None:
    """Start Taichi on the CPU, or start it anew when the settings differ from the running ones.

    precision: "f32" (fast) or "f64" (conformance).
    threads: CPU threads, all of them when None. Results are the same bits at any number.

    Errors: ValueError for an unknown precision or a number of threads that cannot be; RuntimeError in a forked process, or
    without memory for Taichi.
    """
    wanted = settings_of(precision, threads)
    with _lock:
        if wanted != _settings or not _running():
            check_threads(wanted.threads)
            _begin(wanted)


def settings_of(precision: Precision, threads: int | None) -> Settings:
    """Give the settings that are asked for. Errors: ValueError for an unknown precision."""
    if precision not in ("f32", "f64"):
        raise ValueError(f"precision: {precision!r} is not known; use 'f32' or 'f64'")
    return Settings(precision, available_threads() if threads is None else threads)


def _begin(wanted: Settings) -> None:
    """Start Taichi, whatever runs."""
    global _settings, _generation, _impl, _own, _chosen
    _refuse_forks()
    backend.name()
    kernel_cache.ensure_home()
    os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "False")
    import taichi as ti
    from taichi.lang import impl

    _impl = impl
    if backend.program(impl.get_runtime()) is not None and not _running():
        _tell(
            "another part of this process had started Taichi, of which a process has one: it is started anew for tiswarm, and "
            "fields and kernels made before are gone; run your own Taichi in another process"
        )
    _forget()
    folder, keeping, told = kernel_cache.choose()
    keeping = keeping and os.environ.get("TI_OFFLINE_CACHE", "") != "0"
    if told and _generation == 0:
        _tell(told)
    # fast_math off keeps results exact and repeatable. real_matrix_scalarize off hands vectors of lanes to LLVM whole, as
    # <8 x float>, which compiles in a third of the time that lanes unrolled into scalars take, to better code. Taichi's own
    # advanced_optimization takes a stored lane and a loaded vector for strangers and would drop the refill's stores; LLVM
    # does that work again anyway, and right.
    _own = None
    with redirect_stdout(StringIO()), _undisturbed():  # Taichi prints a banner
        try:
            ti.init(
                arch=ti.cpu,
                default_fp=ti.f32 if wanted.precision == "f32" else ti.f64,
                default_ip=ti.i32,
                cpu_max_num_threads=wanted.threads,
                fast_math=False,
                real_matrix_scalarize=False,
                advanced_optimization=False,
                offline_cache=keeping,
                offline_cache_file_path=folder,
                offline_cache_max_size_of_files=MOST_KEPT,
                log_level=ti.ERROR,
            )
        except RuntimeError as error:
            told = " ".join(str(error).split())
            raise RuntimeError(f"Taichi cannot be started: {told}; allow more memory, or fewer threads") from None
    impl.get_runtime().materialize()  # Taichi wants this from the thread that started it; launches may come from any
    _settings, _own, _chosen = wanted, impl.get_runtime(), _choices()
    _generation += 1


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Hide variables that Taichi takes settings from, on some of which results depend (TI_DEBUG, TI_ARCH, ...)."""
    hidden = {name: value for name, value in os.environ.items() if name.startswith("TI_")}
    for name in hidden:
        del os.environ[name]
    try:
        yield
    finally:
        os.environ.update(hidden)


def _choices() -> tuple[Any, ...]:
    """Give the settings of the running Taichi that results depend on."""
    config = _impl.current_cfg()
    names = ("fast_math", "real_matrix_scalarize", "advanced_optimization", "default_fp", "default_ip", "opt_level", "debug")
    return (_impl.get_runtime().default_fp, _impl.get_runtime().default_ip, *(getattr(config, name) for name in names))


def _running() -> bool:
    """Tell whether the Taichi that runs is the one that we started."""
    return _own is not None and _impl.get_runtime() is _own


def _forget() -> None:
    """Let go of all that was built, and of Taichi's own list of kernels those that nobody holds any more."""
    _kept.clear()
    known = _impl.get_runtime().kernels
    held = [weakref.ref(kernel) for kernel in known]
    known.clear()
    gc.collect()
    known.extend(kernel for each in held if (kernel := each()) is not None)


def _tell(line: str) -> None:
    """Warn in one line."""
    warnings.warn_explicit(line, RuntimeWarning, "tiswarm", 0)


def start() -> Settings:
    """Start Taichi unless it runs and is ours: with the defaults, or as we had started it; return its settings."""
    with _lock:
        _refuse_forks()
        if _settings is None:
            init()
        elif not _running():
            _begin(_settings)
        assert _settings is not None
        return _settings


def generation() -> int:
    """Count the runtimes of this process so far: kernels built under an earlier one are gone."""
    start()
    return _generation


@contextmanager
def held(precision: Precision | None = None) -> Iterator[None]:
    """Keep Taichi for the caller alone, ours, while something is built or runs.

    precision: what arrays at hand were made in, None where it does not matter.

    Errors: RuntimeError where Taichi was started in another precision since.
    """
    with _lock:
        if precision not in (None, start().precision):
            assert _settings is not None
            told = f"was begun in {precision}, and Taichi runs in {_settings.precision} now"
            raise RuntimeError(f"this trial or swarm {told}: begin it anew, or call tiswarm.init({precision!r})")
        yield


def check_choices() -> None:
    """Start Taichi anew where somebody has changed settings of ours in place; before anything is compiled."""
    if _choices() != _chosen:
        assert _settings is not None
        _begin(_settings)


def kept(key: Hashable, build: Callable[[], Any]) -> Any:
    """Give what `build` makes for a key, made once in a runtime: kernels, or funcs that kernels are made of."""
    with held():
        if key not in _kept:
            if _own.get_num_compiled_functions() >= MOST_COMPILED:
                assert _settings is not None
                _begin(_settings)
            _kept[key] = build()
        return _kept[key]


def _after_fork() -> None:
    """Remember in a child that its Taichi lost its threads, and free the lock that one of the process's may have held."""
    global _forked, _lock
    _lock = threading.RLock()
    impl = sys.modules.get("taichi.lang.impl")
    program = impl and backend.program(impl.get_runtime())
    if program is not None:
        _forked = True
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(program))  # never freed: that would wait for its threads for ever


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


def _refuse_forks() -> None:
    if _forked:
        raise RuntimeError(
            "this process was forked from one in which Taichi ran, whose threads a fork does not keep; start it by 'spawn': "
            "multiprocessing.get_context('spawn')"
        )


@dataclass(frozen=True)
class Types:
    """What kernels of the running precision are built from.

    real, dtype: a number in Taichi and in NumPy; lanes, integer_lanes: LANES of them in one value; eight: EIGHT of them;
    lane_array(n), eight_array: kernel arguments of `lanes` with n indices, of `eight` with one.
    """

    real: Any
    dtype: Any
    lanes: Any
    integer_lanes: Any
    eight: Any
    lane_array: Callable[[int], Any]
    eight_array: Any


def types() -> Types:
    """Give the types that kernels of the running precision are built from."""
    import taichi as ti

    double = start().precision == "f64"
    real: Any = ti.f64 if double else ti.f32
    lanes, eight = ti.types.vector(LANES, real), ti.types.vector(EIGHT, real)
    return Types(
        real=real,
        dtype=np.float64 if double else np.float32,
        lanes=lanes,
        integer_lanes=ti.types.vector(LANES, ti.u32),
        eight=eight,
        lane_array=lambda n: ti.types.ndarray(dtype=lanes, ndim=n),
        eight_array=ti.types.ndarray(dtype=eight, ndim=1),
    )


def aligned(shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    """Allocate zeros at a boundary of lanes in f64, which whole-vector loads need and NumPy does not promise."""
    bytes_needed = int(np.prod(shape)) * np.dtype(dtype).itemsize
    wide = LANES * 8
    buffer = np.zeros(bytes_needed + wide, np.uint8)
    offset = -buffer.ctypes.data % wide
    return buffer[offset : offset + bytes_needed].view(dtype).reshape(shape)
