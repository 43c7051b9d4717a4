"""Arms race: both sides of a game answer each other's best mixture by new numbers, round after round (double oracle)."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError

from tiswarm.engine.run import simulate
from tiswarm.learning.store import Store
from tiswarm.learning.tune import tune
from tiswarm.records.results import Estimate
from tiswarm.scenario.errors import ScenarioError, explained
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.parts import Part
from tiswarm.scenario.presets import load, read_toml
from tiswarm.studies import zero_sum
from tiswarm.studies.design import find_study
from tiswarm.system.files import write_text

SIDES = ("prey", "predators")

LEAST_SHARE = 0.01
"""Policies that a mixture plays more rarely are not answered."""

RESAMPLES = 200


class Contestants(Part):
    """What one side begins with, and the keys that its answers may change: KEY = [LOW, HIGH] or [LOW, HIGH, SCALE]."""

    policies: Annotated[tuple[dict[str, Any], ...], Field(min_length=1)]
    over: dict[str, tuple[float, float] | tuple[float, float, str]]


class Rules(Part):
    """An arms race as its TOML file states it."""

    title: str
    source: str = ""
    base: str
    trials: Annotated[int, Field(strict=True, ge=2)] = 10_000  # of each cell of the pay-off matrix
    seed: Annotated[int, Field(strict=True, ge=0)] = 0
    rounds: Annotated[int, Field(strict=True, ge=1, le=100)] = 5
    budget: Annotated[int, Field(strict=True, ge=1)] = 128_000  # trials of each search, in each scenario that counts
    candidates: Annotated[int, Field(strict=True, ge=4)] = 24
    search_trials: Annotated[int, Field(strict=True, ge=1)] = 100  # of each candidate
    checks: Annotated[int, Field(strict=True, ge=2)] = 2000
    prey: Contestants
    predators: Contestants


def rules_of(name: str) -> Rules | None:
    """Read the rules of a race by the name or path of its file; None for a study that is none. Errors: ScenarioError."""
    table = read_toml(find_study(name))
    if "rounds" not in table:
        return None
    try:
        return Rules.model_validate(table)
    except ValidationError as error:
        raise ScenarioError(f"{name}: {explained(error, Rules)}") from None


@dataclass(frozen=True)
class Policy:
    """One way for a side to behave: keys of the scenario; born: the round that found it, 0 for those of the beginning."""

    name: str
    changes: Mapping[str, Any]
    born: int


@dataclass(frozen=True, eq=False)
class Answer:
    """What one side found against the other's mixture: from whom it began, what it gains there, and which keys moved."""

    side: str
    start: str
    policy: Policy
    gain: Estimate  # of its side's pay-off over the game's value, on trials of the matrix
    moved: dict[str, tuple[Any, Any]]

    @property
    def accepted(self) -> bool:
        """Tell whether the gain is more than its interval."""
        return self.gain.low > 0


@dataclass(frozen=True, eq=False)
class Round:
    """A game with all policies so far, its solution, and both sides' answers: payoff [prey, predators], the prey's success."""

    number: int
    prey: tuple[Policy, ...]
    predators: tuple[Policy, ...]
    payoff: np.ndarray
    away: np.ndarray
    solution: zero_sum.Solution
    value: tuple[float, float]
    answers: tuple[Answer, ...]

    @property
    def exploitability(self) -> float:
        """Give how much both sides together gain by their answers, those that gain nothing left out."""
        return sum(max(each.gain.mean, 0.0) for each in self.answers)

    def told(self) -> dict[str, Any]:
        """Give the round as plain tables."""
        return {
            "round": self.number,
            "value": {"mean": self.solution.value, "low": self.value[0], "high": self.value[1]},
            "prey": _told(self.prey, self.solution.rows),
            "predators": _told(self.predators, self.solution.columns),
            "payoff": self.payoff.tolist(),
            "half_interval": self.away.tolist(),
            "answers": [
                {
                    "side": each.side,
                    "start": each.start,
                    "name": each.policy.name,
                    "accepted": each.accepted,
                    "gain": {"mean": each.gain.mean, "low": each.gain.low, "high": each.gain.high},
                    "moved": {path: {"from": old, "to": new} for path, (old, new) in each.moved.items()},
                }
                for each in self.answers
            ],
        }


def _told(policies: Sequence[Policy], shares: np.ndarray) -> list[dict[str, Any]]:
    return [
        {"name": each.name, "born": each.born, "share": float(share), "changes": dict(each.changes)}
        for each, share in zip(policies, shares, strict=True)
    ]


