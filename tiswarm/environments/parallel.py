"""Parallel: one trial as PettingZoo's ParallelEnv, an agent a learner."""

from typing import Any, ClassVar

import numpy as np
from gymnasium import spaces
from pettingzoo import ParallelEnv

from tiswarm.environments.environment import Environment
from tiswarm.environments.vector import box_of
from tiswarm.environments.view import View
from tiswarm.scenario.model import Scenario


class SwarmParallelEnv(ParallelEnv):
    """Agents "prey_0", "prey_1", ... and "predators_0", ..., as far as they obey; who is gone leaves `agents`."""

    metadata: ClassVar[dict[str, Any]] = {
        "render_modes": ["rgb_array"],
        "name": "tiswarm",
        "render_fps": 10,
        "is_parallelizable": True,
    }

    def __init__(self, scenario: str | Scenario, *, render_mode: str | None = None, **choices: Any) -> None:
        """Begin nothing yet. choices: control, actions and observe, as of `Environment`."""
        self.environment = Environment(scenario, 1, again=False, **choices)
        self.render_mode = render_mode
        self._view = View(self.environment, render_mode)
        self.possible_agents = list(self.environment.agents)
        self.agents: list[str] = []
        shown = spaces.Box(-np.inf, np.inf, (self.environment.observation_size,), np.float32)
        told = box_of(self.environment, (self.environment.action_size,))
        self.observation_spaces = {name: spaces.Box(shown.low, shown.high) for name in self.possible_agents}
        self.action_spaces = {name: spaces.Box(told.low, told.high) for name in self.possible_agents}

    def observation_space(self, agent: str) -> spaces.Space:
        """Give what an agent may be shown."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space:
        """Give what an agent may be told."""
        return self.action_spaces[agent]

    def reset(self, seed: int | None = None, options: dict | None = None) -> tuple[dict, dict]:  # noqa: ARG002 - as its base
        """Begin a trial: the first of a seed, or the next one."""
        shown = self.environment.reset(seed)
        self.agents = list(self.possible_agents)
        self._view.begin()
        return {name: shown[0, k].copy() for k, name in enumerate(self.agents)}, {name: {} for name in self.agents}

    def step(self, actions: dict) -> tuple[dict, dict, dict, dict, dict]:
        """Make one move; actions: agent -> [number]."""
        told = np.zeros((1, len(self.possible_agents), self.environment.action_size))
        numbers = {name: k for k, name in enumerate(self.possible_agents)}
        for name in self.agents:
            told[0, numbers[name]] = actions[name]
        shown, paid, terminated, truncated = self.environment.step(told)
        self._view.look()
        now = self.agents
        alive = self.environment.alive[0]
        gone = {name: bool(terminated[0] or not alive[numbers[name]]) for name in now}
        cut = {name: bool(truncated[0]) and not gone[name] for name in now}
        self.agents = [name for name in now if not (gone[name] or cut[name])]
        observations = {name: shown[0, numbers[name]].copy() for name in now}
        rewards = {name: float(paid[0, numbers[name]]) for name in now}
        return observations, rewards, gone, cut, {name: {} for name in now}

    def render(self) -> np.ndarray | None:
        """Give a frame of our films."""
        return self._view.frame()

    def close(self) -> None:
        """Do nothing: nothing is open."""
