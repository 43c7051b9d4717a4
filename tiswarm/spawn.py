"""Start states: drawn from a scenario, a seed and a trial number, or explicit ones."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import taichi as ti

from tiswarm import rng
from tiswarm.layout import (
    AGENT_ROWS,
    ALIVE,
    FATE,
    OBSTACLE_RADIUS,
    OBSTACLE_ROWS,
    OBSTACLE_X,
    OBSTACLE_Y,
    SEEN,
    STAYS,
    TRIAL,
    VX,
    VY,
    Layout,
    X,
    Y,
)
from tiswarm.scenario import LIMIT

FAR = 1e9
"""Where lanes with fewer obstacles than others keep the rest: out of everyone's reach [m]."""


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
            object.__setattr__(self, name, array.reshape(-1, 2) if array.size == 0 else array)
        object.__setattr__(self, "obstacle_radius", np.asarray(self.obstacle_radius, np.float64))
        for name, array in vars(self).items():
            if not np.isfinite(array).all() or np.abs(array).max(initial=0) > LIMIT:
                raise ValueError(f"start: {name} holds a number that is not finite, or beyond {LIMIT:g}")
            if name != "obstacle_radius" and (array.ndim != 2 or array.shape[1] != 2):
                raise ValueError(f"start: {name} has shape {array.shape}; use [agent, 2]")
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


def build(layout: Layout, types: SimpleNamespace) -> SimpleNamespace:
    """Build the funcs that draw a trial's start into fresh lanes, in lanes themselves."""
    lanes, integers = types.lanes, types.integer_lanes
    uniform = rng.build(types).uniform
    at = layout.at
    columns_count = len(layout.paths)

    def draws_agents(kind: str, purpose: int):
        columns, rows = getattr(at, kind), layout.agent_rows[kind]
        region, velocity = columns.region, columns.velocity

        @ti.func
        def spawn(agents: ti.template(), count, numbers: ti.template(), b, trial, fresh, key_low, key_high):
            n = b * columns_count
            for i in range(count):
                at_agent = (b * count + i) * rows
                a, c, e, f = uniform(key_low, key_high, trial, purpose, i, integers(ti.u32(0)))
                x0, y0, u0, w0 = (
                    numbers[n + region[0]],
                    numbers[n + region[1]],
                    numbers[n + velocity[0]],
                    numbers[n + velocity[1]],
                )
                x = x0 + a * (numbers[n + region[2]] - x0)
                y = y0 + c * (numbers[n + region[3]] - y0)
                vx = u0 + e * (numbers[n + velocity[2]] - u0)
                vy = w0 + f * (numbers[n + velocity[3]] - w0)
                exists = ti.select(numbers[n + columns.count] > ti.cast(i, types.real) + 0.5, 1.0, 0.0)
                agents[at_agent + X] = ti.select(fresh, x, agents[at_agent + X])
                agents[at_agent + Y] = ti.select(fresh, y, agents[at_agent + Y])
                agents[at_agent + VX] = ti.select(fresh, vx, agents[at_agent + VX])
                agents[at_agent + VY] = ti.select(fresh, vy, agents[at_agent + VY])
                agents[at_agent + ALIVE] = ti.select(fresh, exists, agents[at_agent + ALIVE])
                agents[at_agent + FATE] = ti.select(fresh, lanes(float(STAYS)), agents[at_agent + FATE])
                agents[at_agent + SEEN] = ti.select(fresh, lanes(0.0), agents[at_agent + SEEN])
                for row in range(AGENT_ROWS, rows):  # the strategies' memory
                    agents[at_agent + row] = ti.select(fresh, lanes(0.0), agents[at_agent + row])

        return spawn

    region, radius = at.obstacles.region, at.obstacles.radius
    spawn_prey = draws_agents("prey", rng.PREY)
    spawn_predators = draws_agents("predators", rng.PREDATORS)

    @ti.func
    def spawn_obstacles(obstacles: ti.template(), count, numbers: ti.template(), b, trial, fresh, key_low, key_high):
        n = b * columns_count
        for i in range(count):
            at_obstacle = (b * count + i) * OBSTACLE_ROWS
            a, c, e, _ = uniform(key_low, key_high, trial, rng.OBSTACLES, i, integers(ti.u32(0)))
            x0, y0, r0 = numbers[n + region[0]], numbers[n + region[1]], numbers[n + radius[0]]
            exists = numbers[n + at.obstacles.count] > ti.cast(i, types.real) + 0.5
            x = ti.select(exists, x0 + a * (numbers[n + region[2]] - x0), FAR)
            y = ti.select(exists, y0 + c * (numbers[n + region[3]] - y0), FAR)
            size = ti.select(exists, r0 + e * (numbers[n + radius[1]] - r0), 0.0)
            obstacles[at_obstacle + OBSTACLE_X] = ti.select(fresh, x, obstacles[at_obstacle + OBSTACLE_X])
            obstacles[at_obstacle + OBSTACLE_Y] = ti.select(fresh, y, obstacles[at_obstacle + OBSTACLE_Y])
            obstacles[at_obstacle + OBSTACLE_RADIUS] = ti.select(fresh, size, obstacles[at_obstacle + OBSTACLE_RADIUS])

    @ti.func
    def spawn(
        prey: ti.template(),
        predators: ti.template(),
        obstacles: ti.template(),
        counts,
        numbers: ti.template(),
        integer: ti.template(),
        b,
        fresh,
        key_low,
        key_high,
    ):
        """Draw prey, predators and obstacles of the lanes that are fresh (a mask)."""
        trial = integer[b, TRIAL]
        spawn_prey(prey, counts[0], numbers, b, trial, fresh, key_low, key_high)
        if ti.static(layout.structure.hunted):
            spawn_predators(predators, counts[1], numbers, b, trial, fresh, key_low, key_high)
        spawn_obstacles(obstacles, counts[2], numbers, b, trial, fresh, key_low, key_high)

    return SimpleNamespace(spawn=spawn, uniform=uniform)
