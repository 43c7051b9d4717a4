"""Tune: search for numbers of a scenario, choose among generations by trials aside, validate on trials that nobody saw."""

import json
import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np

from tiswarm.learning.keys import Arm, arms
from tiswarm.learning.objective import (
    Across,
    Evaluation,
    Objective,
    check_numbers,
    check_trials,
    scores_of,
    search_trials,
)
from tiswarm.learning.race import Round, rounds
from tiswarm.learning.search import Search, check_cmaes
from tiswarm.learning.store import Store
from tiswarm.learning.tuned import Check, Generation, Tuned, validated
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.network import Network
from tiswarm.scenario.presets import load
from tiswarm.simd.philox import seed_words
from tiswarm.system.progress import reporting

CHECKS = 20
"""How often a tuning looks at the middle of its search, spread evenly over its generations."""

Subject = Scenario | str | os.PathLike
Finished = Callable[[Generation], None]


@dataclass(frozen=True)
class Budget:
    """What a tuning may spend: trials of the search (budget), how a generation uses them, and trials beside the search."""

    budget: int
    candidates: int
    trials: int
    checks: int
    validation: int

    @property
    def generations(self) -> int:
        """Count the generations that the budget pays."""
        return self.budget // (self.candidates * self.trials)

    def check(self) -> None:
        """Raise ScenarioError for a budget that pays nothing."""
        if self.candidates < 4:
            raise ScenarioError(f"candidates: {self.candidates} are too few to rank; use 4 or more")
        if self.trials < 1:
            raise ScenarioError(f"trials: {self.trials} is not possible; use 1 or more a candidate")
        if self.generations < 1:
            one = self.candidates * self.trials
            raise ScenarioError(
                f"budget: {self.budget} trials do not pay one generation of {self.candidates} candidates by {self.trials}; "
                f"use {one:,} or more"
            )
        check_numbers(self.generations, self.trials, self.checks, self.validation)


def tune(
    scenario: Subject | Sequence[Subject],
    over: Mapping[str, Any] | None = None,
    budget: int = 1_280_000,
    objective: str = "success",
    across: Across = "mean",
    candidates: int = 32,
    trials: int = 200,
    checks: int = 2000,
    validation: int = 10_000,
    seed: int = 0,
    folder: str | os.PathLike | None = None,
    fresh: bool = False,
    network: str = "",
    shares: Sequence[float] | None = None,
    progress: bool | Callable[[int, int], None] = False,
    finished: Finished | None = None,
) -> Tuned:
    """Find numbers (and choices) that make an objective large.

    scenario: one or several, by name, path or as loaded; across: whether their mean or the worst of them counts.
    over: key -> (low, high), (low, high, "log"), (low, high, "whole"), or a list of choices.
    budget: trials of the search: generations of `candidates` with `trials` each. All candidates of a generation meet the same
    trials, each generation new ones. checks: trials that tell which generation was best; validation: trials that neither search
    nor checks saw, on which alone start and result are compared.
    folder: where generations are kept, and taken from when the same tuning was cut short before; None keeps nothing.
    shares: how much each scenario counts in the mean, all alike when None.
    network: prey or predators, whose network is trained, beside the keys of `over`; needs a folder, where it is written.
    fresh: throw away what the folder holds. finished: called with each generation.

    Errors: ScenarioError for what cannot be; ValueError when the folder holds another tuning or cmaes is missing.
    """
    started = time.perf_counter()
    subjects = [scenario] if isinstance(scenario, Scenario | str | os.PathLike) else list(scenario)
    scenarios = [each if isinstance(each, Scenario) else load(each) for each in subjects]
    if not scenarios:
        raise ScenarioError("tune: no scenario; name one")
    if across not in get_args(Across):
        raise ScenarioError(f"across: {across!r} is not allowed; use 'mean' or 'worst'")
    seed_words(seed)
    spent = Budget(budget, candidates, trials, checks, validation)
    spent.check()
    aim = Objective.read(objective)
    over = dict(sorted((over or {}).items()))  # so that no bit depends on their order
    found = arms(scenarios, over, network)
    if network and folder is None:
        raise ScenarioError("tune: a network is written to a file; name a folder for it")
    check_cmaes()
    counts = _shares(shares, len(scenarios))
    share_out = rounds(len(found), spent.generations) if network or any(arm.ranges for arm in found) else [Round(len(found), 1)]
    store = None
    if folder is not None:
        told = {
            "tune": {path: list(each) for path, each in over.items()},
            "objective": {"maximise": str(aim), "across": across, "shares": None if counts is None else counts.tolist()},
            "network": network,
            "seed": seed,
            "budget": asdict(spent),
            "scenario_hash": [each.hash() for each in scenarios],
        }
        store = Store(
            Path(folder), json.loads(json.dumps(told)), [one for arm in found for one in (*scenarios, *arm.scenarios)]
        )
    run = _Run(found, scenarios, aim, across, counts, spent, seed, store)
    if store is not None:
        store.open(fresh)
    best, history = run.search(share_out, progress, finished)
    winner = run.tuned(best)
    result = validated(scenarios, winner, aim, across, spent.validation, seed, best, history, time.perf_counter() - started)
    if store is not None:
        store.write(**result.told(), wall_time_s=round(store.about.get("wall_time_s", 0.0) + result.seconds, 3))
        result.save(store.folder)
    return result


