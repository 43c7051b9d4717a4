# mypy: disable-error-code="valid-type,index,operator"
"""Cells: how many of many points lie in each, counted by a kernel: whole numbers, which no order of threads changes."""

import numpy as np
import taichi as ti

from tiswarm.simd import launch, runtime


@ti.kernel
def _count(
    points: ti.types.ndarray(dtype=ti.f64, ndim=2),
    frame: ti.types.ndarray(dtype=ti.f64, ndim=2),
    counts: ti.types.ndarray(dtype=ti.i32, ndim=2),
):
    for n in range(points.shape[0]):
        x = (points[n, 0] - frame[0, 0]) / frame[1, 0] * frame[2, 0]
        y = (points[n, 1] - frame[0, 1]) / frame[1, 1] * frame[2, 1]
        if x >= 0 and x < frame[2, 0] and y >= 0 and y < frame[2, 1]:  # who is nowhere is not
            ti.atomic_add(counts[ti.cast(y, ti.i32), ti.cast(x, ti.i32)], 1)


def counted(points: np.ndarray, low: np.ndarray, far: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Count points [point, 2] in cells between two corners: [row, column]. cells: columns and rows."""
    runtime.start()
    counts = np.zeros(cells[::-1], np.int32)
    launch.run(_count, np.ascontiguousarray(points, float), np.array([low, far - low, cells], float), counts)
    return counts
