"""Tune: search for numbers of a scenario, choose among generations by trials aside, validate on trials that nobody saw."""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.engine.trials.candidates import Candidates
from tiswarm.learning import halving
from tiswarm.learning.keys import Arm
from tiswarm.learning.objective import Across, Evaluation, World, check_trials, scores_of, search_trials
from tiswarm.learning.plan import Budget, Plan
from tiswarm.learning.race import Round
from tiswarm.learning.search import Method, Search, check_cmaes, suited
from tiswarm.learning.store import Store
from tiswarm.learning.tuned import Check, Generation, Tuned, validated
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.network import Network
from tiswarm.scenario.presets import Subject
from tiswarm.system.progress import reporting

CHECKS = 20
"""How often a tuning looks at the middle of its search, spread evenly over its generations."""

TRIALS = {"cma-es": 200, "openai-es": 10}
"""Trials of a candidate: small steps in many directions pay by their number, not by how well each is known."""

Finished = Callable[[Generation], None]


def tune(
    scenario: Subject | Sequence[Subject],
    over: Mapping[str, Any] | None = None,
    budget: int = 1_280_000,
    objective: str = "success",
    across: Across = "mean",
    candidates: int = 32,
    trials: int | None = None,
    checks: int = 2000,
    validation: int = 10_000,
    seed: int = 0,
    folder: str | os.PathLike | None = None,
    fresh: bool = False,
    network: str = "",
    shares: Sequence[float] | None = None,
    progress: bool | Callable[[int, int], None] = False,
    finished: Finished | None = None,
    method: Method | None = None,
    halve: bool = False,
    world: World = Candidates,
) -> Tuned:
    """Find numbers (and choices) that make an objective large.

    scenario: one or several, by name, path or as loaded; across: whether their mean or the worst of them counts.
    over: key -> (low, high), (low, high, "log"), (low, high, "whole"), or a list of choices.
    budget: trials of the search: generations of `candidates` with `trials` each, 10 for openai-es, else 200, when left out. All
    candidates of a generation meet the same trials, each generation new ones. checks: trials that tell which generation was
    best; validation: trials that neither search nor checks saw, on which alone start and result are compared.
    folder: where generations are kept, and taken from when the same tuning was cut short before; None keeps nothing.
    shares: how much each scenario counts in the mean, all alike when None.
    network: prey or predators, whose network is trained, beside the keys of `over`; needs a folder, where it is written.
    fresh: throw away what the folder holds. finished: called with each generation.
    method: cma-es or openai-es; None: openai-es for a network, cma-es for all else and where candidates leave. halve: the worse
    half of a generation leaves after a quarter of its trials, and after half. world: what runs candidates; for those of a
    cluster, `functools.partial(SharedCandidates, cluster)`.

    Errors: ScenarioError for what cannot be; ValueError when the folder holds another tuning or cmaes is missing.
    """
    started = time.perf_counter()
    chosen = method or suited(network, halve)
    spent = Budget(budget, candidates, TRIALS.get(chosen, 1) if trials is None else trials, checks, validation, halve)
    plan = Plan.made(scenario, over, spent, objective, across, shares, network, chosen, seed)
    if network and folder is None:
        raise ScenarioError("tune: a network is written to a file; name a folder for it")
    check_cmaes()
    share_out = plan.rounds()
    store = None
    if folder is not None:
        store = Store(Path(folder), plan.told(), [one for arm in plan.arms for one in (*plan.scenarios, *arm.scenarios)])
    run = _Run(plan, store, world)
    if store is not None:
        store.open(fresh)
    best, history = run.search(share_out, progress, finished)
    seconds = time.perf_counter() - started
    result = validated(plan.scenarios, run.tuned(best), plan.objective, across, validation, seed, best, history, seconds)
    if store is not None:
        store.write(**result.told(), wall_time_s=round(store.about.get("wall_time_s", 0.0) + result.seconds, 3))
        result.save(store.folder)
    return result


