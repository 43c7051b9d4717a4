"""Make: environments by name, in the interface that is asked for; libraries that not everybody has are imported then."""

from typing import TYPE_CHECKING, Any

from tiswarm.environments.environment import Environment
from tiswarm.scenario.model import Scenario
from tiswarm.system.extras import needed

if TYPE_CHECKING:
    from tiswarm.environments.parallel import SwarmParallelEnv
    from tiswarm.environments.vector import SwarmEnv, SwarmVectorEnv


def env(scenario: str | Scenario, trials: int = 1, **choices: Any) -> Environment:
    """Give trials that are stepped from outside, as NumPy arrays [trial, agent, ...].

    choices: control, actions, observe and again, as of `Environment`. Errors: ScenarioError, ValueError.
    """
    return Environment(scenario, trials, **choices)


def parallel_env(scenario: str | Scenario, *, render_mode: str | None = None, **choices: Any) -> "SwarmParallelEnv":
    """Give one trial as PettingZoo's ParallelEnv. choices: control, actions and observe, as of `Environment`.

    Errors: MissingExtra without the extra `rl`; ScenarioError, ValueError.
    """
    needed("rl", "pettingzoo")
    from tiswarm.environments.parallel import SwarmParallelEnv

    return SwarmParallelEnv(scenario, render_mode=render_mode, **choices)


def vector_env(
    scenario: str | Scenario, trials: int = 1, *, render_mode: str | None = None, **choices: Any
) -> "SwarmVectorEnv":
    """Give trials as Gymnasium's VectorEnv, one learner for all agents of a side. choices: as of SwarmVectorEnv.

    Errors: MissingExtra without the extra `rl`; ScenarioError, ValueError.
    """
    needed("rl", "gymnasium")
    from tiswarm.environments.vector import SwarmVectorEnv

    return SwarmVectorEnv(scenario, trials, render_mode=render_mode, **choices)


def gym_env(scenario: str | Scenario, *, render_mode: str | None = None, **choices: Any) -> "SwarmEnv":
    """Give one trial as Gymnasium's Env, one learner for all agents of a side. choices: as of SwarmVectorEnv.

    Errors: MissingExtra without the extra `rl`; ScenarioError, ValueError.
    """
    needed("rl", "gymnasium")
    from tiswarm.environments.vector import SwarmEnv

    return SwarmEnv(scenario, render_mode=render_mode, **choices)
