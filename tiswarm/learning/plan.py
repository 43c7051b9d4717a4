"""Plan: what a tuning searches, for what, and how many trials it may spend, all of it checked."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, get_args

import numpy as np

from tiswarm.learning import halving
from tiswarm.learning.keys import Arm, arms
from tiswarm.learning.objective import Across, Objective, check_numbers
from tiswarm.learning.race import Round, rounds
from tiswarm.learning.search import Method, check_method
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.presets import Subject, loaded
from tiswarm.simd.philox import seed_words


@dataclass(frozen=True)
class Budget:
    """What a tuning may spend: trials of the search (budget), how a generation uses them, and trials beside the search.

    halving: whether hopeless candidates meet a part of a generation's trials only.
    """

    budget: int
    candidates: int
    trials: int
    checks: int
    validation: int
    halving: bool = False

    @property
    def rungs(self) -> tuple[int, ...]:
        """List how many trials candidates have met when the worse half of them leaves, and at the end."""
        return halving.rungs(self.trials) if self.halving else (self.trials,)

    @property
    def cost(self) -> int:
        """Count the trials of a generation."""
        return halving.cost(self.candidates, self.rungs)

    @property
    def generations(self) -> int:
        """Count the generations that the budget pays."""
        return self.budget // self.cost

    def check(self) -> None:
        """Raise ScenarioError for a budget that pays nothing."""
        if self.candidates < 4:
            raise ScenarioError(f"candidates: {self.candidates} are too few to rank; use 4 or more")
        if self.trials < 1:
            raise ScenarioError(f"trials: {self.trials} is not possible; use 1 or more a candidate")
        if self.halving and self.trials < halving.PARTS:
            raise ScenarioError(f"halving: {self.trials} trials are too few to part; use {halving.PARTS} or more a candidate")
        if self.generations < 1:
            raise ScenarioError(
                f"budget: {self.budget} trials do not pay one generation of {self.candidates} candidates by {self.trials}; "
                f"use {self.cost:,} or more"
            )
        check_numbers(self.generations, self.trials, self.checks, self.validation)


@dataclass(frozen=True, eq=False)
class Plan:
    """What a tuning does. shares: [scenario], how much each counts in the mean, or None; network: whose is trained, or none."""

    scenarios: tuple[Scenario, ...]
    over: Mapping[str, Any]
    arms: tuple[Arm, ...]
    objective: Objective
    across: Across
    shares: np.ndarray | None
    budget: Budget
    network: str
    method: Method
    seed: int

    @classmethod
    def made(
        cls,
        scenario: Subject | Sequence[Subject],
        over: Mapping[str, Any] | None,
        budget: Budget,
        objective: str,
        across: Across,
        shares: Sequence[float] | None,
        network: str,
        method: Method,
        seed: int,
    ) -> "Plan":
        """Load and check. Errors: ScenarioError for what cannot be."""
        subjects = [scenario] if isinstance(scenario, Scenario | str | os.PathLike) else list(scenario)
        scenarios = tuple(loaded(each) for each in subjects)
        if not scenarios:
            raise ScenarioError("tune: no scenario; name one")
        if across not in get_args(Across):
            raise ScenarioError(f"across: {across!r} is not allowed; use 'mean' or 'worst'")
        seed_words(seed)
        budget.check()
        check_method(method, budget.candidates, budget.halving)
        aim = Objective.read(objective)
        ordered = dict(sorted((over or {}).items()))  # so that no bit depends on their order
        found = tuple(arms(scenarios, ordered, network))
        counted = _shares(shares, len(scenarios))
        return cls(scenarios, ordered, found, aim, across, counted, budget, network, method, seed)

    def rounds(self) -> list[Round]:
        """Share generations out among the arms. Errors: ScenarioError when there are too few."""
        if self.network or any(arm.ranges for arm in self.arms):
            return rounds(len(self.arms), self.budget.generations)
        return [Round(len(self.arms), 1)]

    def told(self) -> dict[str, Any]:
        """Give what must be the same for generations to go together, as plain tables."""
        shares = None if self.shares is None else self.shares.tolist()
        told = {
            "tune": {path: list(each) for path, each in self.over.items()},
            "objective": {"maximise": str(self.objective), "across": self.across, "shares": shares},
            "network": self.network,
            "method": self.method,
            "seed": self.seed,
            "budget": asdict(self.budget),
            "scenario_hash": [each.hash() for each in self.scenarios],
        }
        plain: dict[str, Any] = json.loads(json.dumps(told))
        return plain


def _shares(shares: Sequence[float] | None, scenarios: int) -> np.ndarray | None:
    """Check how much scenarios count. Errors: ScenarioError."""
    if shares is None:
        return None
    found = np.asarray(shares, np.float64)
    if found.shape != (scenarios,) or not np.isfinite(found).all() or found.min() < 0 or found.sum() <= 0:
        raise ScenarioError(f"shares: {list(shares)} do not fit {scenarios} scenarios; use a number of 0 or more for each")
    return found / found.sum()
