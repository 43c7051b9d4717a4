"""What all captions have in common: how they write, and what there is to count."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from render.captions.measured import measured
from render.language import Language
from render.raster.glyphs import Atlas, width, wrapped
from render.raster.shapes import NONE, Colour, capsules, colour, darts
from render.scene.scene import Scene
from render.scene.signs import PARTED, signs
from render.scene.trajectories import ALIVE, ARRIVED, CAPTURED, CRASHED
from render.source import Live, target_of
from tiswarm.records.recording import FATES, Recording

LEGIBLE = 8
"""Words that would be smaller than this [px] are left out, but for the title, the clock and the numbers."""

DIGIT = 11
"""The title, the clock and the numbers are no smaller than this [px]."""


SMALL = 22
"""Words smaller than this [units of type] are small print."""


class Caption:
    """Words about a scene, sized by a unit of type [px].

    progresses: a line tells how far the film has come.
    """

    progresses = True

    def __init__(self, scene: Scene, atlas: Atlas, unit: float):
        """Take what to write about, and what to write with."""
        self._scene, self._atlas, self._unit, self._theme = scene, atlas, unit, scene.theme
        self._words = scene.look.wording
        self._turn: float | None = None
        self._key = keyed(scene)

    def _within(self, left: float, right: float) -> None:
        """Turn what is placed from now on about the middle of a range [px], where lines run from right to left."""
        self._turn = None if self._words.rightward else left + right

    def _x(self, x: Any) -> Any:
        """Give where something stands that lines from left to right have at x [px]."""
        return x if self._turn is None else self._turn - x

    def _span(self, left: float, right: float) -> tuple[float, float]:
        """Give where a range stands that lines from left to right have there [px]."""
        return (left, right) if self._turn is None else (self._turn - right, self._turn - left)

    def _px(self, units: float) -> int:
        """Turn a size of type into whole pixels."""
        return pixels(units, self._unit)

    def _write(
        self, text: str, x: float, y: float, size: float, paint: str, align: str = "left", *, tabular: bool = False
    ) -> np.ndarray:
        """Write a line. size: in units of type; small print that nobody could read is left out."""
        if size < SMALL and self._px(size) < LEGIBLE:
            return NONE
        if self._turn is not None:
            align = {"left": "right", "right": "left"}.get(align, align)
        text = text if tabular else self._words.line(text)
        return self._atlas.line(text, (self._x(x), y), self._px(size), self._theme[paint], align=align, tabular=tabular)

    def _likeness(self, kind: str, x: float, y: float, unit: float) -> np.ndarray:
        """Draw one of the prey, the predators or the obstacles as it looks on the stage."""
        middle, right = np.array([[self._x(x), y]]), np.array([[unit, 0.0]])
        if kind == "prey":
            return self._prey_likeness(middle, right)
        return darts(middle, right / unit, 9 * unit, 6.5 * unit, 6.5 * unit, colour(self._theme.predator))

    def _prey_likeness(self, middle: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Draw one of the prey, or one of each of the first two parts of a swarm that splits up."""
        split = PARTED in self._key
        size, unit, rows = 0.75 if split else 1.0, right[0, 0], []
        for hue, aside in ((1, 4.5), (0, -4.5)) if split else ((0, 0.0),):
            at, paint = middle + np.array((0.0, aside * unit)), colour(self._theme.prey[hue])
            rows.append(capsules(at + 3 * size * right, at - 8 * size * right, 6 * size * unit, 1.3 * size * unit, paint))
        return np.concatenate(rows)

    def _sign(self, fate: int, x: float, y: float, size: float) -> np.ndarray:
        """Draw the sign of a fate."""
        return signs(fate, np.array([[self._x(x), y]]), size, self._theme)


def pixels(units: float, unit: float) -> int:
    """Turn a size of type into whole pixels."""
    return max(round(units * unit), DIGIT if units >= SMALL else 5)


def fitting(text: str, sizes: tuple[float, ...], room: float, most: int, unit: float) -> tuple[list[str], float]:
    """Break a title into at most so many lines, in the largest of some sizes [units of type] that needs no more.

    Words are broken at their hyphens only where no size keeps them whole. Where even the smallest needs more lines it gets
    twice as many: what is left over then was never meant to be read.
    """
    for whole in (True, False):
        for size in sizes:
            lines = wrapped(text, pixels(size, unit), int(room), most + 1)
            if len(lines) <= most and not any(line.endswith("…") for line in lines) and not (whole and _broken(text, lines)):
                return _evenly(text, pixels(size, unit), int(room), lines), size
    return wrapped(text, pixels(sizes[-1], unit), int(room), 2 * most), sizes[-1]


def _broken(text: str, lines: list[str]) -> bool:
    """Tell whether a line ends within a word."""
    return any(line.endswith("-") and line.split()[-1] not in text.split() for line in lines)


