"""Observations: what an agent that obeys is shown, as numbers of about one, many trials at once; what is absent is zero."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import taichi as ti

from tiswarm.engine.trials.session import Kind, Session
from tiswarm.environments import nearest
from tiswarm.environments.nearest import FAR, keep_nearest, put
from tiswarm.environments.shown import NEAREST, Shown
from tiswarm.simd import launch, runtime
from tiswarm.simd.lanes import bounded, larger, row_of
from tiswarm.simd.runtime import LANES, TASK, Func, Types
from tiswarm.space import box, box_lanes

KINDS: tuple[Kind, Kind] = ("prey", "predators")


class Observer:
    """Fills an array with what agents of a kind are shown."""

    def __init__(self, session: Session, kind: Kind, names: Sequence[str], first: int = 0) -> None:
        """Say for whom; first: where agents of the kind begin in what is filled. Errors: ValueError for an unknown name."""
        scenario, layout = session.scenario, session.blocks.layout
        self.shown = Shown.of(names, scenario.world.dim)
        self._session, self._first = session, first
        wraps = box.wraps(scenario.world.boundary) and scenario.world.wrap_sight
        self._build = lambda: runtime.kept(
            ("observe", kind, self.shown, layout.structure),
            lambda: _build(_About(self.shown, kind, layout, runtime.types(), wraps)),
        )
        agents, size = getattr(scenario, kind), scenario.world.size
        aim = scenario.target.position if scenario.target.present else size
        units = [agents.perception, 1 / max(agents.perception, 1e-6), 1 / agents.max_speed, float(scenario.target.present)]
        self._numbers = np.array([*size, *aim, *units], session.blocks.dtype)

    def fill(self, out: np.ndarray, where: np.ndarray) -> None:
        """Write what agents of the trials at some places, [n], are shown, into [place + 1, agent, number] of float32.

        What other trials of their blocks are shown goes to the place behind all.
        """
        session, blocks = self._session, self._session.blocks
        place = np.full(blocks.blocks * LANES, session.places, np.int32)
        place[session.slots[where]] = where
        counts = [session.count("prey"), session.count("predators"), session.scenario.obstacles.count]
        arrays = (blocks.prey, blocks.predators, blocks.obstacles, place, self._numbers, out)
        launch.run(self._build(), *arrays, blocks.blocks, session.places, self._first, *counts, precision=blocks.precision)


@dataclass(frozen=True)
class _About:
    """Whom and what a kernel shows, and to whom."""

    shown: Shown
    kind: Kind
    layout: Any
    types: Types
    wraps: bool

    @property
    def averaged(self) -> bool:
        """Whether means are shown."""
        return self.shown.place("means")[0] >= 0

    @property
    def units(self) -> tuple[int, int, int, int]:
        """Where its reach, 1 / reach, 1 / greatest speed, and 1 or 0 for a target stand in a kernel's numbers."""
        reach = 2 * len(self.layout.axes)
        return reach, reach + 1, reach + 2, reach + 3


@ti.func
def there(agents: ti.template(), a, places: ti.template()):
    """Give an agent's place or velocity, a list."""
    return [agents[a + row] for row in ti.static(places)]


@ti.func
def square(way: ti.template()):
    """Give the square of a way's length."""
    total = way[0] * way[0]
    for k in ti.static(range(1, len(way))):
        total = total + way[k] * way[k]
    return total


def _way_to(about: _About) -> Func:
    wraps, dim = about.wraps, len(about.layout.axes)

    @ti.func
    def way_to(here: ti.template(), other: ti.template(), numbers: ti.template()):
        way = [q - p for p, q in ti.static(zip(here, other, strict=True))]
        if ti.static(wraps):
            for k in ti.static(range(dim)):
                way[k] = box_lanes.displacement(way[k], numbers[k])
        return way

    return way_to


def _others(about: _About, which: int) -> Func:
    """Build what shows prey (0) or predators (1)."""
    shown, layout, lanes = about.shown, about.layout, about.types.lanes
    rows, dim, averaged = layout.rows, len(layout.axes), about.averaged
    way_to, show_kept = _way_to(about), nearest.build_show(about.types)
    height = layout.agent_rows[KINDS[which]]
    at, mine = shown.place(NEAREST[which]), KINDS[which] == about.kind
    reach, per_metre, per_speed, _ = about.units
    most, means = at[1], shown.place("means")[0] + which * (2 * dim + 1)

    @ti.func
    def show_others(
        out: ti.template(), places: ti.template(), i, here: ti.template(), speed: ti.template(), others: ti.template(), b,
        me, count, numbers: ti.template(),
    ):  # fmt: skip
        """Show agents of a kind within reach: the nearest, way and difference of velocity of each, and their means."""
        kept = [lanes(FAR) for _ in ti.static(range(most * (2 * dim + 1)))]
        sums = [lanes(0.0) for _ in ti.static(range(2 * dim + 1))]
        for j in range(count):
            a = row_of(b * count + j, height)
            way = way_to(here, there(others, a, rows.place), numbers)
            motion = there(others, a, rows.motion)
            drift = [q - p for p, q in ti.static(zip(speed, motion, strict=True))]
            away = square(way)
            near = ti.select((away <= numbers[reach] * numbers[reach]) & (others[a + rows.alive] > 0.5), 1.0, lanes(0.0))
            if ti.static(mine):  # noqa: SIM102 - one branch at compile time, one at run time
                if j == me:
                    near = lanes(0.0)
            if ti.static(averaged):
                for k in ti.static(range(dim)):
                    sums[k] += near * way[k]
                    sums[dim + k] += near * drift[k]
                sums[2 * dim] += near
            if ti.static(most > 0):
                keep_nearest(kept, ti.select(near > 0.5, away, FAR), ti.static(way + drift), most)
        units = [numbers[per_metre if c < dim else per_speed] for c in ti.static(range(2 * dim))]
        if ti.static(most > 0):
            show_kept(out, places, i, kept, at, 2 * dim, units)
        if ti.static(averaged):
            share = 1.0 / larger(sums[2 * dim], 1.0)
            for c in ti.static(range(2 * dim)):
                put(out, places, i, means + c, units[c] * (share * sums[c]))
            put(out, places, i, means + 2 * dim, sums[2 * dim] / (sums[2 * dim] + 5.0))

    return show_others


