"""Machine: what a figure was measured on."""

import platform
from pathlib import Path

import numpy as np

WIDE = {512: ("AVX512", "X86_V4"), 256: ("AVX2", "X86_V3")}
"""Names by which NumPy's versions know wide vectors, by their width [bit]."""


def processor() -> str:
    """Name the processor as its maker does, or as Python knows it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


def vector_bits() -> int:
    """Give the width of this processor's widest vectors [bit], of those that NumPy looks for."""
    config = np.show_config(mode="dicts") or {}
    known = config.get("SIMD Extensions", {})
    found = [*known.get("baseline", []), *known.get("found", [])]
    return next((bits for bits, names in WIDE.items() if any(each.startswith(names) for each in found)), 128)


def machine() -> str:
    """Say what a figure was measured on, in a few words."""
    return f"{processor()}, vectors of {vector_bits()} bits"
