"""Finite: an agent whose place or velocity is no finite number ends the run by an error, and counts nowhere."""

import numpy as np

from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario

STRANGE = -1
"""What stands in the place of a trial's count of prey alive when a state was not finite at its end."""


class NotFiniteError(ScenarioError):
    """A trial in which an agent is nowhere; the message names trial, tick, agent and strategy."""


def check(scenario: Scenario, trial: int, tick: int, kind: str, state: np.ndarray, alive: np.ndarray) -> None:
    """Raise NotFiniteError if an agent that is there has a place or velocity that is not finite: [agent, number], [agent]."""
    strange = np.flatnonzero(alive & ~np.isfinite(state).all(axis=1))
    if len(strange):
        agents = getattr(scenario, kind)
        who = f"{'predator' if kind == 'predators' else 'prey'} {strange[0]}"
        raise NotFiniteError(
            f"trial {trial}, tick {tick}: {who} is at no finite place or velocity, by strategy '{agents.strategy}' with "
            f"avoidance '{agents.avoidance}'; nothing of this trial counts: lower its gains and weights, or mend the strategy"
        )