def _shares(shares: Sequence[float] | None, scenarios: int) -> np.ndarray | None:
    """Check how much scenarios count. Errors: ScenarioError."""
    if shares is None:
        return None
    found = np.asarray(shares, np.float64)
    if found.shape != (scenarios,) or not np.isfinite(found).all() or found.min() < 0 or found.sum() <= 0:
        raise ScenarioError(f"shares: {list(shares)} do not fit {scenarios} scenarios; use a number of 0 or more for each")
    return found / found.sum()


class _Run:
    """One tuning while it runs: the arms, what they are asked, and what is kept."""

    def __init__(
        self,
        found: list[Arm],
        scenarios: Sequence[Scenario],
        objective: Objective,
        across: Across,
        shares: np.ndarray | None,
        budget: Budget,
        seed: int,
        store: Store | None,
    ) -> None:
        self._arms = found
        self._across: Across = across
        self._budget = budget
        self._store = store
        self._start = Evaluation(Arm((), tuple(scenarios), ()), objective, across, seed, shares)
        self._worlds = [Evaluation(arm, objective, across, seed, shares) for arm in found]
        self._searches = [
            Search(arm.start, budget.candidates, (seed, k), np.array([each.step for each in arm.ranges], np.float64))
            if arm.ranges or arm.side
            else None
            for k, arm in enumerate(found)
        ]
        self._check_every = max(budget.generations // CHECKS, 1)

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
        total = self._budget.generations * self._budget.candidates * self._budget.trials
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
                        report(min(len(history), self._budget.generations) * self._budget.candidates * self._budget.trials)
                alive = sorted(sorted(alive, key=lambda arm: -latest[arm].score)[: (len(alive) + 1) // 2])
        return best, history

    def _generation(self, number: int, arm: int, due: bool, start: Check) -> Generation:
        """Run a generation, or take it from disk, and let the search know."""
        begun = time.perf_counter()
        search, world, name = self._searches[arm], self._worlds[arm], f"{number:05d}"
        if search is None:  # nothing but choices: the arm itself is its only candidate
            units, centre = np.zeros((1, 0)), np.zeros(0)
            check: Check | None = (alone := self._checked(f"{name}-check", arm, centre, start))
            scores = np.array([alone.score])
        else:
            units = search.ask()
            held = self._store.read(name) if self._store else None
            if held is not None and np.array_equal(held["units"], units):
                scores = held["scores"]
            else:
                scores = world.scores(world.arm.values(units), search_trials(number, self._budget.trials))
                if self._store:
                    self._store.keep(name, {"units": units, "scores": scores})
            search.tell(scores)
            centre = search.centre
            check = self._checked(f"{name}-check", arm, world.arm.settled(centre), start) if due else None
        seconds = time.perf_counter() - begun
        return Generation(number, self._budget.generations, arm, world.arm, units, scores, centre, check, seconds)

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
