"""How a frame is divided: the stage, and the caption beside or below it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

SIDE, WIDEST = 300, 420
"""Width of a caption beside the stage [units of type], at least, and at most before its type grows."""

LARGEST = 1.5
"""Type grows at most so much where a world leaves room."""

READABLE = 0.44
"""Unit of type [px] of frames that are smaller than it would make them: their title and clock can still be read."""

SMALLEST = 250, 140
"""Frames of fewer pixels across or up have no caption."""


@dataclass(frozen=True)
class Box:
    """A rectangle: left, top, right, bottom [px], or its like in metres."""

    left: float
    top: float
    right: float
    bottom: float

    @property
    def width(self) -> float:
        """Give its extent along x."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Give its extent along y."""
        return self.bottom - self.top


@dataclass(frozen=True)
class Layout:
    """How a frame is divided.

    unit: pixels per unit of type, one at 720 lines. panel: None in frames too small for type. form: "side" or "below".
    """

    size: tuple[int, int]
    unit: float
    stage: Box
    panel: Box | None
    form: str


Needed = Callable[[float, float], float]
"""Gives the height [px] that a caption below the stage needs, by its width and the unit of type [px]."""


def unit_of(size: tuple[int, int]) -> float:
    """Give the unit of type of a frame [px]."""
    return max(min(size) / 720, READABLE)


def layout(size: tuple[int, int], extent: tuple[float, float], needed: Needed) -> Layout:
    """Divide a frame so that a view of some extent [m] is drawn as large as possible, and give its caption what is left."""
    width, height = size
    unit = unit_of(size)
    if width < SMALLEST[0] or height < SMALLEST[1]:
        return Layout(size, unit, Box(0, 0, width, height), None, "below")
    plans = [_below(size, unit, extent, needed)]
    if width >= height:
        plans.append(_beside(size, unit, extent))
    return max(
        (plan for plan in plans if plan is not None),
        key=lambda plan: min(plan.stage.width / extent[0], plan.stage.height / extent[1]),
    )


def _beside(size: tuple[int, int], unit: float, extent: tuple[float, float]) -> Layout:
    """Put the caption on the left, as wide as a view of the frame's whole height lets it be."""
    width, height = size
    edge = max(SIDE * unit, width - height * extent[0] / extent[1])
    edge = min(edge, WIDEST * unit * LARGEST)
    grown = unit * min(max(edge / (WIDEST * unit), 1.0), LARGEST)
    return Layout(size, grown, Box(edge, 0, width, height), Box(0, 0, edge, height), "side")


def _below(size: tuple[int, int], unit: float, extent: tuple[float, float], needed: Needed) -> Layout:
    """Put the caption below, in type as large as a view of the frame's whole width leaves room for."""
    width, height = size
    free = height - width * extent[1] / extent[0]
    sizes = [unit * (LARGEST - 0.05 * step) for step in range(round((LARGEST - 1) / 0.05) + 1)]
    grown = next((each for each in sizes if needed(width, each) <= free), unit)
    high = max(needed(width, grown), min(free, 0.45 * height) if free > 0 else 0)
    high = min(high, 0.6 * height)
    return Layout(size, grown, Box(0, 0, width, height - high), Box(0, height - high, width, height), "below")


def dealt(widths: Sequence[float], room: float, gap: float) -> list[list[float]]:
    """Deal widths to rows that have room for them, with a gap between two."""
    rows: list[list[float]] = []
    for wide in widths:
        if not rows or sum(rows[-1]) + len(rows[-1]) * gap + wide > room:
            rows.append([])
        rows[-1].append(wide)
    return rows
