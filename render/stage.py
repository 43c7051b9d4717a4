"""A stage: one recording, or several side by side, on one canvas, with their cameras and captions."""

from collections.abc import Sequence

import numpy as np

from render.camera import Operator, View, bounds, fitted, operator
from render.layout import Box, layout
from render.look import Look
from render.mosaic import Mosaic, cells, labels_of
from render.panel import Panel
from render.scene import Scene
from render.shapes import NONE
from render.strip import Strip
from render.text import Atlas
from render.timeline import times
from tiswarm.recording import Recording

WIDE = 990
"""Stages this wide [units of type] show small things in full size; in narrower cells they shrink, at most to half."""

STRAY, STRAY_TOGETHER = 0.5, 0.08
"""How far from the world a camera goes along with who strays [share of the world's size]: less where space is shared."""

Subject = Recording | Sequence[Recording]


class Stage:
    """What a film of one recording, or of several, shows."""

    def __init__(self, subject: Subject, size: tuple[int, int], look: Look, *, yuv: bool, labels: Sequence[str] | None = None):
        """Set everything up; a still camera's ground is laid once and for all.

        labels: names of several recordings, by default what tells them apart.

        Errors: ValueError for no recording, or another number of labels than recordings.
        """
        from render.canvas import Canvas

        recordings = [subject] if isinstance(subject, Recording) else list(subject)
        if not recordings:
            raise ValueError("recordings: there are none; give one or more")
        if labels is not None and len(labels) != len(recordings):
            raise ValueError(f"labels: {len(labels)} do not fit {len(recordings)} recordings; give one each")
        self._look, self._backdrop = look, look.colours["backdrop"]
        self._atlas = Atlas(look.colours.type_weight)
        self.views: list[tuple[Scene, Operator, Box]] = []
        self.caption: Panel | Mosaic | None = None
        if isinstance(subject, Recording):
            self._single(subject, size)
        else:
            self._several(recordings, size, labels or labels_of(recordings))
        self._still = all(held.still for _, held, _ in self.views)
        edges = [(np.floor(b.left), np.floor(b.top), np.ceil(b.right), np.ceil(b.bottom)) for _, _, b in self.views]
        self._windows = np.array([*edges, (0, 0, *size)], np.float32)
        self.canvas = Canvas(size, self._atlas, yuv=yuv)
        if self._still:
            self._lay(0.0)

    @property
    def scenes(self) -> list[Scene]:
        """List the scenes."""
        return [scene for scene, _, _ in self.views]

    def times(self, fps: int) -> np.ndarray:
        """List the frames' times [ticks]; several recordings end with the longest."""
        longest = max((scene.paths for scene in self.scenes), key=lambda paths: paths.ticks)
        return times(longest, self._look.speed, fps, slow=self._look.slow)

    def frame(self, time: float, out: np.ndarray) -> np.ndarray:
        """Draw the frame of a time [ticks] into out."""
        if not self._still:
            self._lay(time)
        acts = [scene.frame(time, held.at(time)) for scene, held, _ in self.views]
        return self.canvas.draw(*self._gather(acts, self.caption.frame(time) if self.caption else NONE), out)

    def _lay(self, time: float) -> None:
        grounds = [[scene.ground(held.at(time))] for scene, held, _ in self.views]
        self.canvas.lay(self._backdrop, *self._gather(grounds, self.caption.ground() if self.caption else NONE))

    def _gather(self, acts: list[list[np.ndarray]], caption: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Put the shapes of all views and of the caption into one array, with the window each is cut to.

        What leaves a view must not run into its neighbour's or into the panel.
        """
        counts = [sum(len(rows) for rows in act) for act in acts]
        windows = np.repeat(self._windows, [*counts, len(caption)], axis=0)
        return np.concatenate([*(rows for act in acts for rows in act), caption]), windows

    def _single(self, recording: Recording, size: tuple[int, int]) -> None:
        unit = layout(size, recording.scenario.world.size[:2]).unit
        scene = Scene(recording, self._look, self._atlas, unit)
        view = _view([scene], STRAY)
        plan = layout(size, (view.reach.width, view.reach.height))
        self.views = [(scene, operator(self._look, scene.paths, view, plan.stage), plan.stage)]
        if plan.panel:
            self.caption = (Strip if plan.form == "strip" else Panel)(scene, plan, self._atlas)

    def _several(self, recordings: list[Recording], size: tuple[int, int], labels: Sequence[str]) -> None:
        unit = min(size) / 720
        rough = cells(size, len(recordings), recordings[0].scenario.world.size[:2], unit)
        small = unit * min(max(rough[0].width / (WIDE * unit), 0.5), 1.0)
        scenes = [Scene(recording, self._look, self._atlas, small, knots=1) for recording in recordings]
        view = _view(scenes, STRAY_TOGETHER)
        places = cells(size, len(recordings), (view.reach.width, view.reach.height), unit)
        self.views = [(s, operator(self._look, s.paths, view, box), box) for s, box in zip(scenes, places, strict=True)]
        # Labels stand right above what is drawn, which seldom fills its cell both ways.
        above = [_shown(view, box) for box in places]
        self.caption = Mosaic(scenes, above, labels, size, self._atlas, unit)


def _view(scenes: list[Scene], stray: float) -> View:
    """Find the worlds of all scenes and whatever moves there."""
    reached, worlds = [], []
    for scene in scenes:
        scenario = scene.recording.scenario
        worlds.append(Box(0, 0, *scenario.world.size[:2]))
        reached.append(bounds(scenario.world.size, scene.paths, max(scenario.prey.radius, scenario.predators.radius), stray))
    return View(_around(worlds), _around(reached))


def _around(boxes: list[Box]) -> Box:
    """Give the box that holds all boxes."""
    return Box(min(b.left for b in boxes), min(b.top for b in boxes), max(b.right for b in boxes), max(b.bottom for b in boxes))


def _shown(view: View, cell: Box) -> Box:
    """Give the part of a cell that a fitted view fills: as wide as the world, as high as all that is reached."""
    ends = np.array([[view.world.left, view.reach.top], [view.world.right, view.reach.bottom]])
    (left, bottom), (right, top) = fitted(view, cell).place(ends)
    return Box(float(left), float(top), float(right), float(bottom))