def _obstacles(about: _About) -> Func:
    shown, layout, lanes, dim = about.shown, about.layout, about.types.lanes, len(about.layout.axes)
    way_to, show_kept = _way_to(about), nearest.build_show(about.types)
    reach, per_metre, _, _ = about.units
    hindered, axes = shown.place(NEAREST[2]), list(range(dim))

    @ti.func
    def show_obstacles(
        out: ti.template(),
        places: ti.template(),
        i,
        here: ti.template(),
        obstacles: ti.template(),
        b,
        count,
        numbers: ti.template(),
    ):
        """Show the nearest obstacles whose edges are within reach: way to the edge (from within, out of it), and radius."""
        kept = [lanes(FAR) for _ in ti.static(range(hindered[1] * (dim + 2)))]
        for j in range(count):
            a = row_of(b * count + j, layout.obstacle_rows)
            way = way_to(here, there(obstacles, a, axes), numbers)
            distance = ti.sqrt(square(way))
            edge = distance - obstacles[a + dim]
            share = edge / larger(distance, 1e-9)
            found = [share * way[k] for k in ti.static(range(dim))]
            radius = [1.0 * obstacles[a + dim]]
            keep_nearest(kept, ti.select(edge <= numbers[reach], edge, FAR), ti.static(found + radius), hindered[1])
        units = [numbers[per_metre] for _ in ti.static(range(dim + 1))]
        show_kept(out, places, i, kept, hindered, dim + 1, units)

    return show_obstacles


def _own(about: _About) -> Func:
    shown, dim, way_to = about.shown, len(about.layout.axes), _way_to(about)
    reach, _, per_speed, aimed = about.units
    alone, aim = shown.place("own")[0], shown.place("target")[0]

    @ti.func
    def show_own(
        out: ti.template(), places: ti.template(), i, here: ti.template(), speed: ti.template(), numbers: ti.template()
    ):
        """Show an agent itself, and the way to the target."""
        if ti.static(alone >= 0):
            for k in ti.static(range(dim)):
                put(out, places, i, alone + k, numbers[per_speed] * speed[k])
                put(out, places, i, alone + dim + k, 2.0 * here[k] / numbers[k] - 1.0)
        if ti.static(aim >= 0):
            way = way_to(here, [numbers[dim + k] for k in ti.static(range(dim))], numbers)
            share = numbers[aimed] / (ti.sqrt(square(way)) + (numbers[reach] + 1e-9))
            for k in ti.static(range(dim)):
                put(out, places, i, aim + k, share * way[k])

    return show_own


def _build(about: _About) -> Any:
    shown, types, rows, averaged = about.shown, about.types, about.layout.rows, about.averaged
    hunting, height = about.kind == "predators", about.layout.agent_rows[about.kind]
    show_own, show_obstacles = _own(about), _obstacles(about)
    show_prey, show_predators = _others(about, 0), _others(about, 1)
    array = types.lane_array(1)  # [block * agent * row]

    @ti.func
    def hide_gone(out: ti.template(), places: ti.template(), i, alive):
        """Show those who are gone nothing."""
        for lane in ti.static(range(LANES)):
            if alive[lane] < 0.5:
                for c in range(shown.width):
                    out[places[lane], i, c] = 0.0

    @ti.kernel
    def observe(
        prey: array,
        predators: array,
        obstacles: array,
        place: ti.types.ndarray(dtype=ti.i32, ndim=1),  # [block * lane], where a trial is written, `nowhere` for none
        numbers: ti.types.ndarray(dtype=types.real, ndim=1),
        out: ti.types.ndarray(dtype=ti.f32, ndim=3),  # [place + 1, agent, number]
        blocks: ti.i32,
        nowhere: ti.i32,
        first: ti.i32,  # of this kind's agents in `out`
        prey_count: ti.i32,
        predator_count: ti.i32,
        obstacle_count: ti.i32,
    ):
        for index in range(blocks * TASK):
            b = bounded(index // TASK)
            asked = 0
            if index % TASK == 0:
                for lane in range(LANES):
                    asked += 1 if place[b * LANES + lane] < nowhere else 0
            if asked > 0:
                places = [place[b * LANES + lane] for lane in ti.static(range(LANES))]
                agents = ti.static(predators if hunting else prey)
                count = predator_count if ti.static(hunting) else prey_count
                for j in range(count):
                    a, i = row_of(b * count + j, height), first + j
                    here, speed = there(agents, a, rows.place), there(agents, a, rows.motion)
                    show_own(out, places, i, here, speed, numbers)
                    if ti.static(averaged or shown.place(NEAREST[0])[1] > 0):
                        show_prey(out, places, i, here, speed, prey, b, j, prey_count, numbers)
                    if ti.static(averaged or shown.place(NEAREST[1])[1] > 0):
                        show_predators(out, places, i, here, speed, predators, b, j, predator_count, numbers)
                    if ti.static(shown.place(NEAREST[2])[1] > 0):
                        show_obstacles(out, places, i, here, obstacles, b, obstacle_count, numbers)
                    hide_gone(out, places, i, agents[a + rows.alive])

    return observe
