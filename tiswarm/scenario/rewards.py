"""Rewards: what learners are paid for, each agent by itself; no trial's course depends on it."""

from tiswarm.scenario.parts import Part, Real


class PreyRewards(Part):
    """What each prey is paid."""

    arrived: Real = 1.0  # for arriving
    captured: Real = -1.0  # for being caught
    crashed: Real = -1.0  # for touching an obstacle
    nearer: Real = 0.01  # for coming nearer to the target [1/m]
    tick: Real = 0.0  # for each tick that it is there


class PredatorRewards(Part):
    """What each predator is paid."""

    touched: Real = 1.0  # for touching prey, where touches kill
    captured: Real = 0.0  # for each prey that anybody caught
    arrived: Real = 0.0  # for each prey that arrived
    crashed: Real = -1.0  # for touching an obstacle, or the target
    tick: Real = 0.0  # for each tick that it is there


class Rewards(Part):
    """What agents are paid in environments (docs/learning.md)."""

    prey: PreyRewards = PreyRewards()  # what each prey is paid
    predators: PredatorRewards = PredatorRewards()  # what each predator is paid
