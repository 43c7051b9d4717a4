"""Where things come to lie in a frame: the stage and the panel beside or below it, and the map from metres to pixels."""

from dataclasses import dataclass

import numpy as np

from render.motion import Motion

MARGIN = 0.04
"""Free rim around what the camera shows, as a share of the stage's shorter edge."""

ROOM = {"side": 290, "strip": 190, "pair": 300, "stack": 530}
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


def bounds(world: tuple[float, ...], paths: Motion, reach: float) -> Box:
    """Give the box [m] of the world and of everything that moves, `reach` around it.

    What strays farther than half the world's size from it is let go: the rest would become too small to see.
    """
    low, high = np.zeros(2), np.array(world[:2], float)
    limit = (high - low) / 2
    spots = paths.position[..., :2]
    low = np.minimum(low, np.nanmin(spots, axis=(0, 1)) - reach)
    high = np.maximum(high, np.nanmax(spots, axis=(0, 1)) + reach)
    low = np.maximum(low, -limit)
    high = np.minimum(high, np.array(world[:2]) + limit)
    return Box(low[0], low[1], high[0], high[1])


@dataclass(frozen=True)
class Camera:
    """A map from metres, y upwards, to pixels, y downwards.

    centre: the point [m] shown at `middle` [px]; scale: px/m.
    """

    centre: tuple[float, float]
    middle: tuple[float, float]
    scale: float

    def place(self, points: np.ndarray) -> np.ndarray:
        """Map points [..., dim] in metres to pixels [..., 2]."""
        flat = np.asarray(points, float)[..., :2]
        return np.array(self.middle) + (flat - self.centre) * (self.scale, -self.scale)

    def turn(self, directions: np.ndarray) -> np.ndarray:
        """Map directions [..., dim] to unit vectors on the screen [..., 2]; no direction at all points right."""
        flat = np.asarray(directions, float)[..., :2] * (1.0, -1.0)
        length = np.hypot(flat[..., 0], flat[..., 1])[..., None]
        return np.where(length > 1e-12, flat / np.maximum(length, 1e-12), (1.0, 0.0))


def fitted(view: Box, stage: Box) -> Camera:
    """Show a box of the world [m] as large as the stage allows."""
    margin = 2 * MARGIN * min(stage.width, stage.height)
    scale = min((stage.width - margin) / view.width, (stage.height - margin) / view.height)
    middle = (stage.left + stage.right) / 2, (stage.top + stage.bottom) / 2
    return Camera(((view.left + view.right) / 2, (view.top + view.bottom) / 2), middle, scale)
