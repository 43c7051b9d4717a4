"""Transfer: bring a block's agents of a large swarm from their grid into the rows that a trial's funcs work on, and back.

What mates see lies in the grid's records, in cell order; all else lies in rows by number, which no sorting moves ("cold").
"""

from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.engine.swarms.near_cells import CellSearch
from tiswarm.simd.runtime import LANES, TASK, Func, Types
from tiswarm.space.cells import HEAD, SLOTS, TRIALS

CHUNKS = 32
"""Blocks of a swarm are dealt to threads in so many shares, each with scratch rows of its own."""


def kept_rows(layout: ParameterTable, kind: str) -> list[int]:
    """List the rows of an agent that a large swarm keeps from tick to tick beside place and motion: its cold columns."""
    rows = layout.rows
    kept = [rows.alive, rows.fate, rows.seen, rows.hit, *rows.travel] if layout.structure.mortal else []
    if layout.parts(kind, "avoidance", "field"):
        kept += rows.field
    if kind in layout.structure.frame.unicycles:
        kept += rows.heading
    return kept + list(range(rows.count, layout.filled_rows[kind]))


def scratch_rows(layout: ParameterTable) -> int:
    """Count the scratch rows of a chunk: enough for either kind, so that chunks at work on different kinds never meet.

    And as many again, which no chunk uses: what one core fetches ahead is not what another writes (batch.SPREAD).
    """
    return 2 * max(layout.agent_rows.values())


@dataclass(frozen=True)
class Transfer:
    """Funcs that bring agents from cells to lanes and back."""

    load: Func
    save_rows: Func  # write the cold rows of a block's agents back
    save_shown: Func  # write what agents show of their memory into their records
    saves: Func
    kept: list[int]  # the rows of an agent's cold columns, the first of those that there are
    number_in: Func  # give the number of the agent in a slot, from 0 within its trial


def build(layout: ParameterTable, types: Types, see: Views, senses: CellSearch, kind: str):
    """Build load, save_rows, save_shown, number_in, and saves (a grid's funcs -> save_moved) for agents of a kind.

    A crowd that is `wide` has so many cold columns, of which the layout knows the first ones, else just those.
    """
    lanes, real = types.lanes, types.real
    dim, rows = len(layout.axes), layout.rows
    kept = kept_rows(layout, kind)
    known = len(kept)
    moving = [*rows.place, *rows.motion]
    shown = list(layout.shown(kind).values())
    told_rows = moving + shown
    columns = getattr(layout.at, kind)

    def wide_of(crowd: Any) -> Any:
        return getattr(crowd, "wide", known)

    wide_of._is_taichi_function = False  # type: ignore[attr-defined]  # Python's, called while a kernel is built

    @ti.func
    def number_in(whole: ti.template(), slot):
        """Give the number of the agent in a slot, from 0 within its trial."""
        return whole[HEAD + whole[SLOTS] * whole[TRIALS] + slot]

    @ti.func
    def load(scratch: ti.template(), a, crowd: ti.template(), numbers: ti.template(), count, block, end):
        """Load a block's agents; give them, and their numbers as integer lanes. Lanes from `end` on repeat the last agent."""
        first = block * LANES
        for k in ti.static(range(2 * dim)):
            scratch[a + moving[k]] = lanes([crowd.agents[ti.min(first + lane, end - 1)][k] for lane in ti.static(range(LANES))])
        scratch[a + rows.alive] = lanes(1.0)
        trial = first // crowd.whole[SLOTS]
        whom = [number_in(crowd.whole, ti.min(first + lane, end - 1)) for lane in ti.static(range(LANES))]
        wide = wide_of(crowd)
        for k in ti.static(range(known)):
            scratch[a + kept[k]] = lanes(
                [crowd.cold[(trial * count + whom[lane]) * wide + k] for lane in ti.static(range(LANES))]
            )
        number = lanes([ti.cast(whom[lane] + 1, real) for lane in ti.static(range(LANES))])
        me = senses.me_of[kind](scratch, a, see.limits_of(numbers, 0, columns), number)
        index = types.integer_lanes([ti.cast(whom[lane], ti.u32) for lane in ti.static(range(LANES))])
        return me, index

    @ti.func
    def save_rows(scratch: ti.template(), a, crowd: ti.template(), count, block, end):
        """Write the cold rows of a block's agents back."""
        trial = block * LANES // crowd.whole[SLOTS]
        wide = wide_of(crowd)
        for lane in range(ti.min(end - block * LANES, LANES)):
            at = (trial * count + number_in(crowd.whole, block * LANES + lane)) * wide
            for k in ti.static(range(known)):
                crowd.cold[at + k] = scratch[a + kept[k]][lane]

    @ti.func
    def save_shown(scratch: ti.template(), a, crowd: ti.template(), block, end):
        """Write what agents show of their memory into their records."""
        for lane in range(ti.min(end - block * LANES, LANES)):
            for k in ti.static(range(len(shown))):
                crowd.agents[block * LANES + lane][2 * dim + k] = scratch[a + shown[k]][lane]

    def saves(near: Any):
        @ti.func
        def save_moved(scratch: ti.template(), a, crowd: ti.template(), rows: ti.template(), block, end):
            """Write a block's moved agents behind those in cell order, with their places in the table."""
            told = [scratch[a + row] for row in ti.static(told_rows)]
            near.put(crowd.agents, crowd.whole, rows, crowd.reals, told, block, end)

        return save_moved

    return Transfer(load=load, save_rows=save_rows, save_shown=save_shown, saves=saves, number_in=number_in, kept=kept)


@ti.func
def share_of(chunk, blocks):
    """Give the first and past the last block of a chunk's share."""
    return blocks * chunk // CHUNKS, blocks * (chunk + 1) // CHUNKS


LOOP = CHUNKS * TASK
"""Iterations of a parallel loop that acts on every TASK-th index, once a chunk."""
