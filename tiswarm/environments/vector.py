"""Vector: trials as Gymnasium's VectorEnv, and one trial as its Env: one learner for all agents of a side."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from tiswarm.environments.environment import Environment, Policy
from tiswarm.environments.view import View
from tiswarm.scenario.model import Scenario


def box_of(environment: Environment, shape: tuple[int, ...]) -> spaces.Box:
    """Give what may be told: -1 to 1 of the greatest speed, factors of gains from 0 to 2."""
    low, high = (0.0, 2.0) if environment.actions == "gains" else (-1.0, 1.0)
    return spaces.Box(low, high, shape, np.float32)


class _Side:
    """The agents of one side, told by the learner; the other side follows its strategy, or a second policy."""

    def __init__(self, scenario: str | Scenario, trials: int, again: bool, control: str, opponent: Policy | None, choices: Any):
        both = "both" if opponent is not None else control
        self.environment = Environment(scenario, trials, again=again, control=both, **choices)  # type: ignore[arg-type]
        if control not in ("prey", "predators"):
            raise ValueError(f"control: {control!r} is not possible here; use 'prey' or 'predators'")
        self._opponent = opponent
        own = [k for k, name in enumerate(self.environment.agents) if name.startswith(f"{control}_")]
        self.own = slice(own[0], own[-1] + 1)
        self.count = len(own)
        self._others = np.setdiff1d(np.arange(len(self.environment.agents)), own)
        self.observation_space = spaces.Box(-np.inf, np.inf, (self.count, self.environment.observation_size), np.float32)
        self.action_space = box_of(self.environment, (self.count, self.environment.action_size))
        self._shown = np.zeros(0)

    def reset(self, seed: int | None, where: np.ndarray | None = None) -> np.ndarray:
        self._shown = self.environment.reset(seed, where)
        return self._shown[:, self.own].copy()

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        environment = self.environment
        told = np.zeros((environment.trials, len(environment.agents), environment.action_size))
        told[:, self.own] = actions
        if self._opponent is not None:
            told[:, self._others] = self._opponent(self._shown[:, self._others])
        self._shown, paid, terminated, truncated = environment.step(told)
        rewards = paid[:, self.own].sum(axis=1).astype(np.float64)
        return self._shown[:, self.own].copy(), rewards, terminated, truncated


class SwarmVectorEnv(VectorEnv):
    """Observations [trial, agent, number], actions [trial, agent, number], rewards [trial]: the sum over the side's agents.

    Where a trial ends another begins in the same step, and info holds the end: `final_obs`, and `_final_obs`, where that is.
    """

    metadata = {  # noqa: RUF012 - as its base has it
        "render_modes": ["rgb_array"],
        "render_fps": 10,
        "autoreset_mode": AutoresetMode.SAME_STEP,
    }

    def __init__(
        self,
        scenario: str | Scenario,
        trials: int = 1,
        *,
        control: str = "prey",
        opponent: Policy | None = None,
        render_mode: str | None = None,
        **choices: Any,
    ) -> None:
        """Begin nothing yet.

        control: the learner's side. opponent: tells the other side, from [trial, agent, number] that is shown to actions; the
        scenario's strategy when None. choices: actions and observe, as of `Environment`.
        """
        self._side = _Side(scenario, trials, True, control, opponent, choices)
        self.environment = self._side.environment
        self.num_envs, self.render_mode = trials, render_mode
        self._view = View(self.environment, render_mode)
        self.single_observation_space, self.single_action_space = self._side.observation_space, self._side.action_space
        self.observation_space = batch_space(self.single_observation_space, trials)
        self.action_space = batch_space(self.single_action_space, trials)

    def reset(self, *, seed: Any = None, options: dict | None = None) -> tuple[np.ndarray, dict]:
        """Begin all trials anew, or those of options["reset_mask"]. seed: one number for all trials."""
        if seed is not None and not isinstance(seed, int | np.integer):
            raise ValueError("seed: give one whole number; the trials of a seed differ by themselves")
        seed = None if seed is None else int(seed)
        super().reset(seed=seed)
        shown = self._side.reset(seed, (options or {}).get("reset_mask"))
        self._view.begin()
        return shown, {}

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict]:
        """Make one move of every trial."""
        shown, rewards, terminated, truncated = self._side.step(actions)
        over = terminated | truncated
        self._view.begin() if over[0] else self._view.look()
        info = {"final_obs": self.environment.final[:, self._side.own].copy(), "_final_obs": over} if over.any() else {}
        return shown, rewards, terminated, truncated, info

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Give a frame of our films, of the first trial."""
        frame = self._view.frame()
        return None if frame is None else (frame,)


class SwarmEnv(gymnasium.Env):
    """One trial: observations and actions [agent, number], the reward is the sum over the side's agents."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012 - as its base has it

    def __init__(
        self,
        scenario: str | Scenario,
        *,
        control: str = "prey",
        opponent: Policy | None = None,
        render_mode: str | None = None,
        **choices: Any,
    ) -> None:
        """Begin nothing yet. Choices are as of SwarmVectorEnv."""
        self._side = _Side(scenario, 1, False, control, opponent, choices)
        self.environment, self.render_mode = self._side.environment, render_mode
        self._view = View(self.environment, render_mode)
        self.observation_space, self.action_space = self._side.observation_space, self._side.action_space

    def reset(self, *, seed: int | None = None, options: dict | None = None) -> tuple[np.ndarray, dict]:  # noqa: ARG002 - as its base
        """Begin a trial: the first of a seed, or the next one."""
        super().reset(seed=seed)
        shown = self._side.reset(seed)
        self._view.begin()
        return shown[0], {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """Make one move."""
        shown, rewards, terminated, truncated = self._side.step(np.asarray(action)[None])
        self._view.look()
        return shown[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), {}

    def render(self) -> np.ndarray | None:
        """Give a frame of our films."""
        return self._view.frame()
