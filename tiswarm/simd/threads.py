"""Threads: how many this process may use, and whether so many can be had at all."""

import mmap
import os
import threading

MOST_THREADS = 1024

RESERVED = 3 << 30
"""What Taichi takes beside its threads' stacks: a pool of 1 GiB, arenas for what threads allocate, the compiler [bytes]."""


def available_threads() -> int:
    """Count the CPUs that this process may use (fewer than the machine has under a cpuset or taskset)."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def check_threads(count: int) -> None:
    """Raise ValueError for threads that Taichi would wait for without end, since the system grants no room for them.

    More threads than CPUs are begun once and ended again: what limits them (memory, processes, a container) has many places.
    """
    if not 1 <= count <= MOST_THREADS:
        raise ValueError(f"threads: {count} is not possible; use 1 to {MOST_THREADS}")
    if count <= available_threads() or os.name != "posix":
        return
    release = threading.Event()
    begun: list[threading.Thread] = []
    try:
        with mmap.mmap(-1, RESERVED, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, mmap.PROT_READ):
            for _ in range(count):
                thread = threading.Thread(target=release.wait, daemon=True)
                thread.start()
                begun.append(thread)
    except (OSError, RuntimeError):
        raise ValueError(f"threads: {count} do not fit into the limits of this process{_limit()}; use fewer") from None
    finally:
        release.set()
        for thread in begun:
            thread.join()


def _limit() -> str:
    import resource

    most = resource.getrlimit(resource.RLIMIT_AS)[0]
    return "" if most == resource.RLIM_INFINITY else f", {most / 2**30:.1f} GiB of memory"
