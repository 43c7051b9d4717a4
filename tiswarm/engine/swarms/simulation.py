"""Simulation: large swarms, one or many at once; agents that follow each other in cell order are a thread's lanes."""

from collections.abc import Iterator
from dataclasses import replace
from operator import index

import numpy as np

from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.choice import check, sweeps
from tiswarm.engine.swarms import initial
from tiswarm.engine.swarms.state import SwarmState
from tiswarm.records.labels import grouped, named
from tiswarm.records.recording import FATES, Recording
from tiswarm.records.recording import Swarm as Moment
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.start import Start
from tiswarm.simd import runtime
from tiswarm.strategies import registry

MOST_TRIALS = 2**31 - 1

Paths = tuple[np.ndarray, np.ndarray]


class Swarm(SwarmState):
    """Trials of a scenario with any number of agents, tick by tick; positions are read when they are asked for.

    A single trial can be filmed while it runs (`render.film(Swarm(scenario), path)`).

    trial: number of the first trial. All else is as in `SwarmState`.
    """

    def __init__(
        self,
        scenario: Scenario,
        seed: int = 0,
        trials: int = 1,
        trial: int = 0,
        start: Start | Paths | None = None,
        *,
        terms: bool = False,
    ) -> None:
        """Draw the starts of `trials` trials from number `trial` on, the same as in a batch, or take an explicit one.

        start: one for all trials; or positions and velocities of prey alone, [trial, agent, dim] each, m and m/s, NaN for those
        who are not there: trials and agents are then counted there.
        terms: whether `record` keeps what each term added to every velocity.

        Errors: ScenarioError for what needs the trials of few agents (`neighbours = "all-pairs"`); ValueError for numbers that
        are not finite.
        """
        seed, trials, trial = index(seed), index(trials), index(trial)
        if trials < 1 or not 0 <= trial <= MOST_TRIALS - trials:
            raise ValueError(
                f"trials: {trials} from number {trial} on are not possible; use 1 or more, up to number {MOST_TRIALS}"
            )
        if isinstance(start, tuple):
            start = np.asarray(start[0], np.float64), np.asarray(start[1], np.float64)
            if start[0].ndim != 3 or start[0].shape != start[1].shape or start[0].shape[2] != scenario.world.dim:
                told = " and ".join(str(each.shape) for each in start)
                raise ValueError(f"start: positions and velocities {told} need [trial, agent, dim]")
            trials = start[0].shape[0]
        elif start is not None:
            scenario = start.applied(scenario)
        check(scenario)
        unmeasured = scenario.replaced({"measures.names": [], "coverage.cell": 0})  # measures.py has kernels of its own
        mortal = bool(scenario.predators.count or scenario.obstacles.count or scenario.target.present)
        structure = Specialisation.of([unmeasured], scenario.predators.count, mortal=mortal, terms=terms)
        if not sweeps(scenario):  # nobody asks then how far agents came, and nothing need be kept
            structure = replace(structure, frame=replace(structure.frame, swept=False))
        layout = ParameterTable(structure, runtime.types().lanes)
        if isinstance(start, Start):
            states = initial.given(start, trials)
        else:
            states = initial.drawn(scenario, layout, seed, trial, trials)
            states = states if start is None else {**states, "prey": start}
        super().__init__(scenario, layout, seed, trial, states)

    def position(self, kind: str = "prey") -> np.ndarray:
        """Give where the agents are: [trial, agent, dim], m, NaN for those who are gone."""
        return self._crowds[kind].grid.gathered(slice(0, self.scenario.world.dim))

    def velocity(self, kind: str = "prey") -> np.ndarray:
        """Give their velocity: [trial, agent, dim], m/s, NaN for those who are gone."""
        dim = self.scenario.world.dim
        return self._crowds[kind].grid.gathered(slice(dim, 2 * dim))

    def fate(self, kind: str = "prey") -> np.ndarray:
        """Name what became of each agent so far: [trial, agent]."""
        crowd = self._crowds[kind]
        if not self.mortal:
            return np.full((self.trials, crowd.grid.count), FATES[0])
        return np.array(FATES)[crowd.row(self._layout.rows.fate)[:, : crowd.grid.count].astype(int)]

    @property
    def hits(self) -> np.ndarray:
        """Count the prey that have been inside an obstacle, where obstacles.contact only counts that: [trial]."""
        crowd = self._prey
        return crowd.row(self._layout.rows.hit).sum(axis=1) if self.mortal else np.zeros(self.trials)

    def memory(self, kind: str) -> dict[str, dict[str, np.ndarray]]:
        """Give the agents' memory: strategy -> name -> [trial, agent]."""
        crowd = self._crowds[kind]
        rows = {
            p.part.name: {
                name: crowd.row(row)[:, : crowd.grid.count] for name, row in zip(p.memory, p.memory_rows, strict=True)
            }
            for p in self._layout.parts(kind, "strategy")
        }
        return {name: memory for name, memory in rows.items() if memory}

    def courses(self, kind: str) -> dict[str, np.ndarray]:
        """Give the velocity behind each term of the last move, in their order: name -> [trial, agent, dim], m/s."""
        crowd = self._crowds[kind]
        return {
            name: np.stack([crowd.row(row)[:, : crowd.grid.count] for row in rows], axis=-1).astype(np.float64)
            for name, rows in self._layout.courses[kind].items()
        }

    @property
    def obstacle_position(self) -> np.ndarray:
        """Give the centres of the first trial's obstacles: [obstacle, dim], m."""
        here = self.position("obstacles")[0]
        return here[np.isfinite(here[:, 0])]

    @property
    def obstacle_radius(self) -> np.ndarray:
        """Give their radii: [obstacle], m."""
        radii = self.velocity("obstacles")[0, :, 0]
        return radii[np.isfinite(radii)]

    def moment(self, kind: registry.Kind) -> Moment:
        """Give the agents of the first trial as they are now, as one tick of a recording: arrays [agent, ...]."""
        other = "predators" if kind == "prey" else "prey"
        position = self.position(kind)[0]
        memories = {name: {key: rows[0] for key, rows in each.items()} for name, each in self.memory(kind).items()}
        velocity = self.velocity(kind)[0]
        state = named(self.scenario, kind, position, velocity, self.position(other)[0], memories)
        return Moment(position, velocity, self.fate(kind)[0], state, grouped(self.scenario, kind, len(position)))

    def record(self) -> Recording:
        """Run the first trial to its end and keep its path."""
        prey, predators = (Moment.of(own) for own in zip(*self, strict=True))
        return Recording(self.scenario, self.seed, self.trial, prey, predators, self.obstacle_position, self.obstacle_radius)

    def __iter__(self) -> Iterator[tuple[Moment, Moment]]:
        """Run the first trial to its end: give prey and predators now, then after each tick."""
        yield self.moment("prey"), self.moment("predators")
        while not self.ended[0]:
            self.step()
            yield self.moment("prey"), self.moment("predators")