class _Run:
    """One tuning while it runs: the arms, what they are asked, and what is kept."""

    def __init__(self, plan: Plan, store: Store | None, world: World) -> None:
        self._arms = plan.arms
        self._across: Across = plan.across
        self._budget = plan.budget
        self._store = store
        counts = (plan.objective, plan.across, plan.seed, plan.shares, world)
        self._start = Evaluation(Arm((), plan.scenarios, ()), *counts)
        self._worlds = [Evaluation(arm, *counts) for arm in plan.arms]
        self._searches = [
            Search(arm.start, plan.budget.candidates, (plan.seed, k), np.array([each.step for each in arm.ranges]), plan.method)
            if arm.ranges or arm.side
            else None
            for k, arm in enumerate(plan.arms)
        ]
        self._check_every = max(plan.budget.generations // CHECKS, 1)

    def tuned(self, best: Check) -> tuple[Scenario, ...]:
        """Give the scenarios that a check looked at; a trained network is written."""
        arm = self._start.arm if best.arm < 0 else self._arms[best.arm]
        file = ""
        if arm.network is not None and self._store:
            weights = best.values[len(arm.ranges) :]
            file = str(Network(arm.network.shape, weights).save(self._store.folder / "network.npz"))
        return arm.tuned(best.values, file)

    def search(
        self, shares: Sequence[Round], progress: bool | Callable[[int, int], None], finished: Finished | None
    ) -> tuple[Check, list[Generation]]:
        """Run all rounds of the race; give the best check, the start's own among them, and all generations."""
        start = self._checked("start", -1, np.zeros(0))
        best, history = start, list[Generation]()
        alive = list(range(len(self._arms)))
        total = self._budget.generations * self._budget.cost
        with reporting(progress, total, "trials") as report:
            for share in shares:
                latest: dict[int, Check] = {}
                for arm in alive:
                    for turn in range(share.generations if self._searches[arm] else 1):
                        due = turn + 1 == share.generations or (len(history) + 1) % self._check_every == 0
                        made = self._generation(len(history), arm, due, start)
                        history.append(made)
                        if made.check is not None:
                            latest[arm] = made.check
                            best = max(best, made.check, key=lambda check: check.score)  # the earlier one of equals
                        if finished is not None:
                            finished(made)
                        report(min(len(history), self._budget.generations) * self._budget.cost)
                alive = sorted(sorted(alive, key=lambda arm: -latest[arm].score)[: (len(alive) + 1) // 2])
        return best, history

    def _generation(self, number: int, arm: int, due: bool, start: Check) -> Generation:
        """Run a generation, or take it from disk, and let the search know."""
        begun = time.perf_counter()
        search, world, name = self._searches[arm], self._worlds[arm], f"{number:05d}"
        if search is None:  # nothing but choices: the arm itself is its only candidate
            units, centre = np.zeros((1, 0)), np.zeros(0)
            check: Check | None = (alone := self._checked(f"{name}-check", arm, centre, start))
            scores, met = np.array([alone.score]), np.zeros(1, np.int64)
        else:
            units = search.ask()
            scores, met = self._scored(name, world, units, search_trials(number, self._budget.trials))
            search.tell(halving.standing(scores, met))
            centre = search.centre
            check = self._checked(f"{name}-check", arm, world.arm.settled(centre), start) if due else None
        seconds = time.perf_counter() - begun
        return Generation(number, self._budget.generations, arm, world.arm, units, scores, met, centre, check, seconds)

    def _scored(self, name: str, world: Evaluation, units: np.ndarray, trials: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Run candidates, or take them from disk; give scores, and how many trials each met: [candidate]."""
        held = self._store.read(name) if self._store else None
        if held is not None and np.array_equal(held["units"], units):
            return held["scores"], held["met"]
        scores, met = halving.run(world.outcomes, world.joined, world.arm.values(units), trials, self._budget.rungs)
        if self._store:
            self._store.keep(name, {"units": units, "scores": scores, "met": met})
        return scores, met

    def _checked(self, name: str, arm: int, values: np.ndarray, start: Check | None = None) -> Check:
        """Run the middle of a search through the trials aside, or take it from disk."""
        world = self._start if arm < 0 else self._worlds[arm]
        held = self._store.read(name) if self._store else None
        if held is not None and np.array_equal(held["values"], values):
            outcomes = held["outcomes"]
        else:
            outcomes = world.outcomes(values[None], check_trials(self._budget.checks))
            if self._store:
                self._store.keep(name, {"values": values, "outcomes": outcomes})
        score = float(scores_of(outcomes, self._across, world.shares)[0])
        return Check(arm, values, score, outcomes[:, 0], None if start is None else start.outcomes, world.shares)
