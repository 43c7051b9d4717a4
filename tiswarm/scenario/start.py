"""Start: an explicit start state of a trial."""

from dataclasses import dataclass

import numpy as np

from tiswarm.scenario.model import Scenario
from tiswarm.scenario.parts import LIMIT


@dataclass(frozen=True)
class Start:
    """An explicit start state.

    prey_position, prey_velocity, predator_position, predator_velocity, obstacle_position: [agent or obstacle, dim], m and m/s;
    obstacle_radius: [obstacle], m.

    Errors: ValueError for shapes that do not fit each other, numbers that are not finite, or no prey.
    """

    prey_position: np.ndarray
    prey_velocity: np.ndarray
    predator_position: np.ndarray
    predator_velocity: np.ndarray
    obstacle_position: np.ndarray
    obstacle_radius: np.ndarray

    def __post_init__(self) -> None:
        for name in ("prey_position", "prey_velocity", "predator_position", "predator_velocity", "obstacle_position"):
            array = np.asarray(getattr(self, name), np.float64)
            object.__setattr__(self, name, array.reshape(-1, self.dim) if array.size == 0 else array)
        object.__setattr__(self, "obstacle_radius", np.asarray(self.obstacle_radius, np.float64))
        for name, array in vars(self).items():
            if not np.isfinite(array).all() or np.abs(array).max(initial=0) > LIMIT:
                raise ValueError(f"start: {name} holds a number that is not finite, or beyond {LIMIT:g}")
            if name != "obstacle_radius" and (array.ndim != 2 or array.shape[1] != self.dim):
                raise ValueError(f"start: {name} has shape {array.shape}; use [agent, {self.dim}]")
        for kind in ("prey", "predator"):
            position, velocity = getattr(self, f"{kind}_position"), getattr(self, f"{kind}_velocity")
            if position.shape != velocity.shape:
                raise ValueError(f"start: {kind}_position has shape {position.shape} but {kind}_velocity {velocity.shape}")
        if len(self.prey_position) == 0:
            raise ValueError("start: prey_position is empty; a trial needs 1 prey or more")
        if (self.obstacle_radius < 0).any():
            raise ValueError("start: obstacle_radius holds a negative number; use 0 or more")
        if self.obstacle_radius.shape != (len(self.obstacle_position),):
            raise ValueError(f"start: obstacle_radius has shape {self.obstacle_radius.shape}; use one radius an obstacle")

    def applied(self, scenario: Scenario) -> Scenario:
        """Give the scenario with the counts of this start. Errors: ValueError for other dimensions; ScenarioError."""
        if self.dim != scenario.world.dim:
            raise ValueError(f"start: positions have {self.dim} numbers, world.size has {scenario.world.dim}; use as many")
        counts = (len(self.prey_position), len(self.predator_position), len(self.obstacle_radius))
        return scenario.replaced(dict(zip(("prey.count", "predators.count", "obstacles.count"), counts, strict=True)))

    @property
    def dim(self) -> int:
        """Count the dimensions."""
        return 3 if np.shape(self.prey_position)[1:] == (3,) else 2
