# mypy: disable-error-code="valid-type,index,operator"
"""Cells: how crowded it is in each, counted, spread and turned into steps of a scale by one kernel.

Agents are counted in whole numbers, which no order of threads changes. Spread is down the columns first, in whole numbers, too;
then along the rows, of which each lane of a vector walks a stretch of its own: its neighbours are the vectors before and after.
"""

from collections.abc import Callable
from math import comb

import numpy as np
import taichi as ti

from render.scene.density import BLUR
from render.scene.scale import STEPS
from tiswarm.simd import launch, runtime
from tiswarm.simd.lanes import smaller

LANES, TASK = runtime.LANES, runtime.TASK

HALF, CHUNKS = BLUR // 2, 32
"""So many cells to either side a cell is spread over; rows and points are dealt to threads in so many sets."""

WEIGHTS = [comb(BLUR, k) for k in range(BLUR + 1)]
"""What adding each cell to the next, BLUR times, makes of a cell and its neighbours."""

NUMBERS = 12
"""Of a frame: its low corner and extent [m], columns and rows, points, cells on a square metre, top of the scale, vectors that
hold a row of counts, vectors of a lane's stretch, and where the kernel finds which columns those are of."""

_Whole = ti.types.ndarray(dtype=ti.types.vector(LANES, ti.u32), ndim=1)
_Lanes = ti.types.ndarray(dtype=ti.types.vector(LANES, ti.f32), ndim=1)


