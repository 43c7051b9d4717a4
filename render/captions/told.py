"""Told: what happens, in a line at the foot of the stage for as long as it takes to read, with the numbers of who took part."""

import numpy as np

from render.captions.caption import Caption
from render.captions.layout import Box
from render.raster.glyphs import Atlas, width, wrapped
from render.raster.shapes import NONE, boxes
from render.scene.camera import Camera
from render.scene.scene import Scene
from render.story import READING, TOGETHER, Event, events
from tiswarm.records.recording import Recording

WORDS, NUMBER = 22, 16
"""Sizes of words."""

FOOT, PAD, PLATE = 20, 10, 0.8
"""Distance from the stage's foot, room around words [units of type], and opacity of what lies under them."""

SHARE = 0.7
"""Lines are at most this share of the stage wide."""


class Told(Caption):
    """The events of one recording."""

    def __init__(self, scene: Scene, atlas: Atlas, unit: float, stage: Box):
        """Part events into those that are told at once: there is one plate, so that nothing ever overlaps."""
        super().__init__(scene, atlas, unit)
        recording, self._stage = scene.subjects[0], stage
        assert isinstance(recording, Recording)
        self._groups: list[list[Event]] = []
        for event in events(recording, self._words):
            if self._groups and event.tick - self._groups[-1][0].tick < TOGETHER * scene.look.speed:
                self._groups[-1].append(event)
            else:
                self._groups.append([event])
        self._starts = np.array([group[0].tick for group in self._groups])

    def frame(self, time: float, camera: Camera) -> np.ndarray:
        """Tell what has just happened at a time [ticks], and number who took part. Slow motion lets it rest longer."""
        place = int(np.searchsorted(self._starts, time, side="right")) - 1
        if place < 0:
            return NONE
        told = [each for each in self._groups[place] if each.tick <= time]
        if time - told[-1].tick > READING * self._scene.look.speed:
            return NONE
        agents = np.array(sorted({agent for each in told for agent in each.agents}))
        return np.concatenate([self._numbers(agents, time, camera), self._line(told)])

    def _numbers(self, agents: np.ndarray, time: float, camera: Camera) -> np.ndarray:
        """Write agents' numbers beside the places where they are, or went."""
        spots = camera.of(agents).place(self._scene.paths.spots(time)[agents])
        prey = self._scene.paths.prey
        rows = [NONE]
        for agent, (x, y) in zip(agents, spots, strict=True):
            aside = (11 if agent < prey else -11) * self._unit
            align, number = ("left", agent) if agent < prey else ("right", agent - prey)
            rows.append(self._write(str(number), x + aside, y - 7 * self._unit, NUMBER, "ink", align))
        return np.concatenate(rows)

    def _line(self, told: list[Event]) -> np.ndarray:
        unit, stage, size = self._unit, self._stage, self._px(WORDS)
        lines = wrapped(self._words.clauses([each.words for each in told]), size, int(SHARE * stage.width), 3)
        wide = max(width(line, size) for line in lines) / 2 + PAD * unit
        high = 1.25 * WORDS * unit
        middle, foot = (stage.left + stage.right) / 2, stage.bottom - FOOT * unit
        top = foot - len(lines) * high - PAD * unit
        rows = [boxes((middle - wide, top), (middle + wide, foot), self._theme["backdrop"], PLATE, corner=5 * unit)]
        for n, line in enumerate(lines):
            rows.append(self._write(line, middle, top + (n + 0.95) * high, WORDS, "ink", "centre"))
        return np.concatenate(rows)
