"""Springs: which agents a spring links now, followed tick by tick, and how it is drawn: by its tension."""

import numpy as np

from render.raster.shapes import colour
from render.scene.trajectories import ACTING, Trajectories
from render.theme import Theme
from tiswarm.scenario.model import Scenario
from tiswarm.strategies import registry

STRAINED = 0.15
"""A spring this much longer or shorter than at rest has the full colour [share of its length]."""


def sprung(scenario: Scenario) -> bool:
    """Tell whether the prey of a scenario are linked by springs."""
    return "damper" in registry.parts("prey", scenario.prey.strategy)


class Springs:
    """The springs of one scene, by the rule of strategies/prey/damper.py: of near agents, or those that an agent has kept."""

    def __init__(self, paths: Trajectories, scene: int, theme: Theme):
        """Follow a scene from its start."""
        self._paths, self._weights = paths, paths.subjects[scene].scenario.prey.weights
        self._prey = np.flatnonzero(paths.is_prey & (paths.scene == scene))
        self._colours = colour(theme.prey[0]), theme["ink"], colour(theme.predator)
        paths.watch(self._follow)

    def _follow(self, tick: int, place: np.ndarray) -> None:
        own = place[self._prey]
        apart = np.linalg.norm(self._paths.shortest(own[None] - own[:, None], self._prey), axis=2)
        near = apart < float(self._weights["span"]) * float(self._weights["length"])
        np.fill_diagonal(near, val=False)
        keeps = self._paths.newest[self._prey] == ACTING
        if tick == 0:
            self._links, self._near, self._kept = near, near, np.zeros(len(own), bool)
        begun = keeps & ~self._kept
        self._links = np.where(begun[:, None], self._near, np.where(keeps[:, None], self._links, near))
        self._near, self._kept = near, keeps

    def linked(self, agents: np.ndarray) -> np.ndarray:
        """Tell which of some agents a spring pulls, on either side: [agent, agent]."""
        at = np.searchsorted(self._prey, agents)
        links = self._links[np.ix_(at, at)]
        return links | links.T

    def hues(self, lengths: np.ndarray) -> np.ndarray:
        """Colour springs by their tension: as prey where they push, as predators where they pull, in ink at rest."""
        rest = float(self._weights["length"])
        strain = np.clip((lengths / rest - 1) / STRAINED, -1, 1)
        pushes, calm, pulls = (np.array(each) for each in self._colours)
        full = np.where(strain[:, None] > 0, pulls, pushes)
        return calm + np.abs(strain)[:, None] * (full - calm)
