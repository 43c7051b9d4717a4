"""Run: many trials to their ends, or one trial tick by tick, on whichever engine its scenario needs."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from operator import index
from typing import TYPE_CHECKING, Any

import numpy as np

from tiswarm.engine.choice import engine_of
from tiswarm.engine.trials import batch
from tiswarm.engine.trials.batch import Finished, Progress
from tiswarm.engine.trials.judged import Judged
from tiswarm.engine.trials.trial import Single
from tiswarm.engine.trials.ways import notes
from tiswarm.records.labels import grouped, named
from tiswarm.records.recording import Recording
from tiswarm.records.recording import Swarm as Moment
from tiswarm.records.results import Results
from tiswarm.records.terms import differences
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.presets import Subject, loaded
from tiswarm.scenario.start import Start
from tiswarm.simd import philox, runtime
from tiswarm.strategies import registry
from tiswarm.system.progress import reporting

if TYPE_CHECKING:  # trials alone do not wait for the engine of large swarms
    from tiswarm.engine.swarms.simulation import Alone

MOST_TRIALS = 100_000_000
"""Outcomes of a batch stay in memory, 28 bytes a trial."""


def simulate(
    scenario: Subject,
    trials: int = 1000,
    seed: int = 0,
    progress: Progress = False,
    weights: Mapping[str, np.ndarray] | None = None,
) -> Results:
    """Run trials 0, 1, ... of a scenario, as loaded, or by its name or path.

    progress: True shows a bar on a terminal; a function is called with trials done and trials in all.
    weights: path of any numeric key -> [trial], a number for each trial: {"prey.weights.evade": array}.

    Errors: ValueError for fewer than one trial or a seed out of range; ScenarioError for weights that are not allowed.
    """
    trials, seed = _checked(trials, seed)
    scenario = loaded(scenario)
    if weights:
        if scenario.world.neighbours == "grid":
            raise ScenarioError("weights: numbers of single trials need all pairs; set world.neighbours to 'all-pairs'")
        counts = batch.check_weights(scenario, weights, trials)
        return batch.run([scenario], trials, seed, progress, weights, counts)[0]
    return simulate_many([scenario], trials, seed, progress)[0]


def simulate_many(
    scenarios: Sequence[Scenario],
    trials: int = 1000,
    seed: int = 0,
    progress: Progress = False,
    finished: Finished | None = None,
) -> list[Results]:
    """Run the same trials of several scenarios as one batch with one kernel, which holds the code of all of them.

    Each scenario gets the same bits as on its own: code that it does not use counts with a weight of zero.
    finished: called with a scenario's place and its results once its last trial is over, while others still run.
    """
    trials, seed = _checked(trials, seed)
    engines = [engine_of(scenario) for scenario in scenarios]
    if "grid" in engines:
        return _run_apart(scenarios, engines, trials, seed, progress, finished)
    return batch.run(list(scenarios), trials, seed, progress, finished=finished)


def _run_apart(
    scenarios: Sequence[Scenario],
    engines: Sequence[str],
    trials: int,
    seed: int,
    progress: Progress,
    finished: Finished | None,
) -> list[Results]:
    """Run scenarios one after the other, large swarms among them through a grid."""
    results: list[Results] = []
    with reporting(progress, trials * len(scenarios), "trials") as report:
        for scenario, engine in zip(scenarios, engines, strict=True):
            done = trials * len(results)
            if engine == "grid":
                from tiswarm.engine.swarms.batch import outcomes

                own, measured = outcomes(scenario, trials, seed, lambda here, done=done: report(done + here))  # type: ignore[misc]
                results.append(Results.of(scenario, seed, runtime.start(), own, measured, None, engine))
            else:
                results += batch.run([scenario], trials, seed, lambda here, _, done=done: report(done + here))  # type: ignore[misc]
            if finished is not None:
                finished(len(results) - 1, results[-1])
    return results


def _checked(trials: int, seed: int) -> tuple[int, int]:
    """Give both as plain whole numbers. Errors: ValueError, or TypeError for what is no whole number."""
    trials, seed = index(trials), index(seed)
    philox.seed_words(seed)
    if not 1 <= trials <= MOST_TRIALS:
        raise ValueError(f"trials: {trials} is not possible; use 1 to {MOST_TRIALS:,}")
    return trials, seed


class Simulation:
    """One trial, tick by tick: step it, look at it, change its numbers; `render.film(Simulation(scenario), path)` films it.

    The trial is the one of that number and seed in a batch, bit for bit, and a recording of it, whichever engine runs it.

    scenario: what runs now, with the numbers that `set` changed; its counts are those of an explicit start.
    """

    def __init__(
        self, scenario: Subject, seed: int = 0, trial: int = 0, start: Start | None = None, *, terms: bool = False
    ) -> None:
        """Draw the start from seed and trial number, or take an explicit one, whose counts replace the scenario's.

        terms: let a recording keep what each term added to every velocity, too; no bit of the path depends on it.

        Errors: ScenarioError for what no engine can do; ValueError for a seed or trial number out of range, or a start that
        does not fit the world.
        """
        self.seed, self.trial = index(seed), index(trial)
        scenario = loaded(scenario)
        if start is not None:
            scenario = start.applied(scenario)
        self.engine = engine_of(scenario)
        self._terms = terms
        self._own: Single | Alone
        if self.engine == "grid":
            from tiswarm.engine.swarms import simulation

            self._own = simulation.Alone(scenario, self.seed, self.trial, start, terms=terms)
        else:
            self._own = Single(scenario, self.seed, self.trial, start, terms=terms)

    @property
    def scenario(self) -> Scenario:
        """Give the scenario that runs, with the numbers that were set last."""
        return self._own.scenario

    @property
    def age(self) -> int:
        """Count the ticks run."""
        return self._own.age

    @property
    def max_ticks(self) -> int:
        """Say how many ticks it runs at most."""
        return self.scenario.world.ticks

    @property
    def ticks(self) -> int:
        """Say how many ticks it runs at most, as films ask for it (`render.Live`)."""
        return self.max_ticks

    @property
    def ended(self) -> bool:
        """Tell whether the trial is over: nobody is left, or no tick."""
        return self._own.ended

    def step(self, ticks: int = 1) -> None:
        """Run so many ticks, fewer when the trial ends before. Errors: ValueError for a negative number."""
        ticks = index(ticks)
        if ticks < 0:
            raise ValueError(f"step: {ticks} ticks are not possible; use 0 or more")
        self._own.step(ticks)

    def position(self, kind: str = "prey") -> np.ndarray:
        """Give where the "prey" or "predators" are: [agent, dim], m, NaN for those who are gone."""
        return self._own.position(_kind(kind))

    def velocity(self, kind: str = "prey") -> np.ndarray:
        """Give their velocity: [agent, dim], m/s, NaN for those who are gone."""
        return self._own.velocity(_kind(kind))

    def fate(self, kind: str = "prey") -> np.ndarray:
        """Name what became of each agent so far: [agent], one of "alive", "arrived", "captured", "crashed"."""
        return self._own.fate(_kind(kind))

    def memory(self, kind: str = "prey") -> dict[str, dict[str, np.ndarray]]:
        """Give the agents' memory: strategy -> name -> [agent]."""
        return self._own.memory(_kind(kind))

    @property
    def obstacles(self) -> tuple[np.ndarray, np.ndarray]:
        """Give the obstacles' centres and radii: [obstacle, dim] and [obstacle], m."""
        return self._own.obstacles()

    @property
    def obstacle_position(self) -> np.ndarray:
        """Give the obstacles' centres: [obstacle, dim], m."""
        return self.obstacles[0]

    @property
    def obstacle_radius(self) -> np.ndarray:
        """Give the obstacles' radii: [obstacle], m."""
        return self.obstacles[1]

    def moment(self, kind: str = "prey") -> Moment:
        """Give the agents as they are now, as one tick of a recording: arrays [agent, ...]."""
        own = _kind(kind)
        position, others = self.position(own), self.position("predators" if own == "prey" else "prey")
        velocity = self.velocity(own)
        state = named(self.scenario, own, position, velocity, others, self._own.memory(own))
        surveyed = self._own.groups(own)
        group = grouped(self.scenario, own, len(position)) if surveyed is None else surveyed.astype(np.int32)
        return Moment(position, velocity, self.fate(own), state, group)

    def set(self, changes: Mapping[str, Any]) -> None:
        """Change numbers of the scenario from now on: {"prey.weights.evade": 0.2, "predators.max_speed": 3}.

        Any number may change that may differ between the trials of a batch, except those that act at the start only. No kernel
        is compiled anew, except for a large swarm whose new perception or world needs another kind of cells. The state of
        now is judged by the new numbers: a larger radius may kill at once.

        Errors: ScenarioError for an unknown key, for what is code and no number, and for numbers out of range;
        ValueError once the trial is over. Nothing has changed then.
        """
        if self.ended:
            raise ValueError("set: the trial is over; begin a new Simulation with these numbers")
        scenario = self.scenario.replaced(changes)
        settled, known = batch.differing(scenario), scenario.numbers()
        for key in changes:
            paths = [path for path in known if path == key or path.startswith(f"{key}.")]
            if not paths or not settled.issuperset(paths):
                raise ScenarioError(f"set: {key} is no number that may change between ticks; begin a new Simulation with it")
            planned = scenario.prey.goal_by == "path" and key.startswith(("target.", "planning."))
            if planned or key.startswith("obstacles.") or key.endswith((".count", ".spawn")) or ".spawn." in key:
                raise ScenarioError(f"set: {key} acts at the start only; begin a new Simulation with it")
        self._own.renumber(scenario)

    def __iter__(self) -> Iterator[tuple[Moment, Moment]]:
        """Run to the end: give prey and predators now, then after each tick."""
        yield self.moment("prey"), self.moment("predators")
        while not self.ended:
            self.step()
            yield self.moment("prey"), self.moment("predators")

    def record(self) -> Recording:
        """Run to the end and keep the path from here on."""
        moments: list[tuple[Moment, Moment]] = []
        courses: tuple[list[dict[str, np.ndarray]], list[dict[str, np.ndarray]]] = ([], [])
        judged = Judged(self._own) if isinstance(self._own, Single) else None
        for both in self:
            if judged:
                judged.note()
            if self._terms and moments:
                for kept, kind in zip(courses, ("prey", "predators"), strict=True):
                    kept.append(self._own.courses(kind))
            moments.append(both)
        prey, predators = (
            replace(
                path := Moment.of(own), terms=differences(path.velocity, kept), judged=judged.places[kind] if judged else None
            )
            for kind, own, kept in zip(("prey", "predators"), zip(*moments, strict=True), courses, strict=True)
        )
        told = notes(self._own) if isinstance(self._own, Single) else ()
        return Recording(self.scenario, self.seed, self.trial, prey, predators, *self.obstacles, told)


def record(scenario: Subject, trial: int = 0, seed: int = 0, start: Start | None = None, *, terms: bool = False) -> Recording:
    """Run one trial and keep its path: the same bits as in a batch of any size.

    start: an explicit start state; counts then come from it, not from the scenario.
    terms: keep what each term added to every velocity, too (`recording.prey.terms`); no bit of the path depends on it.
    """
    return Simulation(scenario, seed, trial, start, terms=terms).record()


def _kind(name: str) -> registry.Kind:
    """Check the name of a kind of agents. Errors: ValueError."""
    kinds: dict[str, registry.Kind] = {"prey": "prey", "predators": "predators"}
    if name in kinds:
        return kinds[name]
    raise ValueError(f"kind: '{name}' is unknown; use 'prey' or 'predators'")
