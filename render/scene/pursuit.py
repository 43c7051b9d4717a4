"""Pursuit: whom each predator chases: the middle of the swarm, of a part of it, or one of the prey."""

import numpy as np

from render.scene.trajectories import Trajectories
from tiswarm.scenario.model import Scenario
from tiswarm.strategies import registry


def chased(scenario: Scenario) -> str:
    """Say what predators of a scenario chase: "swarm", "group", "nearest" or "cycle", each tick another one.

    Errors: ValueError for a strategy that does not say.
    """
    name = scenario.predators.strategy
    kind = str(registry.load("predators", name).chases)
    if kind == "one":
        return str(scenario.predators.weights["pursuit"])
    if not kind:
        raise ValueError(f"overlay: pursuit: whom predators of strategy '{name}' chase is not known; leave it out")
    return kind


def quarries(paths: Trajectories, scene: int, kind: str, time: float, spots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Give the predators of a subject that chase something, and the ways from them to it: [predator], [predator, dim], m.

    spots: [agent, dim], where all are.
    """
    mine = (paths.scene == scene) & (paths.end > time)
    prey, hunters = np.flatnonzero(mine & paths.is_prey), np.flatnonzero(mine & ~paths.is_prey)
    if not len(prey) or not len(hunters):
        return hunters[:0], spots[:0]
    if kind in ("nearest", "cycle"):
        ways = paths.shortest(spots[prey][None] - spots[hunters][:, None], prey)
        picked = (
            np.linalg.norm(ways, axis=2).argmin(axis=1) if kind == "nearest" else np.full(len(hunters), int(time) % len(prey))
        )
        return hunters, ways[np.arange(len(hunters)), picked]
    if kind == "swarm":
        return hunters, paths.shortest(_middle(paths, prey, spots) - spots[hunters], hunters)
    groups = paths.groups(time)
    found = [(hunter, prey[groups[prey] == groups[hunter]]) for hunter in hunters if groups[hunter] >= 0]
    found = [(hunter, members) for hunter, members in found if len(members)]
    if not found:
        return hunters[:0], spots[:0]
    chasing = np.array([hunter for hunter, _ in found])
    middles = np.array([_middle(paths, members, spots) for _, members in found])
    return chasing, paths.shortest(middles - spots[chasing], chasing)


def _middle(paths: Trajectories, agents: np.ndarray, spots: np.ndarray) -> np.ndarray:
    """Give the mean place of agents, about the first of them: [dim]."""
    origin = spots[agents[0]]
    return np.asarray(origin + paths.shortest(spots[agents] - origin, agents).mean(axis=0))
