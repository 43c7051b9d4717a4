"""Turned: subjects of wide worlds stand upright in tall frames, turned by a quarter: what was on the left is above."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from render.scene.background import Field
from render.source import Live, Moment
from tiswarm.records.recording import Recording, Swarm
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.parts import Box

GAIN = 1.25
"""Turned is what becomes larger by so much."""


def gains(size: tuple[int, int], subjects: list[Recording | Live]) -> bool:
    """Tell whether flat subjects are larger when they are turned, which must not move a grid on which ground is counted."""
    frame = size[0] / size[1]
    if not all(len(subject.scenario.world.size) == 2 and not subject.scenario.coverage.cell for subject in subjects):
        return False
    width, height = subjects[0].scenario.world.size
    return min(frame / height, 1 / width) > GAIN * min(frame / width, 1 / height)


def turned(subject: Recording | Live) -> Recording | Live:
    """Turn a flat subject by a quarter: (x, y) becomes (y, width - x)."""
    width = subject.scenario.world.size[0]
    scenario = _scenario(subject.scenario)
    obstacles = _places(np.asarray(subject.obstacle_position), width)
    if isinstance(subject, Recording):
        prey, predators = (_swarm(each, width) for each in (subject.prey, subject.predators))
        return replace(subject, scenario=scenario, prey=prey, predators=predators, obstacle_position=obstacles)
    return _Turned(subject, scenario, obstacles)


def turned_field(field: Field, width: float) -> Field:
    """Turn a field of a world of some width [m]."""
    return Field(_places(field.points, width), _ways(field.arrows))


@dataclass
class _Turned:
    """A simulation, turned while it runs."""

    subject: Live
    scenario: Any
    obstacle_position: np.ndarray

    def __post_init__(self) -> None:
        self.seed, self.trial, self.ticks = self.subject.seed, self.subject.trial, self.subject.ticks
        self.obstacle_radius = self.subject.obstacle_radius

    def __iter__(self) -> Iterator[tuple[Moment, Moment]]:
        width = self.subject.scenario.world.size[0]
        for prey, predators in self.subject:
            yield _moment(prey, width), _moment(predators, width)


def _moment(moment: Moment, width: float) -> Swarm:
    place, way = _places(moment.position, width), _ways(moment.velocity)
    return Swarm(place, way, moment.fate, moment.state, moment.group, judged=_judged(moment, width))


def _swarm(swarm: Swarm, width: float) -> Swarm:
    place, way = _places(swarm.position, width), _ways(swarm.velocity)
    return replace(swarm, position=place, velocity=way, judged=_judged(swarm, width))


def _judged(swarm: Moment, width: float) -> np.ndarray | None:
    """Turn the places where contacts were judged, which recordings know."""
    places = getattr(swarm, "judged", None)
    return None if places is None else _places(places, width)


def _places(places: np.ndarray, width: float) -> np.ndarray:
    return np.stack([places[..., 1], width - places[..., 0]], axis=-1)


def _ways(ways: np.ndarray) -> np.ndarray:
    return np.stack([ways[..., 1], 0.0 - ways[..., 0]], axis=-1)


def _box(box: Box, width: float) -> Box:
    return Box(low=(box.low[1], width - box.high[0]), high=(box.high[1], width - box.low[0]))


def _scenario(scenario: Scenario) -> Scenario:
    """Turn what a film draws of a scenario, and no more."""
    world = scenario.world
    areas = tuple(area.model_copy(update={"region": _box(area.region, world.size[0])}) for area in world.areas)
    place = _places(np.array(scenario.target.position[:2]), world.size[0])
    target = scenario.target.model_copy(update={"position": (float(place[0]), float(place[1]))})
    upright = world.model_copy(update={"size": (world.size[1], world.size[0]), "areas": areas})
    return scenario.model_copy(update={"world": upright, "target": target})
