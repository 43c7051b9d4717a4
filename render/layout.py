"""How a frame is divided: the stage, and the panel beside or below it."""

from dataclasses import dataclass

ROOM = {"side": 290, "strip": 204, "pair": 310, "stack": 540}
"""Room that the panel needs, in units of type: its width beside the stage; its height below it in four columns, two or one."""

SMALLEST_PANEL = 200
"""Frames with a shorter edge [px] have no panel: type of that size cannot be read."""


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
    panel: None in frames too small for type. form: "side", or below in four columns ("strip"), two ("pair") or one ("stack").
    """

    size: tuple[int, int]
    unit: float
    stage: Box
    panel: Box | None
    form: str


def layout(size: tuple[int, int], extent: tuple[float, float], *, caption: bool = True) -> Layout:
    """Divide a frame so that a world of some extent [m] is drawn as large as possible.

    caption: keep room for the panel.
    """
    width, height = size
    unit = min(width, height) / 720
    whole = Box(0, 0, width, height)
    if not caption or min(size) < SMALLEST_PANEL:
        return Layout(size, unit, whole, None, "side")
    if height > 1.4 * width:
        unit = min(width / 460, height / (ROOM["stack"] + 460 * extent[1] / extent[0]))
        return _below(size, unit, "stack")
    edge = ROOM["side"] * unit
    side = Layout(size, unit, Box(edge, 0, width, height), Box(0, 0, edge, height), "side")
    below = _below(size, unit, "strip" if width > 1.4 * height else "pair")
    return max(side, below, key=lambda each: min(each.stage.width / extent[0], each.stage.height / extent[1]))


def _below(size: tuple[int, int], unit: float, form: str) -> Layout:
    width, height = size
    edge = height - ROOM[form] * unit
    return Layout(size, unit, Box(0, 0, width, edge), Box(0, edge, width, height), form)
