"""How a frame is divided: the stage, and the panel beside or below it."""

from dataclasses import dataclass

ROOM = {"side": 290, "strip": 104, "pair": 310, "stack": 540}
"""Room for the panel in units of type: its width beside the stage; its height below, as a strip, in two columns or one."""

MOST, ROW = 5, 25
"""Counters that the stack has room for; with fewer it is lower by a row [units of type] each."""

SMALLEST = 0.5
"""Frames whose unit of type would be smaller [px] have no panel: it could not be read."""

STRIPPED = 240, 0.54
"""A strip has few words: frames at least this high [px] still have one, with this unit of type at least."""


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

    unit: the size of type at 720 lines is one [px].
    panel: None in frames too small for type. form: "side", or below as one "strip", in two columns ("pair") or one ("stack").
    """

    size: tuple[int, int]
    unit: float
    stage: Box
    panel: Box | None
    form: str


def layout(size: tuple[int, int], extent: tuple[float, float], counters: int = MOST) -> Layout:
    """Divide a frame so that a world of some extent [m] is drawn as large as possible, with a panel of so many counters."""
    width, height = size
    unit = min(width, height) / 720
    whole = Box(0, 0, width, height)
    bare = Layout(size, unit, whole, None, "side")
    if height > 1.4 * width:
        room = ROOM["stack"] - (MOST - counters) * ROW
        unit = min(width / 460, height / (room + 460 * extent[1] / extent[0]))
        return bare if unit < SMALLEST else _below(size, unit, "stack", room)
    edge = ROOM["side"] * unit
    plans = [Layout(size, unit, Box(edge, 0, width, height), Box(0, 0, edge, height), "side")] if unit >= SMALLEST else []
    if width > 1.4 * height:
        plans += [_below(size, max(unit, STRIPPED[1]), "strip")] if height >= STRIPPED[0] else []
    elif unit >= SMALLEST:
        plans.append(_below(size, unit, "pair"))
    return max(plans, key=lambda each: min(each.stage.width / extent[0], each.stage.height / extent[1]), default=bare)


def _below(size: tuple[int, int], unit: float, form: str, room: float | None = None) -> Layout:
    width, height = size
    edge = height - (ROOM[form] if room is None else room) * unit
    return Layout(size, unit, Box(0, 0, width, edge), Box(0, edge, width, height), form)
