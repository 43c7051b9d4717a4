"""A stage: one recording on one canvas, with its camera and its caption."""

import numpy as np

from render.camera import bounds, fitted, layout
from render.panel import Panel
from render.scene import Look, Scene
from render.text import Atlas
from render.theme import Theme
from tiswarm.recording import Recording

HOLD = 1.0
"""How long the last state stays on the screen [s]."""


class Stage:
    """One recording on one canvas: the scene, its camera, its caption."""

    def __init__(self, recording: Recording, size: tuple[int, int], theme: Theme, look: Look, *, yuv: bool):
        """Lay the ground that every frame starts from."""
        from render.canvas import Canvas

        if not look.speed > 0 or not look.trail >= 0:
            raise ValueError("speed must be above 0 ticks per second, and trail 0 seconds or longer")
        self._look = look
        atlas = Atlas()
        scenario = recording.scenario
        plan = layout(size, scenario.world.size[:2])
        self.scene = Scene(recording, theme, atlas, plan.unit, look)
        reach = max(scenario.prey.radius, scenario.predators.radius)
        view = bounds(scenario.world.size, self.scene.paths, reach)
        plan = layout(size, (view.width, view.height))
        self.camera = fitted(view, plan.stage)
        self.panel = Panel(self.scene, plan, atlas) if plan.panel else None
        self.canvas = Canvas(size, atlas, yuv=yuv)
        rows = [self.scene.ground(self.camera)]
        if self.panel:
            rows.append(self.panel.ground())
        self.canvas.lay(theme["backdrop"], np.concatenate(rows))

    def times(self, fps: int) -> np.ndarray:
        """List the frames' times [ticks], the hold at the end included."""
        if fps < 1:
            raise ValueError(f"fps: {fps} is not possible; use 1 or more")
        frames = int(np.ceil(self.scene.paths.ticks / self._look.speed * fps)) + round(HOLD * fps)
        return np.arange(frames) * (self._look.speed / fps)

    def frame(self, time: float, out: np.ndarray) -> np.ndarray:
        """Draw the frame of a time [ticks] into out."""
        rows = [self.scene.frame(time, self.camera)]
        if self.panel:
            rows.append(self.panel.frame(time))
        return self.canvas.draw(np.concatenate(rows), out)