class Alone:
    """One trial of a large swarm, with what engine/trials/trial.py's Single gives: arrays [agent, ...]."""

    def __init__(self, scenario: Scenario, seed: int, trial: int, start: Start | None = None, *, terms: bool = False) -> None:
        """Draw the start from seed and trial number, or take an explicit one. Errors: as of `Swarm`."""
        self._swarm = Swarm(scenario, seed, 1, trial, start, terms=terms)

    @property
    def scenario(self) -> Scenario:
        """Give the scenario that runs."""
        return self._swarm.scenario

    @property
    def age(self) -> int:
        """Count the ticks run."""
        return self._swarm.age

    @property
    def ended(self) -> bool:
        """Tell whether the trial is over."""
        return bool(self._swarm.ended[0])

    def step(self, ticks: int) -> None:
        """Run so many ticks, fewer when the trial ends before."""
        left = min(ticks, self._swarm.ticks - self._swarm.age)
        if not self._swarm.mortal:
            self._swarm.step(left)
            return
        for _ in range(left):
            if not self.ended:
                self._swarm.step()

    def position(self, kind: str) -> np.ndarray:
        """Give where agents are: [agent, dim], m, NaN for those who are gone."""
        return self._swarm.position(kind)[0]

    def velocity(self, kind: str) -> np.ndarray:
        """Give their velocity: [agent, dim], m/s, NaN for those who are gone."""
        return self._swarm.velocity(kind)[0]

    def courses(self, kind: str) -> dict[str, np.ndarray]:
        """Give the velocity behind each term of the last move, in their order: name -> [agent, dim], m/s."""
        return {name: rows[0] for name, rows in self._swarm.courses(kind).items()}

    def fate(self, kind: str) -> np.ndarray:
        """Name what became of each agent so far: [agent]."""
        return self._swarm.fate(kind)[0]

    def memory(self, kind: str) -> dict[str, dict[str, np.ndarray]]:
        """Give the agents' memory: strategy -> name -> [agent]."""
        return {name: {key: rows[0] for key, rows in each.items()} for name, each in self._swarm.memory(kind).items()}

    def groups(self, kind: str) -> np.ndarray | None:  # noqa: ARG002 - as its sister's
        """Give no sub-swarms: predators that split up need all pairs."""
        return None

    def obstacles(self) -> tuple[np.ndarray, np.ndarray]:
        """Give the obstacles' centres and radii: [obstacle, dim] and [obstacle], m."""
        return self._swarm.obstacle_position, self._swarm.obstacle_radius

    def renumber(self, scenario: Scenario) -> None:
        """Take over the numbers of a scenario of the same structure and counts; they judge the state of now."""
        self._swarm.renumber(scenario)