@ti.func
def _count(points: ti.template(), frame: ti.template(), counts: ti.template(), chunk: ti.i32):
    """Count a share of the points in their cells."""
    many = ti.cast(frame[6], ti.i32)
    left, low, wide, high, columns, rows = frame[0], frame[1], frame[2], frame[3], frame[4], frame[5]
    stride = ti.cast(frame[9], ti.i32) * LANES
    for n in range(many * chunk // CHUNKS, many * (chunk + 1) // CHUNKS):
        x, y = (points[n, 0] - left) / wide * columns, (points[n, 1] - low) / high * rows
        if x >= 0 and x < columns and y >= 0 and y < rows:  # who is nowhere is not
            ti.atomic_add(counts[ti.cast(y, ti.i32) * stride + ti.cast(x, ti.i32)], ti.u32(1))


@ti.func
def _spread_down(table: ti.template(), whole: ti.template(), line: ti.i32, width: ti.i32, to: ti.i32):
    """Spread counts over the rows of a line of cells."""
    above = [table[line + k] * width for k in ti.static(range(BLUR + 1))]
    for v in range(width):
        total = whole[above[HALF] + v] * ti.u32(WEIGHTS[HALF])
        for k in ti.static(range(HALF)):
            total = total + (whole[above[k] + v] + whole[above[BLUR - k] + v]) * ti.u32(WEIGHTS[k])
        whole[to + v] = total


@ti.func
def _spread_along(lanes: ti.template(), first: ti.i32, stretch: ti.i32, share: ti.f32, top: ti.f32):
    """Spread a line over its columns, and find the steps of the scale, which take the place of what is read no more."""
    for v in range(first, first + stretch):
        total = lanes[v + HALF] * ti.f32(1.0 * WEIGHTS[HALF])
        for k in ti.static(range(HALF)):
            total = total + (lanes[v + k] + lanes[v + BLUR - k]) * ti.f32(1.0 * WEIGHTS[k])
        lanes[v] = ti.sqrt(smaller(total * share / top, ti.f32(1.0))) * ti.f32(STEPS - 1.0) + ti.f32(0.5)


@ti.kernel
def _step(
    points: ti.types.ndarray(dtype=ti.f64, ndim=2),
    frame: ti.types.ndarray(dtype=ti.f64, ndim=1),
    table: ti.types.ndarray(dtype=ti.i32, ndim=1),
    whole: _Whole,
    counts: ti.types.ndarray(dtype=ti.u32, ndim=1),
    lanes: _Lanes,
    numbers: ti.types.ndarray(dtype=ti.f32, ndim=1),
    out: ti.types.ndarray(dtype=ti.i32, ndim=1),
):
    """Find the step of each cell, the uppermost row first. counts and numbers are second views of whole and lanes.

    table: which row of counts each line of cells is made of, with those beyond its ends; then the columns.
    """
    for index in range(CHUNKS * TASK):
        if index % TASK == 0:
            chunk, size = index // TASK, (ti.cast(frame[5], ti.i32) + 1) * ti.cast(frame[9], ti.i32)
            for v in range(size * chunk // CHUNKS, size * (chunk + 1) // CHUNKS):
                whole[v] = whole[v] * ti.u32(0)
    for index in range(CHUNKS * TASK):
        if index % TASK == 0:
            _count(points, frame, counts, index // TASK)
    for index in range(CHUNKS * TASK):
        if index % TASK == 0:
            chunk, columns, rows = index // TASK, ti.cast(frame[4], ti.i32) + 2, ti.cast(frame[5], ti.i32) + 2
            width, stretch, across = ti.cast(frame[9], ti.i32), ti.cast(frame[10], ti.i32), ti.cast(frame[11], ti.i32)
            share, top = ti.cast(frame[7], ti.f32) * ti.f32(0.25**BLUR), ti.cast(frame[8], ti.f32)
            down, first = (rows - 1 + chunk) * width, chunk * (stretch + BLUR)
            for line in range(rows * chunk // CHUNKS, rows * (chunk + 1) // CHUNKS):
                _spread_down(table, whole, line, width, down)
                for n in range((stretch + BLUR) * LANES):
                    numbers[first * LANES + n] = ti.cast(counts[down * LANES + table[across + n]], ti.f32)
                _spread_along(lanes, first, stretch, share, top)
                begin = (rows - 1 - line) * columns
                for lane in range(LANES):
                    for v in range(ti.min(stretch, columns - lane * stretch)):
                        out[begin + lane * stretch + v] = ti.cast(numbers[(first + v) * LANES + lane], ti.i32)


class Cells:
    """Cells over a part of the ground, for one frame after the other."""

    def __init__(self) -> None:
        """Allocate nothing yet."""
        self._frame = np.zeros(NUMBERS)
        self._points = np.zeros((0, 2))
        self._table, self._steps = np.zeros(0, np.int32), np.zeros(0, np.int32)
        self._whole, self._lanes = np.zeros((0, LANES), np.uint32), np.zeros((0, LANES), np.float32)
        self._of: tuple[int, int, str] | None = None
        self._run: Callable[[], None] | None = None

    def steps(
        self, points: np.ndarray, low: np.ndarray, far: np.ndarray, cells: np.ndarray, mode: str, per_area: float, top: float
    ) -> np.ndarray:
        """Give the step of the scale that each cell between two corners has, with a rim of one cell: [row, column] of int32.

        Rows are from far to low. They last until the next call.

        points: [point, 2]. cells: columns and rows. mode: what lies beyond the edge, as np.pad names it. per_area: cells on a
        square metre. top: where the scale ends [agents/m²].
        """
        runtime.start()
        self._divide(int(cells[0]), int(cells[1]), mode)
        if len(points) > len(self._points):
            self._points, self._run = np.zeros((len(points), 2)), None
        self._points[: len(points)] = points
        self._frame[:9] = *low, *(far - low), *cells, len(points), per_area, top
        if self._run is None:
            arrays = self._points, self._frame, self._table, self._whole, self._whole.reshape(-1)
            self._run = launch.prepared(_step, *arrays, self._lanes, self._lanes.reshape(-1), self._steps, precision=None)
        self._run()
        return self._steps[: (cells[0] + 2) * (cells[1] + 2)].reshape(cells[1] + 2, cells[0] + 2)

    def _divide(self, columns: int, rows: int, mode: str) -> None:
        """Make room for so many cells, and tables of which counts each line and column is made of."""
        if self._of == (columns, rows, mode):
            return
        self._of = columns, rows, mode
        lines, across = (_sources(count, mode) for count in (rows, columns))
        width, stretch = columns // LANES + 1, -(-(columns + 2) // LANES)
        each = np.arange(stretch + BLUR)[:, None] + np.arange(LANES) * stretch
        table = np.concatenate([lines, across[np.minimum(each, len(across) - 1)].ravel()])
        self._frame[9:] = width, stretch, len(lines)
        needed = len(table), (rows + 1 + CHUNKS) * width, CHUNKS * (stretch + BLUR), (columns + 2) * (rows + 2)
        held = len(self._table), len(self._whole), len(self._lanes), len(self._steps)
        if any(now > then for now, then in zip(needed, held, strict=True)):
            room = [max(now * 5 // 4, then) for now, then in zip(needed, held, strict=True)]
            self._table, self._steps = np.zeros(room[0], np.int32), np.zeros(room[3], np.int32)
            self._whole, self._lanes = (
                runtime.aligned((many, LANES), kind) for many, kind in zip(room[1:3], (np.uint32, np.float32), strict=True)
            )
            self._run = None
        self._table[: len(table)] = table


def _sources(count: int, mode: str) -> np.ndarray:
    """Give which of `count` rows of counts each line has around it; `count` itself is one in which nothing ever is."""
    own: dict = {"constant_values": count} if mode == "constant" else {}
    return np.append(np.pad(np.arange(count), HALF + 1, mode=mode, **own), count).astype(np.int32)  # type: ignore[call-overload]