def _evenly(text: str, size: int, room: int, lines: list[str]) -> list[str]:
    """Break a title into lines of about the same length, so that no word stands alone."""
    if len(lines) == 1:
        return lines
    for narrow in range(room // 2, room, max(room // 40, 1)):
        even = wrapped(text, size, narrow, len(lines) + 1)
        if len(even) == len(lines) and not any(line.endswith("…") for line in even) and not _broken(text, even):
            return even
    return lines


@dataclass(frozen=True)
class Counter:
    """Something that a caption counts or measures.

    text: the number at a time, without its unit. share: how full its bar is at a time, None for none. widest: the longest
    number that there can be. sign: the fate that it counts.
    """

    name: str
    text: Callable[[float], str]
    paint: Colour
    widest: str
    unit: str = ""
    share: Callable[[float], float] | None = None
    sign: int | None = None

    def name_room(self, name: int) -> float:
        """Measure its name, behind its sign, in type of a size [px]."""
        return width(self.name, name) + (name if self.sign is not None else 0)

    def room(self, number: int, name: int, unit: int) -> float:
        """Measure its number beside its name in types of some sizes [px]."""
        digits = width(self.widest, number, tabular=True) + (width(" " + self.unit, unit) if self.unit else 0)
        return digits + self.name_room(name)


def counted(
    words: Language,
    name: str,
    number: Callable[[float], int],
    total: int,
    paint: Colour,
    unit: str = "",
    sign: int | None = None,
) -> Counter:
    """Count something of which there are at most `total`."""
    return Counter(
        name,
        lambda time: words.whole(number(time)),
        paint,
        words.whole(total),
        unit,
        lambda time: number(time) / max(total, 1),
        sign,
    )


def counters(scene: Scene) -> list[Counter]:
    """List what is worth counting in a scene of one subject: what its preset is about, and what can happen there."""
    subject, paths, theme = scene.subjects[0], scene.paths, scene.theme
    hunters, words, scenario = paths.count - paths.prey, scene.look.wording, subject.scenario
    ends = possible_ends(scene, 0)

    def there(prey: bool) -> Callable[[float], int]:
        return lambda time: int(((paths.end > time) & (paths.is_prey == prey)).sum())

    def gone(fate: int) -> Callable[[float], int]:
        return lambda time: int(((paths.end <= time) & paths.is_prey & (paths.fate == fate)).sum())

    found = []
    for name in scenario.film.measures:
        each = measured(scene, 0, name)
        found.append(Counter(each.name, each.text, colour(theme.prey[0]), each.widest, each.unit, each.share))
    if coverage := scene.coverage:
        share = coverage.share
        name = words.word("covered", scenario.words.covered)
        found.append(counted(words, name, lambda time: round(100 * share(time)), 100, theme["arrived"], "%"))
    if ends:
        found.append(counted(words, fated(scene, ALIVE), there(True), paths.prey, colour(theme.prey[0]), sign=ALIVE))
    found += [counted(words, fated(scene, fate), gone(fate), paths.prey, theme[FATES[fate]], sign=fate) for fate in ends]
    deadly = any(fate != ARRIVED for fate in ends) and scenario.world.contact == "deadly"
    if hunters > 1 and deadly:
        name = words.noun(scenario, "predators", hunters)
        found.append(counted(words, name, there(False), hunters, colour(theme.predator)))
    return found


def fated(scene: Scene, fate: int) -> str:
    """Say what became of who met a fate, or that a swarm is PARTED."""
    return scene.look.wording.say("lines.parts" if fate == PARTED else f"fates.{FATES[fate]}")


def keyed(scene: Scene) -> list[int]:
    """List the signs that need a word: fates that prey can meet, and that colours are parts of a swarm."""
    subjects = scene.subjects
    ends = sorted({fate for number in range(len(subjects)) for fate in possible_ends(scene, number)})
    return [*([ALIVE, *ends] if ends else []), *([PARTED] if parted(scene) else [])]


def parted(scene: Scene) -> bool:
    """Tell whether a swarm splits up; of one that runs while it is filmed, whether it begins in parts."""
    paths = scene.paths
    recorded = any(isinstance(each, Recording) and bool((each.prey.group > 0).any()) for each in scene.subjects)
    return recorded or bool((paths.groups(0.0)[paths.is_prey] > 0).any())


def possible_ends(scene: Scene, number: int) -> list[int]:
    """List the fates that prey of a subject can meet."""
    subject, paths = scene.subjects[number], scene.paths
    hunted = bool((~paths.is_prey & (paths.scene == number)).any())
    deadly = len(subject.obstacle_radius) > 0 and subject.scenario.obstacles.contact == "crash"
    ends = {
        ARRIVED: target_of(subject) is not None,
        CAPTURED: hunted and subject.scenario.world.contact in ("deadly", "eaten"),
        CRASHED: deadly or (isinstance(subject, Recording) and "crashed" in subject.prey.fate),
    }
    return [fate for fate, able in ends.items() if able]


def introduced(scene: Scene) -> list[tuple[str, str, str]]:
    """Say who plays in a scene of one subject: kind, how many of them, and how they behave."""
    scenario, paths, who = scene.subjects[0].scenario, scene.paths, []
    for kind, count in (("prey", paths.prey), ("predators", paths.count - paths.prey)):
        agents = getattr(scenario, kind)
        if count:
            avoids = agents.avoidance != "none" and len(scene.subjects[0].obstacle_radius) > 0
            noun = scenario.words.noun(kind, count)
            ways = [agents.strategy] * (agents.strategy not in (noun, scenario.words.noun(kind, 1))) + [
                agents.avoidance
            ] * avoids
            who.append((kind, scene.look.wording.counted(scenario, kind, count), " · ".join(ways)))
    return who


def notes(subject: Recording | Live, words: Language) -> str:
    """Say where a subject comes from, and what of its preset was changed."""
    which = [words.say("lines.trial", number=str(subject.trial)), words.say("lines.seed", number=str(subject.seed))]
    which = [each.replace(" ", "\N{NO-BREAK SPACE}") for each in which]
    return " · ".join(each for each in (subject.scenario.source, words.changed(subject.scenario), *which) if each)
