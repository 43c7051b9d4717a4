"""What all captions have in common: how they write, and what there is to count."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from render.raster.glyphs import Atlas
from render.raster.shapes import Colour, colour
from render.scene.scene import Scene
from render.scene.trajectories import ALIVE, ARRIVED, CAPTURED, CRASHED
from render.source import target_of
from tiswarm.records.recording import FATES, Recording
from tiswarm.system.words import grouped


class Caption:
    """Words about a scene, sized by a unit of type [px]."""

    def __init__(self, scene: Scene, atlas: Atlas, unit: float):
        """Take what to write about, and what to write with."""
        self._scene, self._atlas, self._unit, self._theme = scene, atlas, unit, scene.theme

    def _px(self, units: float) -> int:
        """Turn a size of type into whole pixels."""
        return pixels(units, self._unit)

    def _write(
        self, text: str, x: float, y: float, size: float, paint: str, align: str = "left", *, tabular: bool = False
    ) -> np.ndarray:
        return self._atlas.line(text, (x, y), self._px(size), self._theme[paint], align=align, tabular=tabular)


def pixels(units: float, unit: float) -> int:
    """Turn a size of type into whole pixels."""
    return max(round(units * unit), 7)


@dataclass(frozen=True)
class Counter:
    """Something that a caption counts: its name, the number at a time and the most there can be, written with `unit` behind."""

    name: str
    number: Callable[[float], int]
    total: int
    paint: Colour
    unit: str = ""


def counters(scene: Scene) -> list[Counter]:
    """List what is worth counting in a scene of one subject: only what can happen there."""
    subject, paths, theme = scene.subjects[0], scene.paths, scene.theme
    hunters, words = paths.count - paths.prey, subject.scenario.words
    deadly = len(subject.obstacle_radius) > 0 and subject.scenario.obstacles.contact == "crash"
    ends = {
        ARRIVED: target_of(subject) is not None,
        CAPTURED: hunters > 0 and subject.scenario.world.contact in ("deadly", "eaten"),
        CRASHED: deadly or (isinstance(subject, Recording) and "crashed" in subject.prey.fate),
    }

    def there(prey: bool) -> Callable[[float], int]:
        return lambda time: int(((paths.end > time) & (paths.is_prey == prey)).sum())

    def gone(fate: int) -> Callable[[float], int]:
        return lambda time: int(((paths.end <= time) & paths.is_prey & (paths.fate == fate)).sum())

    found = [Counter(FATES[ALIVE], there(True), paths.prey, colour(theme.prey[0]))] if any(ends.values()) else []
    found += [Counter(FATES[fate], gone(fate), paths.prey, theme[FATES[fate]]) for fate, able in ends.items() if able]
    if hunters > 1:
        name = words.noun("predators", hunters)
        found.append(Counter(name, there(False), hunters, colour(theme.predator)))
    if coverage := scene.coverage:
        found.append(Counter(words.covered, lambda time: round(100 * coverage.share(time)), 100, theme["arrived"], "%"))
    return found


def introduced(scene: Scene) -> list[tuple[str, str, str, str]]:
    """Say who plays in a scene of one subject: kind, how many of them, strategy, avoidance ("" for none)."""
    scenario, paths, who = scene.subjects[0].scenario, scene.paths, []
    for kind, count in (("prey", paths.prey), ("predators", paths.count - paths.prey)):
        agents = getattr(scenario, kind)
        if count:
            avoidance = "" if agents.avoidance == "none" else agents.avoidance
            who.append((kind, f"{grouped(count)} {scenario.words.noun(kind, count)}", agents.strategy, avoidance))
    return who
