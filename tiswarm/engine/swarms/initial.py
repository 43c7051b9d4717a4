"""Initial: start states of large swarms as arrays, drawn by the funcs of spawn.py, so that they are those of kernel.py."""

from typing import Any

import numpy as np
import taichi as ti

from tiswarm.dynamics import spawn
from tiswarm.dynamics.table import ParameterTable
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.start import Start
from tiswarm.simd import launch, philox, runtime
from tiswarm.simd.runtime import LANES, Types

States = dict[str, tuple[np.ndarray, np.ndarray]]
"""Positions and velocities of prey, predators and obstacles: [trial, agent, dim] each, m and m/s; NaN where nobody is.

An obstacle's velocity holds its radius first."""


def drawn(scenario: Scenario, layout: ParameterTable, seed: int, first: int, trials: int) -> States:
    """Draw the starts of `trials` trials from number `first` on."""
    types, dim = runtime.types(), scenario.world.dim
    numbers = numbers_of(scenario, layout)
    states = {}
    for kind in ("prey", "predators", "obstacles"):
        count = getattr(scenario, kind).count
        blocks = -(-count * trials // LANES)
        out = runtime.aligned((max(blocks, 1) * 2 * dim, LANES), types.dtype)
        if blocks:
            launch.run(_kernel(layout, kind), out, numbers, blocks, count, first, *philox.seed_words(seed))
        rows = out[: blocks * 2 * dim].reshape(blocks, 2 * dim, LANES).transpose(0, 2, 1).reshape(-1, 2 * dim)
        table = rows[: count * trials].reshape(trials, count, 2 * dim).astype(np.float64)
        if kind == "obstacles":
            table[table[..., dim + 1] > 0.5] = np.nan
        states[kind] = table[..., :dim], table[..., dim:]
    return states


def numbers_of(scenario: Scenario, layout: ParameterTable) -> np.ndarray:
    """Give a scenario's numbers, the same in all lanes: [column, lane]."""
    row = layout.table([scenario])[0].astype(runtime.types().dtype)
    numbers = runtime.aligned((len(row), LANES), row.dtype)
    numbers[:] = row[:, None]
    return numbers


def given(start: Start, trials: int) -> States:
    """Give every trial the same explicit start."""
    radius = np.zeros_like(start.obstacle_position)
    radius[:, 0] = start.obstacle_radius
    pairs = {
        "prey": (start.prey_position, start.prey_velocity),
        "predators": (start.predator_position, start.predator_velocity),
        "obstacles": (start.obstacle_position, radius),
    }
    return {kind: (np.stack([place] * trials), np.stack([rate] * trials)) for kind, (place, rate) in pairs.items()}


def _kernel(layout: ParameterTable, kind: str) -> Any:
    """Give the kernel that draws agents of a kind, built once per runtime."""
    return runtime.kept(("draw", layout.structure, kind), lambda: _build(layout, runtime.types(), kind))


def _build(layout: ParameterTable, types: Types, kind: str) -> Any:
    draw_one = getattr(spawn.build(layout, types), kind)
    flat, integers = types.lane_array(1), types.integer_lanes
    wide = 2 * len(layout.axes)
    told = wide if kind != "obstacles" else len(layout.axes) + 2

    @ti.kernel
    def draw(out: flat, numbers: flat, blocks: ti.i32, count: ti.i32, first: ti.i32, key_low: ti.u32, key_high: ti.u32):
        """Draw agents, as many a block as it has lanes, trial after trial."""
        for block in range(blocks):
            agents = [block * LANES + lane for lane in ti.static(range(LANES))]
            trial = integers([ti.cast(first + agent // count, ti.u32) for agent in ti.static(agents)])
            number = integers([ti.cast(agent % count, ti.u32) for agent in ti.static(agents)])
            state = draw_one(number, numbers, 0, trial, key_low, key_high)
            for k in ti.static(range(told)):
                out[block * wide + k] = state[k]

    return draw