class Race:
    """A race in a folder: cells of its matrix and the searches of its rounds, gone on with after a kill."""

    def __init__(self, rules: Rules, folder: Path, seed: int | None = None, trials: int | None = None) -> None:
        """Say whose race it is; nothing runs yet. Errors: ScenarioError."""
        self.rules = rules
        self.seed = rules.seed if seed is None else seed
        self.trials = trials or rules.trials
        self.folder = folder
        self._base = load(rules.base)
        begin = [Policy(_name(changes), changes, 0) for changes in rules.prey.policies]
        others = [Policy(_name(changes), changes, 0) for changes in rules.predators.policies]
        self._policies: dict[str, list[Policy]] = {"prey": begin, "predators": others}
        told = {"race": json.loads(rules.model_dump_json()), "seed": self.seed, "trials": self.trials}
        every = [self.scenario(one, other) for one in begin for other in others]
        self._store = Store(folder, told | {"scenario_hash": [each.hash() for each in every]}, every)

    def scenario(self, prey: Policy, predators: Policy) -> Scenario:
        """Give the world in which two policies meet."""
        return self._base.replaced({**prey.changes, **predators.changes})

    def run(self, fresh: bool = False, finished: Callable[[Round], None] | None = None) -> list[Round]:
        """Run rounds until neither side gains more than its interval, or there are no more.

        Errors: ValueError when the folder holds something else.
        """
        started = time.perf_counter()
        self._store.open(fresh)
        rounds: list[Round] = []
        for number in range(self.rules.rounds):
            made = self._round(number, fresh)
            rounds.append(made)
            for each in made.answers:
                if each.accepted:
                    self._policies[each.side].append(each.policy)
            write_text(self.folder / "race.json", json.dumps([each.told() for each in rounds], indent=2) + "\n")
            if finished is not None:
                finished(made)
            if not any(each.accepted for each in made.answers):
                break
        self._store.write(wall_time_s=round(self._store.about.get("wall_time_s", 0.0) + time.perf_counter() - started, 3))
        return rounds

    def _round(self, number: int, fresh: bool) -> Round:
        prey, predators = (tuple(self._policies[side]) for side in SIDES)
        trials = np.array([[self._outcomes(one, other) for other in predators] for one in prey])  # [prey, predators, trial]
        solution = zero_sum.solve(trials.mean(axis=2))
        spread = zero_sum.bootstrap(list(map(list, trials)), paired=True, seed=self.seed, resamples=RESAMPLES)
        away = np.array([[(e.high - e.low) / 2 for e in map(Estimate.of, row)] for row in trials])
        answers = tuple(self._answer(side, number, trials, solution, fresh) for side in SIDES)
        return Round(number, prey, predators, trials.mean(axis=2), away, solution, spread.value, answers)

    def _outcomes(self, prey: Policy, predators: Policy) -> np.ndarray:
        """Give the prey's success in the trials of a cell, which no search sees: [trial]."""
        scenario = self.scenario(prey, predators)
        held = self._store.read(scenario.hash())
        if held is not None and held["success"].shape == (self.trials,):
            return held["success"]
        success = simulate(scenario, self.trials, self.seed).success
        self._store.keep(scenario.hash(), {"success": success})
        return success

    def _answer(self, side: str, number: int, trials: np.ndarray, solution: zero_sum.Solution, fresh: bool) -> Answer:
        """Search for numbers of one side against the other's mixture, beginning with what does best against that."""
        rules, sign = (self.rules.prey, 1.0) if side == "prey" else (self.rules.predators, -1.0)
        own, others = self._policies[side], self._policies["predators" if side == "prey" else "prey"]
        shares = solution.columns if side == "prey" else solution.rows
        table = trials.mean(axis=2) if side == "prey" else trials.mean(axis=2).T
        start = own[int(np.argmax(sign * (table @ shares)))]
        met = [k for k in range(len(others)) if shares[k] > LEAST_SHARE]
        pairs = [(start, others[k]) if side == "prey" else (others[k], start) for k in met]
        scenarios = [self.scenario(*pair) for pair in pairs]
        known = scenarios[0].numbers()
        tuned = tune(
            scenarios,
            {path: tuple(ends) for path, ends in rules.over.items() if path in known},
            self.rules.budget,
            "success" if sign > 0 else "-success",
            candidates=self.rules.candidates,
            trials=self.rules.search_trials,
            checks=self.rules.checks,
            validation=2,
            seed=self.seed + number + 1,
            folder=self.folder / f"round-{number}" / side,
            fresh=fresh,
            shares=[float(shares[k]) for k in met],
        )
        moved = tuned.changes
        changes = {**start.changes, **{path: new for path, (_, new) in moved.items()}}
        policy = Policy(f"{_plain(start.name)} {number + 1}", changes, number + 1)
        mixed = np.einsum("i,j,ijk->k", solution.rows, solution.columns, trials)
        won = [self._outcomes(policy, each) if side == "prey" else self._outcomes(each, policy) for each in others]
        gain = Estimate.of(sign * (np.tensordot(shares, np.array(won), 1) - mixed))
        return Answer(side, start.name, policy, gain, moved)


def _name(changes: Mapping[str, Any]) -> str:
    """Name a policy by its words."""
    return " ".join(str(value) for value in changes.values() if isinstance(value, str)) or "base"


def _plain(name: str) -> str:
    words = name.split(" ")
    return " ".join(words[:-1]) if words[-1].isdigit() else name
