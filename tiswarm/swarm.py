"""Swarm: large swarms, one or many at once; eight agents that follow each other in cell order are the lanes of one thread."""

from operator import index
from types import SimpleNamespace
from typing import Any

import numpy as np
import taichi as ti

from tiswarm import rng, runtime
from tiswarm.explain import ScenarioError
from tiswarm.flocking import flock, see_mate
from tiswarm.grid import CELLS, HEAD, SLOTS, Grid, Space
from tiswarm.lanes import capped, coordinates, larger, motion, rates, smaller
from tiswarm.layout import Layout, Structure
from tiswarm.rng import philox
from tiswarm.runtime import LANES
from tiswarm.scenario import Scenario

SMALL = 2_048
"""Up to so many agents one thread is done before a second one has woken."""

_kernels: dict[tuple[Any, ...], SimpleNamespace] = {}


class Swarm:
    """Trials of a scenario with any number of prey, tick by tick; positions are read when they are asked for.

    ticks: moves made so far.
    """

    def __init__(
        self,
        scenario: Scenario,
        seed: int = 0,
        trials: int = 1,
        start: tuple[np.ndarray, np.ndarray] | None = None,
    ) -> None:
        """Draw the starts of trials 0, 1, ..., the same as in a batch, or take explicit positions and velocities.

        start: [trial, agent, dim] each, m and m/s; trials and agents are then counted there.

        Errors: ScenarioError for what needs the trials of few agents (`simulate`); ValueError for a start that is not finite.
        """
        _check(scenario)
        self.scenario, self.seed, self.ticks = scenario, index(seed), 0
        if start is None:
            start = _drawn(scenario, self.seed, index(trials))
        position, velocity = (np.asarray(each, np.float64) for each in start)
        if position.ndim != 3 or position.shape != velocity.shape or position.shape[2] != scenario.world.dim:
            raise ValueError(f"start: positions {position.shape} and velocities {velocity.shape} need [trial, agent, dim]")
        trials, count, _ = position.shape
        sees_across = scenario.world.boundary == "periodic" and scenario.world.wrap_sight
        edge: Any = "periodic" if sees_across else "open" if scenario.world.boundary == "open" else "walls"
        self.grid = Grid(Space(tuple(scenario.world.size), edge), max(scenario.prey.perception, 1e-6), count, trials)
        layout = Layout(Structure.of([scenario], 0), runtime.types().lanes)
        self._numbers = layout.table([scenario])[0].astype(runtime.types().dtype)
        self._kernels = _built(layout, self.grid)
        self.grid.place(position, velocity)

    def step(self, ticks: int = 1) -> None:
        """Run some ticks; small swarms run them in one go, which costs much less than one by one."""
        at = self.grid
        arrays = (at.agents, at.whole, at.reals, self._numbers, at.total // LANES)
        if at.total <= SMALL:
            self._kernels.run(*arrays, ticks)
        else:
            for _ in range(ticks):
                self._kernels.move(*arrays)
                at.sort()
        self.ticks += ticks

    def position(self, kind: str = "prey") -> np.ndarray:
        """Give where the agents are: [trial, agent, dim], m, NaN for those who are gone."""
        return self._state(kind, 0)

    def velocity(self, kind: str = "prey") -> np.ndarray:
        """Give their velocity: [trial, agent, dim], m/s, NaN for those who are gone."""
        return self._state(kind, self.scenario.world.dim)

    def _state(self, kind: str, first: int) -> np.ndarray:
        dim = self.scenario.world.dim
        if kind == "predators":
            return np.zeros((self.grid.trials, 0, dim))
        return self.grid.gathered(slice(first, first + dim))


def _check(scenario: Scenario) -> None:
    """Refuse what large swarms cannot do yet."""
    prey, world = scenario.prey, scenario.world
    wanted = {
        "prey.strategy": (prey.strategy, "baseline"),
        "predators.count": (scenario.predators.count, 0),
        "obstacles.count": (scenario.obstacles.count, 0),
        "prey.spawn.shape": (prey.spawn.shape, "box"),
        "prey.drive": (prey.drive, "point"),
        "prey.min_speed": (prey.min_speed, 0.0),
        "world.scheme": (world.scheme, "euler"),
        "target.present": (scenario.target.present, False),
    }
    if world.contact == "bounce":
        wanted["world.contact"] = (world.contact, "none")
    for path, (value, possible) in wanted.items():
        if value != possible:
            raise ScenarioError(f"{path}: a large swarm cannot have {value!r} yet; use {possible!r}")


def _built(layout: Layout, of: Grid) -> SimpleNamespace:
    """Give the kernel for a structure and a kind of grid, built once per runtime."""
    key = (runtime.generation(), layout.structure, id(of.funcs))
    if key not in _kernels:
        _kernels[key] = _build(layout, of.funcs, runtime.types())
    return _kernels[key]


def _build(layout: Layout, near: SimpleNamespace, types: SimpleNamespace) -> SimpleNamespace:
    lanes, real = types.lanes, types.real
    at, frame = layout.at, layout.structure.frame
    dim = frame.dim
    axes, moves = "xyz"[:dim], [f"v{axis}" for axis in "xyz"[:dim]]
    Me = ti.types.struct(**dict.fromkeys([*axes, *moves], lanes))  # noqa: N806 - a type
    Mate = ti.types.struct(**dict.fromkeys(moves, real))  # noqa: N806
    pushes = [f"push_{axis}" for axis in axes]
    Mates = ti.types.struct(**dict.fromkeys(["n", *axes, *moves, *pushes, "perception2", "spacing2"], lanes))  # noqa: N806

    @ti.func
    def meet(mates: ti.template(), here, agents: ti.template(), j, reals: ti.template()):
        away = [near.across(here[k] - agents[j][k], k, reals) for k in ti.static(range(dim))]
        mate = Mate(*[agents[j][dim + k] for k in ti.static(range(dim))])
        see_mate(mates, mate, away, 1.0, mates.perception2, mates.spacing2)

    around = near.walks(meet).around

    @ti.func
    def flocked(
        me: ti.template(), agents: ti.template(), whole: ti.template(), reals: ti.template(), numbers: ti.template(), block, end
    ):
        """Give what the mates in sight add to the velocity."""
        perception = numbers[at.prey.perception]
        spacing = smaller(numbers[at.prey.spacing], perception)
        mates = Mates(*[lanes(0.0) for _ in ti.static(range(1 + 3 * dim))], perception * perception, spacing * spacing)
        around(mates, ti.static(coordinates(me)), agents, whole, reals, block * LANES // whole[SLOTS], block, end)
        mates.n += -1.0  # everybody meets itself, at no distance
        for k in ti.static(range(dim)):
            motion(mates)[k] += -1.0 * motion(me)[k]
        return flock(me, mates, numbers[at.prey.cohesion], numbers[at.prey.separation], numbers[at.prey.alignment])

    @ti.func
    def inside(to: ti.template(), rate: ti.template(), numbers: ti.template()):
        """Keep a place inside the world's edges."""
        for k in ti.static(range(dim)):
            size = numbers[at.size[k]]
            if ti.static(frame.boundary == "periodic"):
                to[k] = to[k] - size * ti.floor(to[k] / size)
                to[k] = ti.select(to[k] >= size, 0.0, to[k])  # rounding may lift a tiny negative number to the size itself
            if ti.static(frame.boundary == "walls"):
                low = smaller(numbers[at.prey.radius], 0.5 * size)
                within = larger(smaller(to[k], size - low), low)
                rate[k] = ti.select((to[k] < within) & (rate[k] < 0.0) | (to[k] > within) & (rate[k] > 0.0), 0.0, rate[k])
                to[k] = within

    @ti.func
    def move_block(agents: ti.template(), whole: ti.template(), reals: ti.template(), numbers: ti.template(), block, total):
        """V += flocking; cap; p += v dt. Reads the agents in cell order; writes the moved ones behind them."""
        trial = block * LANES // whole[SLOTS]
        end = ti.min((block + 1) * LANES, near.alive_end(whole, trial))
        first = block * LANES
        state = [lanes([agents[first + lane][k] for lane in ti.static(range(LANES))]) for k in ti.static(range(2 * dim))]
        me = Me(*ti.static(state))
        pull = flocked(me, agents, whole, reals, numbers, block, end)
        course = [rate + part for rate, part in ti.static(zip(rates(me), pull, strict=True))]
        if ti.static(frame.boundary == "walls"):
            for k in ti.static(range(dim)):
                margin = numbers[at.margin]
                course[k] += ti.select(state[k] < margin, numbers[at.turn_factor], 0.0)
                course[k] += ti.select(state[k] > numbers[at.size[k]] - margin, -1.0 * numbers[at.turn_factor], 0.0)
        rate = capped(course, numbers[at.prey.max_speed])
        to = [state[k] + numbers[at.dt] * rate[k] for k in ti.static(range(dim))]
        inside(to, rate, numbers)
        for lane in ti.static(range(LANES)):
            slot = block * LANES + lane
            there = [to[k][lane] for k in ti.static(range(dim))]
            then = [rate[k][lane] for k in ti.static(range(dim))]
            place = whole[CELLS] - 1
            if slot < end:
                place = near.place_of(there, whole, reals)
            whole[HEAD + slot] = trial * whole[CELLS] + place
            whole[HEAD + 2 * total + slot] = whole[HEAD + total + slot]
            agents[total + slot] = near.record(there + then + [real(0.0)] * (near.width - 2 * dim))

    number_array = ti.types.ndarray(dtype=real, ndim=1)

    @ti.kernel
    def move(agents: near.agent_array, whole: near.whole_array, reals: near.real_array, numbers: number_array, blocks: ti.i32):
        for block in range(blocks):
            move_block(agents, whole, reals, numbers, block, blocks * LANES)

    @ti.kernel
    def run(
        agents: near.agent_array,
        whole: near.whole_array,
        reals: near.real_array,
        numbers: number_array,
        blocks: ti.i32,
        ticks: ti.i32,
    ):
        """Run many ticks on one thread."""
        ti.loop_config(serialize=True)
        for _ in range(ticks):
            for block in range(blocks):
                move_block(agents, whole, reals, numbers, block, blocks * LANES)
            near.arrange(agents, whole)

    return SimpleNamespace(move=move, run=run)


def _drawn(scenario: Scenario, seed: int, trials: int) -> tuple[np.ndarray, np.ndarray]:
    """Draw the starts of trials 0, 1, ...: positions and velocities, [trial, agent, dim]."""
    spawn, dim, count = scenario.prey.spawn, scenario.world.dim, scenario.prey.count
    shares = np.zeros((trials * count, 8), np.uint32)
    _draw_kernel()(shares, count, *rng.seed_words(seed))
    share = (shares >> 8).reshape(trials, count, 8) / (1 << 24)
    places, motions = ([0, 1], [2, 3]) if dim == 2 else ([0, 1, 2], [4, 5, 6])
    return tuple(
        np.asarray(box.low) + share[..., columns] * (np.asarray(box.high) - np.asarray(box.low))
        for box, columns in ((spawn.region, places), (spawn.velocity, motions))
    )


def _draw_kernel() -> Any:
    key = (runtime.generation(), "draw")
    if key not in _kernels:

        @ti.kernel
        def draw(shares: ti.types.ndarray(dtype=ti.u32, ndim=2), count: ti.i32, key_low: ti.u32, key_high: ti.u32):
            """Draw eight words for each agent, two attempts of spawn.py's."""
            for agent in range(shares.shape[0]):
                for attempt in ti.static(range(2)):
                    a, b, c, d = philox(
                        ti.cast(agent % count, ti.u32),
                        ti.cast(agent // count, ti.u32),
                        ti.u32(rng.PREY),
                        ti.u32(attempt),
                        key_low,
                        key_high,
                    )
                    for k in ti.static(range(4)):
                        shares[agent, 4 * attempt + k] = ti.static([a, b, c, d])[k]

        _kernels[key] = draw
    return _kernels[key]
