"""Where the agents of a recording are between its ticks: cubic Hermite curves from positions and velocities."""

from dataclasses import dataclass, field

import numpy as np

from tiswarm.recording import Recording


@dataclass(frozen=True)
class Motion:
    """The paths of all agents, prey first, continuous in time. Times are ticks since the start, lengths metres.

    position: [tick, agent, dim], where each tick's curve begins; ahead: the same shape, where it ends.
    leaving, coming: the same shape, slopes there [m/tick].
    end: [agent], the tick at which the agent is gone, inf for those that stay.
    fate: [agent]. state, group: [tick, agent], as recorded. prey: how many of the agents are prey.
    period: [dim], size of a periodic world, or None.
    """

    position: np.ndarray
    ahead: np.ndarray
    leaving: np.ndarray
    coming: np.ndarray
    end: np.ndarray
    fate: np.ndarray
    state: np.ndarray
    group: np.ndarray
    prey: int
    period: np.ndarray | None
    _agents: np.ndarray = field(init=False)
    _last: np.ndarray = field(init=False)
    _final: np.ndarray = field(init=False)
    _flat: tuple[np.ndarray, ...] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_agents", np.arange(len(self.end)))
        object.__setattr__(self, "_final", np.minimum(self.end, self.ticks))
        object.__setattr__(self, "_last", np.maximum(self._final - 1, 0).astype(int))

        # Views, by tick and agent in one number, which is faster to take from than with two.
        flat = tuple(each.reshape(-1, each.shape[2]) for each in (self.position, self.ahead, self.leaving, self.coming))
        object.__setattr__(self, "_flat", flat)

    @property
    def ticks(self) -> int:
        """Count the ticks that ran."""
        return len(self.position) - 1

    @property
    def count(self) -> int:
        """Count the agents."""
        return len(self.end)

    @property
    def is_prey(self) -> np.ndarray:
        """Tell prey from predators: [agent], bool."""
        return self._agents < self.prey

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Give positions and velocities [m/tick] at times: [time, agent, dim]; an agent that is gone stays where it went."""
        when = np.minimum(times[:, None], self._final)
        tick = np.minimum(when.astype(int), self._last)
        f = (when - tick)[..., None]
        here = tick * self.count + self._agents
        a, b, va, vb = (each.take(here, axis=0) for each in self._flat)
        chord = b - a
        bend, twist = 3 * chord - 2 * va - vb, va + vb - 2 * chord
        place = a + f * (va + f * (bend + f * twist))
        if self.period is not None:
            place = np.mod(place, self.period)
        return place, va + f * (2 * bend + 3 * f * twist)

    def knots(self, per_tick: int) -> np.ndarray:
        """Give positions `per_tick` times a tick: [knot, agent, dim]. Trails of points fixed in time do not crawl."""
        return self.at(np.arange(self.ticks * per_tick + 1) / per_tick)[0]


def motion(recording: Recording) -> Motion:
    """Lay curves through the paths of prey and predators.

    Whoever dies or arrives in a tick has no position at its end: it goes on as it moved, and captor and captive meet halfway.
    """
    world, both = recording.scenario.world, (recording.prey, recording.predators)
    period = np.array(world.size, float) if world.boundary == "periodic" else None
    position = np.concatenate([swarm.position for swarm in both], axis=1)
    slope = np.concatenate([swarm.velocity for swarm in both], axis=1) * world.dt
    fate, state, group = (
        np.concatenate([getattr(swarm, name) for swarm in both], axis=-1) for name in ("fate", "state", "group")
    )
    ahead, coming = np.roll(position, -1, axis=0), np.roll(slope, -1, axis=0)
    ahead[-1], coming[-1] = position[-1], slope[-1]
    if period is not None:
        ahead = position + (ahead - position + period / 2) % period - period / 2
    rows = np.isfinite(position[..., 0]).sum(axis=0)
    end = np.where(rows < len(position), rows, np.inf)
    gone = np.flatnonzero(np.isfinite(end) & (rows > 0))
    last = rows[gone] - 1
    ahead[last, gone] = position[last, gone] + slope[last, gone]
    coming[last, gone] = slope[last, gone]
    paths = Motion(position, ahead, slope, coming, end, fate, state, group, recording.prey.count, period)
    _join_captures(paths, recording.scenario.prey.radius + recording.scenario.predators.radius)
    return paths


def _join_captures(paths: Motion, touch: float) -> None:
    """Let each captive and the nearest predator that died in the same tick end at the point between them.

    touch: distance of two agents that touch [m]; pairs farther apart than it and their last steps together are no pairs.
    """
    captured = (paths.fate == "captured") & np.isfinite(paths.end) & (paths.end > 0)
    captors = np.flatnonzero(captured & ~paths.is_prey)
    for captive in np.flatnonzero(captured & paths.is_prey):
        tick = int(paths.end[captive]) - 1
        rivals = captors[paths.end[captors] == tick + 1]
        if len(rivals) == 0:
            continue
        gaps = np.linalg.norm(paths.ahead[tick, rivals] - paths.ahead[tick, captive], axis=1)
        captor = rivals[gaps.argmin()]
        if gaps.min() > touch + np.linalg.norm(paths.leaving[tick, [captor, captive]], axis=1).sum():
            continue
        captors = captors[captors != captor]
        meeting = (paths.ahead[tick, captor] + paths.ahead[tick, captive]) / 2
        for agent in (captive, captor):
            paths.ahead[tick, agent] = meeting
            paths.coming[tick, agent] = meeting - paths.position[tick, agent]
