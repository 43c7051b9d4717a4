"""Source: what a film needs to know of a simulation that runs while it is filmed. Recordings are played the same way."""

from collections.abc import Iterator
from enum import IntEnum
from typing import Any, Protocol, runtime_checkable

import numpy as np

from tiswarm.records.recording import Recording, Swarm
from tiswarm.space import box


class Kind(IntEnum):
    """The two kinds of agents, in the order in which agents and every table of both kinds stand."""

    PREY = 0
    PREDATORS = 1


class Moment(Protocol):
    """The prey or the predators at one tick. The arrays may be written over when the next tick is asked for."""

    @property
    def position(self) -> np.ndarray:
        """Say where they are: [agent, dim], m; NaN once an agent is gone."""

    @property
    def velocity(self) -> np.ndarray:
        """Say how they move: [agent, dim], m/s."""

    @property
    def fate(self) -> np.ndarray:
        """Name what became of each up to this tick: [agent], one of recording.FATES."""

    @property
    def state(self) -> np.ndarray:
        """Name each one's state, as in a recording: [agent]."""

    @property
    def group(self) -> np.ndarray:
        """Number each one's sub-swarm, or the cluster that a predator chases: [agent], -1 for none."""


@runtime_checkable
class Live(Protocol):
    """A simulation that can be filmed while it runs; no tick is kept longer than its trails last."""

    @property
    def scenario(self) -> Any:
        """Give the scenario that runs."""

    @property
    def seed(self) -> int:
        """Give the seed."""

    @property
    def trial(self) -> int:
        """Give the number of the trial."""

    @property
    def ticks(self) -> int:
        """Say how many ticks it runs at most."""

    @property
    def obstacle_position(self) -> np.ndarray:
        """Give the obstacles' centres: [obstacle, dim], m."""

    @property
    def obstacle_radius(self) -> np.ndarray:
        """Give their radii: [obstacle], m."""

    def __iter__(self) -> Iterator[tuple[Moment, Moment]]:
        """Run it, once: give prey and predators at the start, then after each tick; it may end before `ticks`."""


def played(subject: "Recording | Live") -> Iterator[tuple[Moment, Moment]]:
    """Give prey and predators tick by tick."""
    return _replayed(subject) if isinstance(subject, Recording) else iter(subject)


def _replayed(recording: Recording) -> Iterator[tuple[Moment, Moment]]:
    for tick in range(recording.ticks + 1):
        yield _at(recording.prey, tick), _at(recording.predators, tick)


def _at(swarm: Swarm, tick: int) -> Swarm:
    """Cut one tick out of a swarm's path. Fates are final, which matters for nobody who is still there."""
    position, velocity = swarm.position[tick], swarm.velocity[tick]
    return Swarm(position, velocity, swarm.fate, swarm.state[tick], swarm.group[tick], judged=swarm.judged)


def target_of(subject: "Recording | Live") -> Any:
    """Give the target that prey want to reach, or None."""
    target = subject.scenario.target
    return target if target.present else None


def is_sky(subject: Recording | Live) -> bool:
    """Tell whether nothing in a world stands on a ground: no target, obstacle, area or wall."""
    world = subject.scenario.world
    bare = not target_of(subject) and not len(subject.obstacle_radius) and not world.areas
    return bool(bare and not box.solid(world.boundary))


def is_endless(subject: Recording | Live) -> bool:
    """Tell whether a world has neither a ground nor an edge that anybody would meet."""
    return is_sky(subject) and not box.bounded(subject.scenario.world.boundary)
