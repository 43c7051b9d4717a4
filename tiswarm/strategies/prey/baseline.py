"""Baseline: flock to the target and ignore the predators."""

from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Lupau 2022, section 6.2, baseline."""

    dimensions = (2, 3)
