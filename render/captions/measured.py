"""What a caption measures: the measures that a preset is about, at any moment of a film, with their units."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from render.scene.scene import Scene
from tiswarm.measures.recorded import MEANS
from tiswarm.records.recording import Recording, Swarm

LIVE = ("polarisation", "milling", "speed", "kinetic")
"""Measures that cost little of many agents: simulations that are filmed while they run have no others."""

UNITS = {"nearest": "m", "speed": "m/s", "kinetic": "m²/s²", "potential": "m²/s²"}
FRACTIONS = ("polarisation", "milling")


@dataclass(frozen=True)
class Measured:
    """A measure of one subject.

    name: what a caption calls it. at: its value at a time, NaN for none. share: 0 to 1 or None. written: writes a value with so
    many digits.
    """

    name: str
    unit: str
    at: Callable[[float], float]
    digits: int
    widest: str
    share: Callable[[float], float] | None
    written: Callable[[float, int], str]

    def text(self, time: float) -> str:
        """Write its value at a time."""
        value = self.at(time)
        return self.written(value, self.digits) if np.isfinite(value) else "–"


def measured(scene: Scene, number: int, name: str) -> Measured:
    """Measure a subject of a scene. name: one of scenario.measures.Shown."""
    subject = scene.subjects[number]
    if isinstance(subject, Recording):
        series = MEANS[name](subject)
        ticks = np.arange(len(series))
        known = np.isfinite(series)
        values = series[known] if known.any() else np.zeros(1)

        def between(time: float) -> float:
            # Between two ticks it goes straight on; where a tick has no value there is none.
            return float(np.interp(min(time, len(series) - 1), ticks, series))

        at: Callable[[float], float] = between
        largest, smallest = float(values.max()), float(values.min())
    else:
        at, largest, smallest = _live(scene, number, name), 99.0, 0.0
    digits = 0 if name == "groups" else 2 if max(abs(largest), abs(smallest)) < 100 else 1
    words = scene.look.wording
    widest = max((words.decimal(each, digits) for each in (largest, smallest)), key=len)
    share = (lambda time: float(np.nan_to_num(at(time)))) if name in FRACTIONS else None
    return Measured(called(scene, number, name), words.unit(UNITS.get(name, "")), at, digits, widest, share, words.decimal)


def called(scene: Scene, number: int, name: str) -> str:
    """Give what a caption calls a measure."""
    pair = int((scene.paths.is_prey & (scene.paths.scene == number)).sum()) == 2
    return scene.look.wording.say(f"measures.{'distance' if pair and name == 'nearest' else name}")


def _live(scene: Scene, number: int, name: str) -> Callable[[float], float]:
    """Measure the tick that a simulation has come to, once."""
    paths, subject = scene.paths, scene.subjects[number]
    kept: dict[int, float] = {}
    prey = np.flatnonzero(paths.is_prey & (paths.scene == number))

    def at(time: float) -> float:
        tick = int(min(time, paths.loaded))
        if name not in LIVE:
            return float("nan")
        if tick not in kept:
            kept.clear()
            kept[tick] = float(MEANS[name](_moment(subject, paths.spots(time)[prey], paths.speeds(time, prey)))[0])
        return kept[tick]

    return at


def _moment(subject, places: np.ndarray, motion: np.ndarray) -> Recording:
    """Make a recording of one tick, so that what is measured of it is what is measured of any."""
    count = len(places)
    gone = np.full((1, count), "calm"), np.full((1, count), -1, np.int32)
    swarm = Swarm(places[None], motion[None] / subject.scenario.world.dt, np.full(count, "alive"), *gone)
    nobody = Swarm(places[None, :0], places[None, :0], swarm.fate[:0], gone[0][:, :0], gone[1][:, :0])
    bare = np.zeros((0, places.shape[1]))
    return Recording(subject.scenario, subject.seed, subject.trial, swarm, nobody, bare, np.zeros(0))
