"""Where agents are between ticks: cubic Hermite curves from positions and velocities, laid while the ticks come in."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from render.scene.curves import along, lay
from render.source import Kind, Live, Moment, played
from tiswarm.records.recording import FATES, Recording
from tiswarm.space import box

ALIVE, ARRIVED, CAPTURED, CRASHED = range(len(FATES))

TRAILED = 3000
"""More agents than this have no trails: they would hide each other."""

CALM, ALARMED, ACTING, EXPLODING = range(4)
"""States as they are drawn: any state but these three looks like ACTING."""

Watcher = Callable[[int, np.ndarray], None]

_NAMED = (("alarmed", ALARMED), ("exploding", EXPLODING))


@dataclass(frozen=True)
class _Part:
    """The prey or the predators of one subject: where they stand among all agents."""

    scene: int
    kind: Kind
    agents: slice


class Trajectories:
    """The paths of all agents of one subject or of several, prey first, continuous in time.

    Times are ticks since the start, lengths metres. Ticks are loaded when they are needed, and forgotten when no trail
    reaches back to them: memory does not grow with time. A recording can be gone back in, a live simulation cannot.

    count, prey: how many agents there are, and how many of them are prey. dim: 2 or 3.
    scene: [agent], which subject each belongs to. kind: [agent], a Kind; is_prey: [agent], bool.
    ticks: [subject], how many each runs.
    end: [agent], the tick at which the agent is gone, inf for those of whom that is not known. fate: [agent], as in FATES.
    latecomers: whether anybody came after the start.
    period: [agent, dim], size of a periodic world, 0 for others; None when no world is periodic.
    """

    def __init__(self, subjects: Sequence[Recording | Live], behind: float = 0, per_tick: int = 2, most: int = TRAILED):
        """Load the start.

        behind: how far back trails reach [ticks]; per_tick: their points per tick; with more agents than `most` there are none.

        Errors: ValueError when flat and 3-D subjects are mixed.
        """
        self.subjects = subjects
        self.per_tick = per_tick
        self._behind, self._most = behind, most
        self._watchers: list[Watcher] = []
        self._rewind()

    def watch(self, watcher: Watcher) -> None:
        """Call a function with the tick and all places [agent, dim] at the start, now, and after each tick that is loaded."""
        self._watchers.append(watcher)
        self._rewind()

    def _rewind(self) -> None:
        """Load the start and the first tick."""
        self._players = [played(subject) for subject in self.subjects]
        first = [next(player) for player in self._players]
        self.dim = first[0][0].position.shape[1]
        if any(prey.position.shape[1] != self.dim for prey, _ in first):
            raise ValueError("recordings: some are flat and some are 3-D; film them one by one")
        self._parts, start = [], 0
        for kind in Kind:
            for scene, both in enumerate(first):
                end = start + len(both[kind].position)
                self._parts.append(_Part(scene, kind, slice(start, end)))
                start = end
        self.count, self.prey = start, sum(len(prey.position) for prey, _ in first)
        self.is_prey = np.arange(start) < self.prey
        self.kind = np.where(self.is_prey, Kind.PREY, Kind.PREDATORS)
        self.scene = np.concatenate([np.full(part.agents.stop - part.agents.start, part.scene) for part in self._parts])
        self.ticks = np.array([subject.ticks for subject in self.subjects])
        worlds = [subject.scenario.world for subject in self.subjects]
        periods = np.array([np.resize(box.period(world.size, world.boundary), self.dim) for world in worlds])
        self.period = periods[self.scene] if periods.any() else None
        self._allocate()
        self._running, self.loaded = list(range(len(self.subjects))), 0
        for scene, both in enumerate(first):
            self._note(scene, both)
        self.end[np.isnan(self._place[:, 0])] = 0
        self._rest, self._rest_slope, self._rest_from = self._place.copy(), self._slope.copy(), self.end.copy()
        self._tell()
        self._advance()

    def _allocate(self) -> None:
        """Make room for two ticks, and for the points of trails."""
        shape = self.count, self.dim
        self._place, self._slope, self._begin, self._ahead, self._leaving, self._coming = np.full((6, *shape), np.nan)
        self._judged = np.full(shape, np.nan)
        self._bend, self._twist = np.full((2, *shape), np.nan)  # the curves' coefficients of the second and third power
        self._state, self._state_before, self.fate = np.zeros((3, self.count), np.uint8)
        self.latecomers = False
        self._group, self._group_before = np.full((2, self.count), -1, np.int32)
        self.end = np.full(self.count, np.inf)
        trailed = self._behind > 0 and self.count <= self._most
        rows = min(int(np.ceil(self._behind)), int(self.ticks.max())) + 2 if trailed else 0
        self._knots = np.full((rows * self.per_tick, *shape), np.nan)

    @property
    def trailed(self) -> bool:
        """Tell whether points of trails are kept."""
        return len(self._knots) > 0

    @property
    def newest(self) -> np.ndarray:
        """Give the states of the newest tick that is loaded, as CALM, ALARMED, ...: [agent]."""
        return self._state

    @property
    def last(self) -> int:
        """Give the last tick of all; of a simulation that still runs, the last that it may reach."""
        return int(self.ticks.max())

    def _note(self, scene: int, both: tuple[Moment, Moment]) -> None:
        """Write down a tick of a subject."""
        dt = self.subjects[scene].scenario.world.dt
        for part in self._parts:
            if part.scene == scene:
                moment, agents = both[part.kind], part.agents
                self._place[agents] = moment.position
                np.multiply(moment.velocity, dt, out=self._slope[agents], dtype=float)
                self._state[agents], self._group[agents] = _codes(moment.state), moment.group
                leaving = np.isnan(self._place[agents, 0]) & np.isinf(self.end[agents])
                if leaving.any():
                    self.fate[agents][leaving] = [FATES.index(name) for name in moment.fate[leaving]]
                    judged = getattr(moment, "judged", None)  # which recordings know
                    if judged is not None:
                        self._judged[agents][leaving] = judged[leaving]

    def _advance(self) -> None:
        """Load the next tick of all subjects that still run, and lay the curves to it."""
        ticks = {}
        for scene in list(self._running):
            both = next(self._players[scene], None)
            if both is None:
                self._stop(scene)
            else:
                ticks[scene] = both
        if not ticks:
            return
        self._begin[:], self._leaving[:] = self._place, self._slope
        self._state_before[:], self._group_before[:] = self._state, self._group
        for scene, both in ticks.items():
            self._note(scene, both)
        self.loaded += 1
        self._let_in()
        np.add(self._begin, self.shortest(self._place - self._begin), out=self._ahead)
        self._coming[:] = self._slope
        gone = np.flatnonzero(np.isnan(self._place[:, 0]) & np.isinf(self.end))
        if len(gone):
            self._let_go(gone)
        lay(self._begin, self._ahead, self._leaving, self._coming, self._bend, self._twist)
        if len(self._knots):
            self._tie()
        self._tell()

    def _tell(self) -> None:
        for watcher in self._watchers:
            watcher(self.loaded, self._place)

    def _stop(self, scene: int) -> None:
        """Leave everybody of a subject that has ended where it is."""
        self._running.remove(scene)
        self.ticks[scene] = self.loaded
        staying = (self.scene == scene) & np.isinf(self.end)
        self._rest[staying], self._rest_slope[staying] = self._place[staying], self._slope[staying]
        self._rest_from[staying] = self.loaded

    def _let_in(self) -> None:
        """Let who comes after the start, as tracked animals do, enter as it moves."""
        come = np.flatnonzero((self.end < self.loaded) & np.isfinite(self._place[:, 0]))
        if len(come):
            self.end[come] = self._rest_from[come] = np.inf
            self._leaving[come] = self._slope[come]
            self._begin[come] = self.within(self._place[come] - self._slope[come], come)
            self.latecomers = True

    def _let_go(self, gone: np.ndarray) -> None:
        """Whoever dies or arrives in a tick goes to where that was judged; where nobody knows, on as it moved.

        Then captor meets captive.
        """
        self.end[gone] = self._rest_from[gone] = self.loaded
        known = np.isfinite(self._judged[gone, 0])
        told, gone_on = gone[known], gone[~known]
        self._coming[told] = self.shortest(self._judged[told] - self._begin[told], told)
        self._coming[gone_on] = self._leaving[gone_on]
        self._ahead[gone] = self._begin[gone] + self._coming[gone]
        captured = gone_on[self.fate[gone_on] == CAPTURED]
        captors = captured[~self.is_prey[captured]]
        for captive in captured[self.is_prey[captured]]:
            captors = captors[captors != self._met(captive, captors)]
        self._rest[gone], self._rest_slope[gone] = self.within(self._ahead[gone], gone), self._coming[gone]

    def _met(self, captive: int, captors: np.ndarray) -> int:
        """Let a captive and the nearest predator that died in the same tick end at the point between them; -1 for none.

        Pairs farther apart than two agents that touch and their last steps together are no pairs.
        """
        scene = self.scene[captive]
        rivals = captors[self.scene[captors] == scene]
        if not len(rivals):
            return -1
        apart = self.shortest(self._ahead[rivals] - self._ahead[captive], rivals)
        gaps = np.linalg.norm(apart, axis=1)
        captor, half = int(rivals[gaps.argmin()]), apart[gaps.argmin()] / 2
        scenario = self.subjects[scene].scenario
        touch = scenario.prey.radius + scenario.predators.radius
        if gaps.min() > touch + np.linalg.norm(self._leaving[[captor, captive]], axis=1).sum():
            return -1
        self._ahead[captive] += half
        self._ahead[captor] -= half
        for agent in (captive, captor):
            self._coming[agent] = self._ahead[agent] - self._begin[agent]
        return captor

    def shortest(self, step: np.ndarray, agents: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Take steps across the edge of a periodic world, where that is shorter."""
        return step if self.period is None else box.displacement(step, self.period[agents])

    def within(self, spots: np.ndarray, agents: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Bring places back into a periodic world."""
        return spots if self.period is None else box.wrap(spots, self.period[agents])

    def _tie(self) -> None:
        """Keep points of the newest curves for trails: points fixed in time do not crawl."""
        tick = self.loaded - 1
        resting = self._rest_from <= tick
        for n in range(self.per_tick):
            knot = self._between(n / self.per_tick)
            knot[resting] = self._rest[resting]
            self._knots[(tick * self.per_tick + n) % len(self._knots)] = knot

    def _between(self, f: float) -> np.ndarray:
        """Give places at a share of the way between the two ticks that are loaded."""
        return self.within(along(f, self._begin, self._leaving, self._bend, self._twist))

    def reach(self, time: float) -> bool:
        """Load what is known up to a time; tell whether something still moves then.

        Errors: ValueError for a time that a live simulation has passed.
        """
        if time < self.loaded - 1:
            if not all(isinstance(subject, Recording) for subject in self.subjects):
                raise ValueError(f"time: a live simulation is at tick {self.loaded} and cannot go back; record it first")
            self._rewind()
        while self._running and self.loaded <= int(time):
            self._advance()
        return time < self.last

    def spots(self, time: float) -> np.ndarray:
        """Give places at a time: [agent, dim]; an agent that is gone stays where it went."""
        self.reach(time)
        spots = self._between(min(time - (self.loaded - 1), 1.0))
        resting = time >= self._rest_from
        spots[resting] = self._rest[resting]
        return spots

    def speeds(self, time: float, agents: np.ndarray) -> np.ndarray:
        """Give velocities [m/tick] of some agents at a time: [agent, dim]."""
        self.reach(time)
        f = min(time - (self.loaded - 1), 1.0)
        speeds = self._leaving[agents] + f * (2 * self._bend[agents] + 3 * f * self._twist[agents])
        resting = np.flatnonzero(time >= self._rest_from[agents])
        speeds[resting] = self._rest_slope[agents[resting]]
        return speeds

    def states(self, time: float) -> np.ndarray:
        """Give the states, as CALM, ALARMED, ..., of the tick before a time: [agent]."""
        self.reach(time)
        return self._state if time >= self.loaded else self._state_before

    def groups(self, time: float) -> np.ndarray:
        """Give the sub-swarms, or clusters chased, of the tick before a time: [agent], -1 for none."""
        self.reach(time)
        return self._group if time >= self.loaded else self._group_before

    def knots(self, first: int, last: int) -> np.ndarray:
        """Give the points of trails from number `first` to before `last`, `per_tick` for each tick: [knot, agent, dim]."""
        return self._knots.take(np.arange(first, last) % len(self._knots), axis=0)


def _codes(state: np.ndarray) -> np.ndarray:
    """Turn names of states into numbers."""
    codes = np.where(state == "calm", np.uint8(CALM), np.uint8(ACTING))
    for name, code in _NAMED if codes.any() else ():
        codes[state == name] = code
    return codes
