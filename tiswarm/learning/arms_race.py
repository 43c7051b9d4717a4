"""Arms race: both sides of a game answer each other's best mixture by new numbers, or by a network (double oracle)."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.engine.run import simulate
from tiswarm.learning.race_rules import Contestants, Rules, Training
from tiswarm.learning.store import Store
from tiswarm.learning.tune import tune
from tiswarm.learning.tuned import Tuned
from tiswarm.records.results import Estimate
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.presets import load
from tiswarm.studies import zero_sum
from tiswarm.system.files import write_text

SIDES = ("prey", "predators")

LEAST_SHARE = 0.01
"""Policies that a mixture plays more rarely are not answered."""

RESAMPLES = 200


@dataclass(frozen=True)
class Policy:
    """One way for a side to behave: keys of the scenario; born: the round that found it, 0 for those of the beginning.

    The file of a network that the race trained is named from its folder on.
    """

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

    def best(self, side: str) -> Answer:
        """Give the answer with which a side gains most."""
        return max((each for each in self.answers if each.side == side), key=lambda answer: answer.gain.mean)

    @property
    def exploitability(self) -> float:
        """Give how much both sides together gain by their best answers, a side that gains nothing left out."""
        return sum(max(self.best(side).gain.mean, 0.0) for side in SIDES)

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
        return self._base.replaced(self._placed({**prey.changes, **predators.changes}))

    def _placed(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """Name the files of networks that the race trained from where the process is."""
        own = {path: self.folder / str(value) for path, value in changes.items() if path.endswith(".weights.network")}
        return {**changes, **{path: str(file) for path, file in own.items() if file.is_file()}}

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
            for best in map(made.best, SIDES):
                if best.accepted:
                    self._policies[best.side].append(best.policy)
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
        answers = [self._answers(side, number, trials, solution, fresh) for side in SIDES]
        return Round(number, prey, predators, trials.mean(axis=2), away, solution, spread.value, (*answers[0], *answers[1]))

    def _outcomes(self, prey: Policy, predators: Policy) -> np.ndarray:
        """Give the prey's success in the trials of a cell, which no search sees: [trial]."""
        scenario = self.scenario(prey, predators)
        held = self._store.read(scenario.hash())
        if held is not None and held["success"].shape == (self.trials,):
            return held["success"]
        success = simulate(scenario, self.trials, self.seed).success
        self._store.keep(scenario.hash(), {"success": success})
        return success

    def _answers(
        self, side: str, number: int, trials: np.ndarray, solution: zero_sum.Solution, fresh: bool
    ) -> tuple[Answer, ...]:
        """Search for numbers of one side against the other's mixture, and where these gain little, train a network."""
        own, others = self._policies[side], self._policies["predators" if side == "prey" else "prey"]
        mixed = np.einsum("i,j,ijk->k", solution.rows, solution.columns, trials)
        task = _Task(side, number, others, solution.columns if side == "prey" else solution.rows, mixed, fresh)
        by_numbers = self._by_numbers(task, self._best(own, task))
        training = self._contestants(side).network
        if training is None or (by_numbers.accepted and by_numbers.gain.mean >= training.under):
            return (by_numbers,)
        led = [each for each in own if f"{side}.weights.network" in each.changes]
        begin = Policy(_name(training.begin), training.begin, 0)
        return by_numbers, self._by_network(task, self._best([begin, *led], task), training)

    def _contestants(self, side: str) -> Contestants:
        return self.rules.prey if side == "prey" else self.rules.predators

    def _best(self, policies: Sequence[Policy], task: "_Task") -> Policy:
        """Give the policy that does best against the other side's mixture, the first of equals."""
        return max(policies, key=lambda policy: task.sign * self._won(policy, task).mean())

    def _won(self, policy: Policy, task: "_Task") -> np.ndarray:
        """Give the prey's success where a policy meets the other side's mixture: [trial]."""
        meetings = [
            (share, *task.pair(policy, each)) for share, each in zip(task.shares, task.others, strict=True) if share > 0
        ]
        return np.asarray(sum(share * self._outcomes(prey, predators) for share, prey, predators in meetings))

    def _by_numbers(self, task: "_Task", start: Policy) -> Answer:
        """Search for numbers, beginning with those of a policy."""
        known = self.scenario(*task.pair(start, task.others[0])).numbers()
        over = {path: tuple(ends) for path, ends in self._contestants(task.side).over.items() if path in known}
        tuned = self._searched(task, start, self.rules, over, "")
        return self._told(task, start, tuned.changes)

    def _by_network(self, task: "_Task", start: Policy, training: Training) -> Answer:
        """Train a network, beginning with that of a policy."""
        key = f"{task.side}.weights.network"
        tuned = self._searched(task, start, training, {}, task.side)
        file = (task.folder("-network") / "network.npz").as_posix()
        return self._told(task, start, {key: (start.changes[key], file)} if tuned.improved else {})

    def _searched(self, task: "_Task", start: Policy, spent: Rules | Training, over: Mapping[str, Any], network: str) -> Tuned:
        """Search against those whom the mixture plays, each counted as it is played."""
        met = [k for k in range(len(task.others)) if task.shares[k] > LEAST_SHARE]
        return tune(
            [self.scenario(*task.pair(start, task.others[k])) for k in met],
            over,
            spent.budget,
            "success" if task.sign > 0 else "-success",
            candidates=spent.candidates,
            trials=spent.search_trials,
            checks=self.rules.checks,
            validation=2,
            seed=self.seed + task.number + 1,
            folder=self.folder / task.folder("-network" if network else ""),
            fresh=task.fresh,
            network=network,
            shares=[float(task.shares[k]) for k in met],
        )

    def _told(self, task: "_Task", start: Policy, moved: dict[str, tuple[Any, Any]]) -> Answer:
        """Say what an answer gains, on the trials of the matrix."""
        changes = {**start.changes, **{path: new for path, (_, new) in moved.items()}}
        policy = Policy(f"{_plain(start.name)} {task.number + 1}", changes, task.number + 1)
        gain = Estimate.of(task.sign * (self._won(policy, task) - task.mixed))
        return Answer(task.side, start.name, policy, gain, moved)


@dataclass(frozen=True, eq=False)
class _Task:
    """What one side answers in a round: the others and how they are mixed, [other], and the prey's success so far, [trial]."""

    side: str
    number: int
    others: Sequence[Policy]
    shares: np.ndarray
    mixed: np.ndarray
    fresh: bool

    @property
    def sign(self) -> float:
        """Give which way the prey's success is good."""
        return 1.0 if self.side == "prey" else -1.0

    def pair(self, own: Policy, other: Policy) -> tuple[Policy, Policy]:
        """Give who meets whom, the prey first."""
        return (own, other) if self.side == "prey" else (other, own)

    def folder(self, kind: str) -> Path:
        """Give where a search lies, within the race's folder."""
        return Path(f"round-{self.number}") / f"{self.side}{kind}"


def _name(changes: Mapping[str, Any]) -> str:
    """Name a policy by its words, a network's file left out."""
    words = [value for path, value in changes.items() if isinstance(value, str) and not path.endswith(".network")]
    return " ".join(words) or "base"


def _plain(name: str) -> str:
    words = name.split(" ")
    return " ".join(words[:-1]) if words[-1].isdigit() else name
