"""Measured agents: kernels that look at the prey of large swarms one by one, and change nothing.

Sums over agents are sums over fixed pieces of the slots, which the host adds up in their order; visits are whole numbers:
no value depends on threads. The formulas are those of measures/, for both engines.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.engine.swarms.transfer import LOOP, share_of
from tiswarm.measures import formulas, traps
from tiswarm.simd.lanes import Bundle, larger
from tiswarm.simd.runtime import EIGHT, LANES, TASK, Func, Types
from tiswarm.space.cell_list import CellFuncs
from tiswarm.space.cells import HEAD, SLOTS, TRIALS

PIECE = 128
"""Slots whose sums are added up first: the order of summation does not depend on threads or lanes."""


@dataclass(frozen=True)
class Pieces:
    """Kernels that sum up over agents, and what others are made of."""

    motion: Func  # a column for each of formulas.add_motion's sums
    spin: Func  # three columns
    pieces: Callable[..., Func]  # how many columns, a func that adds a block to them, and columns that are maxima -> kernel
    body_of: Func  # a block's agents


def build_pieces(layout: ParameterTable, types: Types, near: CellFuncs) -> Pieces:
    """Build the kernels.

    near: the funcs of the prey's grid. Kernels take its arrays, numbers, centres ([trial * dim], m) and sums: [piece * column].
    """
    lanes, eight, real = types.lanes, types.eight, types.real
    dim = len(layout.axes)
    names = [*"xyz"[:dim], *(f"v{axis}" for axis in "xyz"[:dim]), "alive"]
    Body = ti.types.struct(**dict.fromkeys(names, lanes))  # noqa: N806 - a type

    @ti.func
    def body_of(agents: ti.template(), block, end):
        """Give a block's agents; lanes from slot `end` on are not alive."""
        first = block * LANES
        state = [
            lanes([agents[ti.min(first + lane, end - 1)][k] for lane in ti.static(range(LANES))])
            for k in ti.static(range(2 * dim))
        ]
        alive = [ti.select(first + lane < end, real(1.0), real(0.0)) for lane in ti.static(range(LANES))]
        return Body(*state, lanes(alive))

    @ti.func
    def fold(own: ti.template(), told: ti.template(), greatest: ti.template()):
        """Add a block's lanes to sums in eights, eight slots after the other."""
        for part in ti.static(range(LANES // EIGHT)):
            for k in ti.static(range(len(own))):
                here = eight([told[k][part * EIGHT + lane] for lane in ti.static(range(EIGHT))])
                own[k] = larger(own[k], here) if ti.static(k in greatest) else own[k] + here

    def pieces(columns: int, add: Callable[..., Any], greatest: tuple[int, ...] = ()):
        @ti.kernel
        def run(
            agents: near.agent_array, whole: ti.types.ndarray(dtype=ti.i32, ndim=1), reals: near.real_array,
            numbers: types.lane_array(1), centres: ti.types.ndarray(dtype=real, ndim=1), sums: types.eight_array,
        ):  # fmt: skip
            blocks = whole[SLOTS] // LANES
            piece_blocks = ti.static(PIECE // LANES)
            count = (blocks + piece_blocks - 1) // piece_blocks
            for index in range(count * whole[TRIALS] * TASK):
                if index % TASK == 0:
                    piece = index // TASK
                    trial = piece // count
                    first = trial * blocks + piece % count * piece_blocks
                    here = Bundle(agents=agents, whole=whole, reals=reals, numbers=numbers, centres=centres, trial=trial)
                    own = [eight(0.0) for _ in ti.static(range(columns))]
                    for block in range(first, ti.min(first + piece_blocks, (trial + 1) * blocks)):
                        end = ti.min((block + 1) * LANES, near.alive_end(whole, trial))
                        if end > block * LANES:
                            told = [lanes(0.0) for _ in ti.static(range(columns))]
                            add(told, here, body_of(agents, block, end), block, end)
                            fold(own, told, greatest)
                    for k in ti.static(range(columns)):
                        sums[piece * columns + k] = own[k]

        return run

    @ti.func
    def middle(here: ti.template()):
        return [lanes(here.centres[here.trial * dim + k]) for k in ti.static(range(dim))]

    @ti.func
    def lengths(numbers: ti.template()):
        """Give the sides of a world that repeats itself, an empty list of another."""
        return [numbers[column] for column in ti.static(layout.at.size if near.periodic else [])]

    @ti.func
    def add_motion(own: ti.template(), here: ti.template(), body, block, end):  # noqa: ARG001 - as its sisters
        formulas.add_motion(own, body, middle(here), lengths(here.numbers))

    @ti.func
    def add_spin(own: ti.template(), here: ti.template(), body, block, end):  # noqa: ARG001 - as its sisters
        formulas.add_spin(own, body, middle(here), lengths(here.numbers))

    return Pieces(motion=pieces(formulas.AHEAD + 2 * dim, add_motion), spin=pieces(3, add_spin), pieces=pieces, body_of=body_of)


def build_sweep(layout: ParameterTable, types: Types, near: CellFuncs):
    """Build the kernel that counts visits of cells.

    ground: [trial * cell], in how many states a tool lay on it how often, -1 where there is none; clean: [trial], cells swept.
    """
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)
    at = layout.at
    across, down = layout.structure.frame.cells

    @ti.func
    def visit(here: ti.template(), cell):
        if here.ground[here.trial * ti.static(across * down) + cell] >= 0:
            before = ti.atomic_add(here.ground[here.trial * ti.static(across * down) + cell], 1)
            if before == 0:
                ti.atomic_add(here.clean[here.trial], 1)

    @ti.kernel
    def sweep(
        agents: near.agent_array, whole: whole_array, numbers: types.lane_array(1), ground: whole_array, clean: whole_array
    ):
        for slot in range(whole[SLOTS] * whole[TRIALS]):
            trial = slot // whole[SLOTS]
            if slot < near.alive_end(whole, trial):
                here = Bundle(ground=ground, clean=clean, trial=trial)
                side, tool = numbers[at.cell][0], numbers[at.tool][0]
                period = [numbers[column][0] for column in ti.static(at.size if near.periodic else [])]
                formulas.visit_cells(agents[slot][0], agents[slot][1], side, tool, across, down, period, visit, here)

    return sweep


def build_watch(layout: ParameterTable, types: Types, see: Views, near: CellFuncs, body_of: Any):
    """Build the kernel that takes one state into all prey's windows. cold: [trial * agent * row], by number (trap_rows)."""
    lanes, real, rows = types.lanes, types.real, trap_rows(layout)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)
    deep, wide = layout.agent_rows["prey"], len(rows)
    pursue = traps.build(layout, types, see).pursue

    @ti.func
    def watch_block(
        agents: ti.template(), whole: ti.template(), numbers: ti.template(), scratch: ti.template(), a, cold: ti.template(),
        count, start, trial, block, end,
    ):  # fmt: skip
        """Take one state of a block's prey, which there are up to slot `end`, into their windows."""
        slots = [ti.min(block * LANES + lane, end - 1) for lane in ti.static(range(LANES))]
        total = whole[SLOTS] * whole[TRIALS]
        whom = [(trial * count + whole[HEAD + total + slot]) * wide for slot in ti.static(slots)]
        for k in ti.static(range(wide)):
            scratch[a + rows[k]] = lanes([cold[whom[lane] + k] for lane in ti.static(range(LANES))])
        body = body_of(agents, block, end)
        starts = lanes(ti.cast(start, real)) > 0.5
        pursue(scratch, a, body, numbers, 0, starts, body.alive > 0.5)
        for lane in ti.static(range(LANES)):
            if block * LANES + lane < end:
                for k in ti.static(range(wide)):
                    cold[whom[lane] + k] = scratch[a + rows[k]][lane]

    @ti.kernel
    def watch(
        agents: near.agent_array, whole: whole_array, numbers: types.lane_array(1), scratch: types.lane_array(1),
        cold: ti.types.ndarray(dtype=real, ndim=1), count: ti.i32, start: ti.i32,
    ):  # fmt: skip
        for index in range(LOOP):
            if index % TASK == 0:
                a = index // TASK * deep
                begin, past = share_of(index // TASK, whole[SLOTS] * whole[TRIALS] // LANES)
                for block in range(begin, past):
                    trial = block * LANES // whole[SLOTS]
                    end = ti.min((block + 1) * LANES, near.alive_end(whole, trial))
                    if end > block * LANES:
                        watch_block(agents, whole, numbers, scratch, a, cold, count, start, trial, block, end)

    return watch


def trap_rows(layout: ParameterTable) -> list[int]:
    """List the rows of a prey that traps.py keeps between states."""
    return [row for each in vars(layout.rows.trap).values() for row in (each if isinstance(each, list) else [each])]
