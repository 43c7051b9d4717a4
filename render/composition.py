"""Composition: one subject, or several side by side, on one canvas, with their cameras and captions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from render.captions.caption import counters, notes
from render.captions.cards import Cards
from render.captions.layout import Box, layout, unit_of
from render.captions.mosaic import Heading, Mosaic, cells, labels_of
from render.captions.panel import Panel
from render.captions.strip import Strip, height_of
from render.captions.told import Told
from render.raster.framebuffer import Framebuffer
from render.raster.glyphs import Atlas
from render.raster.shapes import NONE, WINDOW
from render.scene import background, lettering
from render.scene.background import Field
from render.scene.camera import Camera, Orbit, joint
from render.scene.orbits import roamed
from render.scene.rigs import Rig, View, apparent, bounds, heights, rig
from render.scene.scene import Scene
from render.scene.turned import gains, turned, turned_field
from render.source import Live, is_endless
from render.story import CLOSING, OPENING
from render.style import Look
from render.timeline import Rate, length, times
from tiswarm.records.recording import Recording
from tiswarm.space import box

if TYPE_CHECKING:
    from render.raster.canvas import Canvas

WIDE = 990
"""Stages this wide [units of type] show small things in full size; in narrower cells they shrink, at most to half."""

STRAY, STRAY_TOGETHER = 0.2, 0.02
"""How far from the world a camera goes along with who strays [share of the world's size]: less where space is shared.

Starts are always shown."""


@dataclass(frozen=True)
class Shot:
    """What a frame of a film shows: a time [ticks], and a card that came `age` and goes `left` seconds from then."""

    time: float
    card: str = ""
    age: float = 0.0
    left: float = 0.0


Subject = Recording | Live | Sequence[Recording | Live]


class Composition:
    """What a film of one subject, or of several, shows."""

    def __init__(
        self,
        subject: Subject,
        size: tuple[int, int],
        look: Look,
        *,
        yuv: bool,
        labels: Sequence[str] | None = None,
        field: Field | None = None,
        atlas: Atlas | None = None,
    ):
        """Set everything up.

        labels: names of several subjects, by default what tells them apart. field: arrows to draw on the ground. atlas: takes
        what is written, a new one when None.

        Errors: ValueError for no subject, another number of labels than subjects, or a live simulation that is to be looked
        ahead in.
        """
        alone = isinstance(subject, Recording | Live)
        subjects = [subject] if isinstance(subject, Recording | Live) else list(subject)
        if not subjects:
            raise ValueError("recordings: there are none; give one or more")
        if labels is not None and len(labels) != len(subjects):
            raise ValueError(f"labels: {len(labels)} do not fit {len(subjects)} recordings; give one each")
        self.is_live = not all(isinstance(each, Recording) for each in subjects)
        if look.slowed and self.is_live:
            raise ValueError("slow: a live simulation does not know its captures beforehand; record it first")
        if look.loop and self.is_live:
            raise ValueError("loop: a live simulation does not know its end beforehand; record it first")
        note = notes(subjects[0], look.wording)
        upright = look.camera == "fit" and gains(size, subjects)
        if upright:
            field = turned_field(field, subjects[0].scenario.world.size[0]) if field else None
            subjects = [turned(each) for each in subjects]
        self.look, self._backdrop, self._field = look, look.colours["backdrop"], field
        self._atlas = atlas or Atlas(look.colours.type_weight)
        self.caption: Panel | Mosaic | None = None
        if alone:
            self._single(subjects[0], size, note)
        else:
            self._several(subjects, size, labels or labels_of(subjects, look.wording))
        self._still = all(each.still for each in self.rigs)
        self._joint: Camera | None = None
        self._letters: np.ndarray | None = None
        self._unit = unit_of(size)
        self._told = self._story()
        self._cards = Cards(self.scene, size, self._unit, self._atlas, counters(self.scene) if alone else [], note)
        self.windows = self._cuts(size)
        self._size, self._yuv = size, yuv

    @cached_property
    def canvas(self) -> "Canvas":
        """Give what frames are drawn on; a still camera's ground is laid on it once and for all."""
        from render.raster.canvas import Canvas

        clear = self.look.transparent
        canvas = Canvas(self._size, self._atlas, yuv=self._yuv and not clear, clear=clear)
        if self._still:
            canvas.lay(self._backdrop, self._ground(0.0), self.windows)
        return canvas

    def _cuts(self, size: tuple[int, int]) -> np.ndarray:
        """Give the windows that shapes are cut to: for each subject one for what moves, then one for its world, and the frame.

        What leaves a view must not run into its neighbour's or into the panel. What leaves a periodic world comes back on the
        other side, and must not be seen on both.
        """
        edges = np.array([(b.left, b.top, b.right, b.bottom) for b in self.boxes])
        edges = np.concatenate([np.floor(edges[:, :2]), np.ceil(edges[:, 2:])], axis=1)
        inner = edges.copy()
        for n, (subject, held) in enumerate(zip(self.scene.subjects, self.rigs, strict=True)):
            camera, extent = held.at(0.0), subject.scenario.world
            if box.wraps(extent.boundary) and held.still and not isinstance(camera, Orbit):
                a, b = camera.place(np.array([(0, 0), extent.size[:2]], float))
                inner[n, :2] = np.maximum(edges[n, :2], np.minimum(a, b))
                inner[n, 2:] = np.minimum(edges[n, 2:], np.maximum(a, b))
        return np.concatenate([inner, edges, [(0, 0, *size)]]).round().astype(np.float32)

    def times(self, fps: Rate) -> Iterator[float]:
        """Give the frames' times [ticks]; several subjects end with the longest."""
        return times(self.scene.paths, self.look.speed, fps, slow=self.look.slowed)

    def shots(self, fps: Rate) -> Iterator[Shot]:
        """Give the frames: the time [ticks] of each, and of cards their name, and for how long they are and will be there."""
        before, after = (round(seconds * float(fps)) if self.look.cards else 0 for seconds in (OPENING, CLOSING))
        for n in range(before):
            yield Shot(0.0, "opening", n / float(fps), (before - n) / float(fps))
        time = 0.0
        for time in self.times(fps):
            yield Shot(time)
        for n in range(after):
            yield Shot(time, "closing", n / float(fps), (after - n) / float(fps))

    def length(self, fps: Rate) -> int:
        """Count the frames: of a live simulation, which may end early, the most there can be."""
        cards = sum(round(seconds * float(fps)) for seconds in (OPENING, CLOSING)) if self.look.cards else 0
        return length(self.scene.paths, self.look.speed, fps, slow=self.look.slowed) + cards

    def shot(self, shot: Shot, out: Framebuffer) -> np.ndarray:
        """Draw a frame, with the card that is there."""
        card = self._cards.frame(shot.card, shot.age, shot.left) if shot.card else NONE
        return self.frame(shot.time, out, self._in_frame(card))

    def frame(self, time: float, out: Framebuffer, above: np.ndarray = NONE) -> np.ndarray:
        """Draw the frame of a time [ticks] on a plate that the canvas allocated, and shapes above it; return its bytes."""
        shapes = [*self._moving(time), above]
        if self._still:
            return self.canvas.draw(shapes, self.windows, out)
        return self.canvas.fill(self._backdrop, [self._ground(time), *shapes], self.windows, out)

    def shapes(self, time: float) -> np.ndarray:
        """Give all shapes of the frame of a time [ticks], its ground first."""
        return np.concatenate([self._ground(time), *self._moving(time)])

    def _moving(self, time: float) -> list[np.ndarray]:
        moving = self.scene.frame(time, self._camera(time), self.windows)
        return [moving, self._lettered(time), self._happening(time), self._captioned(time)]

    def _camera(self, time: float) -> Camera:
        """Give the camera for all agents."""
        if self._joint is None or not self._still:
            self._joint = joint([each.at(time) for each in self.rigs], self.scene.paths.scene)
        return self._joint

    def _captioned(self, time: float) -> np.ndarray:
        return self._in_frame(self.caption.frame(time)) if self.caption else NONE

    def _lettered(self, time: float) -> np.ndarray:
        """Write on the stages: names of areas, and on the last stage the scale, which all share."""
        if self._letters is None or not self._still:
            theme, words, unit, rows = self.look.colours, self.look.wording, self.scene.unit, [NONE]
            for n, (subject, held) in enumerate(zip(self.scene.subjects, self.rigs, strict=True)):
                rows.append(lettering.names(subject, theme, self._atlas, unit, held.at(time), words))
                rows[-1][:, WINDOW] = len(self.boxes) + n
            if self.caption and self.caption.shown:
                edges = self.windows[-2]
                bars = [lettering.scale_bar(edges, theme, self._atlas, self._unit, self.rigs[-1].at(time), words)]
                if self.scene.density:
                    bars.append(self.scene.density.scale.bar(edges, theme, self._atlas, self._unit, words))
                rows += [self._in_frame(each) for each in bars]
            self._letters = np.concatenate(rows)
        return self._letters

    def _happening(self, time: float) -> np.ndarray:
        return self._in_frame(self._told.frame(time, self.rigs[0].at(time))) if self._told else NONE

    def _in_frame(self, rows: np.ndarray) -> np.ndarray:
        rows[:, WINDOW] = 2 * len(self.boxes)
        return rows

    def _ground(self, time: float) -> np.ndarray:
        """Draw what stands still, as the cameras see it at a time."""
        grounds = []
        for n, (subject, held) in enumerate(zip(self.scene.subjects, self.rigs, strict=True)):
            window = len(self.boxes) + n
            images = self._images(subject, held, time, self.windows[window])
            deep = isinstance(images[0], Orbit)
            endless = is_endless(subject) if deep else not box.bounded(subject.scenario.world.boundary)
            seen = self.windows[window] if endless or len(images) > 1 else None
            unit = self.scene.unit
            grounds.append(background.ground(subject, self.look.colours, unit, images, seen, self._field))
            grounds[-1][:, WINDOW] = window
        return np.concatenate([*grounds, self._in_frame(self.caption.ground()) if self.caption else NONE])

    @staticmethod
    def _images(subject: Recording | Live, held: Rig, time: float, window: np.ndarray) -> list[Camera]:
        """Give a camera for each image of a world that can be seen: several where one follows through a periodic world."""
        camera, extent = held.at(time), subject.scenario.world
        if held.still or not box.wraps(extent.boundary) or isinstance(camera, Orbit):
            return [camera]
        size, images = np.array(extent.size[:2], float), []
        for turn in ((x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)):
            moved = replace(camera, centre=camera.centre - size * turn)
            a, b = moved.place(np.array([(0, 0), size]))
            if (np.maximum(a, b) > window[:2]).all() and (np.minimum(a, b) < window[2:]).all():
                images.append(moved)
        return images

    def _single(self, subject: Recording | Live, size: tuple[int, int], note: str) -> None:
        self.scene = Scene([subject], self.look, unit_of(size), self._atlas)
        view, found = self._view(STRAY), counters(self.scene)
        plan = layout(size, apparent(self.scene.paths, view), height_of(self.scene, found, note))
        self.boxes = [plan.stage]
        self.rigs = [rig(self.look, self.scene.paths, 0, view, plan.stage)]
        if plan.panel:
            self.caption = (Strip if plan.form == "below" else Panel)(self.scene, plan, self._atlas, found, note)

    def _story(self) -> Told | None:
        """Tell what happens, where that was asked for and is known beforehand."""
        alone = len(self.scene.subjects) == 1 and isinstance(self.scene.subjects[0], Recording)
        if not self.look.story:
            return None
        if not alone:
            raise ValueError("story: needs one recording; film one, of few agents")
        return Told(self.scene, self._atlas, self._unit, self.boxes[0]) if self.caption else None

    def _several(self, subjects: list[Recording | Live], size: tuple[int, int], labels: Sequence[str]) -> None:
        unit = unit_of(size)
        rough = cells(size, len(subjects), _extent(subjects[0]), 0.0)
        small = unit * min(max(rough[0].width / (WIDE * unit), 0.5), 1.0)
        self.scene = Scene(subjects, self.look, small, self._atlas, knots=1)
        view, head = self._view(STRAY_TOGETHER), Heading(self.scene, size, unit)
        self.boxes = cells(size, len(subjects), (view.reach.width, view.reach.height), head.height)
        self.rigs = [rig(self.look, self.scene.paths, n, view, box) for n, box in enumerate(self.boxes)]
        self.caption = Mosaic(self.scene, self.boxes, labels, head, self._atlas)

    def _view(self, stray: float) -> View:
        """Find the worlds of all subjects and whatever moves there."""
        subjects = self.scene.subjects
        worlds = [Box(0, 0, *_extent(subject)) for subject in subjects]
        floors, tops = zip(*(heights(subject) for subject in subjects), strict=True)
        reached = [bounds(self.scene.paths, n, stray) for n in range(len(subjects))]
        along = roamed(subjects) if self.look.camera == "fit" else 0.0
        return View(_around(worlds), _around(reached), min(floors), max(tops), along)


def _extent(subject: Recording | Live) -> tuple[float, float]:
    """Give a world's width and height [m]."""
    width, height = subject.scenario.world.size[:2]
    return width, height


def _around(boxes: list[Box]) -> Box:
    """Give the box that holds all boxes."""
    return Box(min(b.left for b in boxes), min(b.top for b in boxes), max(b.right for b in boxes), max(b.bottom for b in boxes))
