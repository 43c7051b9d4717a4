"""Environment: many trials stepped from outside, as arrays: actions in, observations, rewards and ends out."""

from collections.abc import Callable, Sequence
from operator import index
from typing import Literal

import numpy as np

from tiswarm.dynamics.commands import Command
from tiswarm.dynamics.table import GAINS
from tiswarm.engine.trials.session import Kind, Session
from tiswarm.environments.observations import Observer
from tiswarm.environments.payment import Payment
from tiswarm.environments.shown import DEFAULT
from tiswarm.records.recording import FATES, Recording, Swarm
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.presets import load
from tiswarm.simd import philox

Control = Literal["prey", "predators", "both"]
Policy = Callable[[np.ndarray], np.ndarray]

CONTROLS: dict[str, tuple[Kind, ...]] = {"prey": ("prey",), "predators": ("predators",), "both": ("prey", "predators")}

MOST_TRIALS = 1 << 31
"""Trials are numbered by 31 bits."""


class Environment:
    """Trials side by side whose agents obey: `reset`, then `step` again and again.

    Agents are those that obey, prey first. All arrays are [trial, agent, ...]; those that are given are this object's own and
    are written over by the next step: copy what you keep. A trial is the same bits at any number of trials and threads.

    Attributes: scenario; trials: how many; agents: their names ("prey_0", ...); actions: what they are told; action_size,
    observation_size: numbers of each; alive: [trial, agent], who obeys still; final: [trial, agent, number], what agents were
    shown last where a trial has ended.
    """

    def __init__(
        self,
        scenario: str | Scenario,
        trials: int = 1,
        *,
        control: Control = "prey",
        actions: Command = "velocity",
        observe: Sequence[str] = DEFAULT,
        again: bool = True,
    ) -> None:
        """Begin nothing yet.

        control: who obeys; the others follow the scenario's strategy. actions: "velocity", in units of max_speed;
        "acceleration", in units of max_speed a second; or "gains", factors of the scenario's own gains of separation,
        alignment, cohesion, goal and field. observe: what each agent is shown (docs/learning.md). again: whether another trial
        begins at once where one has ended.

        Errors: ScenarioError for a scenario that cannot be stepped so; ValueError for anything else that is not possible.
        """
        scenario = load(scenario) if isinstance(scenario, str) else scenario
        trials = index(trials)
        if not 1 <= trials <= 1_000_000:
            raise ValueError(f"trials: {trials} is not possible; use 1 to 1,000,000")
        if control not in CONTROLS:
            raise ValueError(f"control: {control!r} is unknown; use 'prey', 'predators' or 'both'")
        if actions not in ("velocity", "acceleration", "gains"):
            raise ValueError(f"actions: {actions!r} is unknown; use 'velocity', 'acceleration' or 'gains'")
        self.kinds = CONTROLS[control]
        for kind in self.kinds:
            _check(scenario, kind)
        self._asked = {"control": control, "actions": actions, "observe": tuple(observe)}
        self._session = Session(scenario, trials, dict.fromkeys(self.kinds, actions))
        self.scenario, self.trials, self.actions, self._again = scenario, trials, actions, again
        counts = {kind: self._session.count(kind) for kind in self.kinds}
        firsts = dict(zip(counts, np.cumsum([0, *counts.values()]).tolist(), strict=False))
        self._where = {kind: slice(first, first + counts[kind]) for kind, first in firsts.items()}
        self.agents = tuple(f"{kind}_{number}" for kind in self.kinds for number in range(counts[kind]))
        self._observers = [Observer(self._session, kind, observe, firsts[kind]) for kind in self.kinds]
        self._payment = Payment(self._session, self._where)
        speeds = [getattr(scenario, kind).max_speed for kind in self.kinds for _ in range(counts[kind])]
        self._scale = np.ones((len(speeds), 1)) if actions == "gains" else np.array(speeds)[:, None]
        self.action_size = len(GAINS) if actions == "gains" else scenario.world.dim
        self.observation_size = self._observers[0].shown.width
        shape = (trials, len(self.agents))
        self._filled = np.zeros((trials + 1, len(self.agents), self.observation_size), np.float32)
        self._shown = self._filled[:trials]
        self.final = np.zeros_like(self._shown)
        self.alive = np.zeros(shape, bool)
        self._terminated, self._truncated = np.zeros(trials, bool), np.zeros(trials, bool)
        self._episode = np.full(trials, -1, np.int64)
        self._seed = 0

    def reset(self, seed: int | None = None, where: np.ndarray | None = None) -> np.ndarray:
        """Begin trials anew; give what agents are shown: [trial, agent, number].

        seed: of all trials from now on, which begin with trials 0, 1, ...; None goes on with the next ones. where: [trial],
        bool, which to begin; all when None.

        Errors: ValueError for a seed that is not possible, or one for some of the trials only.
        """
        chosen = np.arange(self.trials) if where is None else np.flatnonzero(np.asarray(where, bool))
        if seed is not None:
            philox.seed_words(index(seed))
            if len(chosen) < self.trials:
                raise ValueError("seed: all trials have one; begin all of them, or give none")
            self._seed, self._episode[:] = index(seed), -1
        if len(chosen) < self.trials and (self._episode < 0).any():
            raise ValueError("where: no trial runs yet; begin all of them first")
        self._begin(chosen)
        return self._shown

    def _begin(self, chosen: np.ndarray) -> None:
        self._episode[chosen] += 1
        numbers = (chosen + self._episode[chosen] * self.trials) % MOST_TRIALS
        self._session.begin(chosen, numbers, self._seed)
        self._terminated[chosen] = self._truncated[chosen] = False
        self._payment.begin(chosen)
        self._look(chosen)

    def _look(self, where: np.ndarray) -> None:
        for observer in self._observers:
            observer.fill(self._filled, where)
        for kind, own in self._where.items():
            self.alive[:, own] = self._payment.alive(kind)

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Make one move of every trial.

        actions: [trial, agent, number]; those of agents that are gone count for nothing.

        Give observations [trial, agent, number], rewards [trial, agent], and terminated and truncated [trial]: no prey is left,
        or no tick. Where a trial has ended and another one begins at once, the observations are of its start, and `final` of
        the end.

        Errors: ValueError for actions of another shape, or that are not finite, and before `reset`.
        """
        self._check_actions(actions)
        running = ~(self._terminated | self._truncated)
        scaled = actions * self._scale
        for kind, own in self._where.items():
            self._session.tell(kind, scaled[:, own])
        self._session.step()
        rewards = self._payment.settle(running)
        ended, nobody = self._session.ended() & running, self._payment.nobody()
        self._terminated |= ended & nobody
        self._truncated |= ended & ~nobody
        terminated, truncated = self._terminated.copy(), self._truncated.copy()
        self._look(np.flatnonzero(running))
        over = np.flatnonzero(ended)
        if len(over):
            self.final[over] = self._shown[over]
            if self._again:
                self._begin(over)
        return self._shown, rewards, terminated, truncated

    def _check_actions(self, actions: np.ndarray) -> None:
        wanted = (self.trials, len(self.agents), self.action_size)
        if np.shape(actions) != wanted:
            raise ValueError(f"actions: shape {np.shape(actions)} does not fit; give {wanted}: trial, agent, number")
        if not np.isfinite(actions).all():
            raise ValueError("actions: some are not finite; clip what a policy gives")
        if self._episode[0] < 0:
            raise ValueError("step: no trial runs yet; call reset first")

    @property
    def trial(self) -> np.ndarray:
        """Give the number of each trial that runs, as random numbers know it: [trial]."""
        return self._session.trial.copy()

    def fate(self, kind: Kind = "prey") -> np.ndarray:
        """Name what became of each of the prey or predators so far: [trial, agent], one of recording.FATES."""
        return np.array(FATES)[self._payment.fate(kind)]

    def moments(self, trial: int = 0) -> tuple[Swarm, Swarm]:
        """Give prey and predators of one trial as they are now, as one tick of a recording."""
        return self._session.moments(trial)

    def recorded(self, moments: Sequence[tuple[Swarm, Swarm]], trial: int = 0) -> Recording:
        """Put moments of the trial that runs at a place one behind the other."""
        prey, predators = (Swarm.of(own) for own in zip(*moments, strict=True))
        number = int(self._session.trial[trial])
        told = tuple(f"{kind} obeyed from outside: {self.actions}" for kind in self.kinds)
        return Recording(self.scenario, self._seed, number, prey, predators, *self._session.obstacles(trial), told)

    def record(self, policy: Policy, seed: int = 0, trial: int = 0) -> Recording:
        """Run one trial by a policy, from [1, agent, number] that is shown to [1, agent, number] of actions, and keep its path.

        It runs by itself; this environment's trials do not move. trial: its number.
        """
        if not 0 <= index(trial) < MOST_TRIALS:
            raise ValueError(f"trial: {trial} is not possible; use 0 to {MOST_TRIALS - 1}")
        alone = Environment(self.scenario, 1, **self._asked, again=False)  # type: ignore[arg-type]
        alone._episode[:] = trial - 1
        alone._seed = index(seed)
        shown = alone.reset()
        moments = [alone.moments()]
        over = False
        while not over:
            shown, _, terminated, truncated = alone.step(policy(shown))
            moments.append(alone.moments())
            over = bool(terminated[0] or truncated[0])
        return alone.recorded(moments)


def _check(scenario: Scenario, kind: Kind) -> None:
    """Refuse agents that cannot obey. Errors: ScenarioError."""
    agents = getattr(scenario, kind)
    if not agents.count:
        raise ScenarioError(f"{kind}.count: nobody is there to obey; set it, or control the other side")
    if agents.field_of_view < 360:
        raise ScenarioError(f"{kind}.field_of_view: agents that obey are shown what is all around; set it to 360")
