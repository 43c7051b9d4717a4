"""Live: what a film needs to know of a simulation that runs while it is filmed. Recordings are played the same way."""

from collections.abc import Iterator
from typing import Any, Protocol, runtime_checkable

import numpy as np

from tiswarm.recording import Recording, Swarm


class Moment(Protocol):
    """The prey or the predators at one tick. The arrays may be written over when the next tick is asked for.

    position, velocity: [agent, dim], m and m/s; NaN once the agent is gone.
    fate: [agent], what became of it up to this tick. state, group: [agent], as in a recording.
    """

    @property
    def position(self) -> np.ndarray: ...
    @property
    def velocity(self) -> np.ndarray: ...
    @property
    def fate(self) -> np.ndarray: ...
    @property
    def state(self) -> np.ndarray: ...
    @property
    def group(self) -> np.ndarray: ...


@runtime_checkable
class Live(Protocol):
    """A simulation that can be filmed while it runs; no tick is kept longer than its trails last.

    scenario, seed, trial, obstacle_position, obstacle_radius: as in a recording.
    ticks: how many it runs at most.

    Iterating runs it: prey and predators at the start, then after each tick; it may end before `ticks`.
    """

    @property
    def scenario(self) -> Any: ...
    @property
    def seed(self) -> int: ...
    @property
    def trial(self) -> int: ...
    @property
    def ticks(self) -> int: ...
    @property
    def obstacle_position(self) -> np.ndarray: ...
    @property
    def obstacle_radius(self) -> np.ndarray: ...
    def __iter__(self) -> Iterator[tuple[Moment, Moment]]: ...


def played(subject: "Recording | Live") -> Iterator[tuple[Moment, Moment]]:
    """Give prey and predators tick by tick."""
    return _replayed(subject) if isinstance(subject, Recording) else iter(subject)


def _replayed(recording: Recording) -> Iterator[tuple[Moment, Moment]]:
    for tick in range(recording.ticks + 1):
        yield _at(recording.prey, tick), _at(recording.predators, tick)


def _at(swarm: Swarm, tick: int) -> Swarm:
    """Cut one tick out of a swarm's path. Fates are final, which matters for nobody who is still there."""
    return Swarm(swarm.position[tick], swarm.velocity[tick], swarm.fate, swarm.state[tick], swarm.group[tick])
