"""Measured pairs: kernels that look at who of a large swarm is near whom, through its cells, and change nothing.

Distances and energies are summed up in the pieces of measured_agents.py; labels of groups are whole numbers, each the least
of its group in the end, whoever came first.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.swarms.transfer import LOOP, share_of
from tiswarm.measures import formulas
from tiswarm.simd.lanes import Bundle, anywhere, dot, larger, place, safe, smaller
from tiswarm.simd.runtime import LANES, TASK, Func, Types
from tiswarm.space.box_lanes import displacement
from tiswarm.space.cell_list import CellFuncs
from tiswarm.space.cells import CELLS, COUNT_X, HEAD, PER_METRE, PERIOD, REACH_X, SLOTS, TRIALS

FAR = 1e15
"""Where lanes wait that do not look: out of everyone's reach, and its square is still a number [m]."""

NOBODY = 1e30
"""The squared distance to nobody [m²]."""

NO_LABEL = 2**31 - 1


def build_pairs(layout: ParameterTable, types: Types, near: CellFuncs, pieces: Callable[..., Any]):
    """Build the kernel that sums up distances to nearest neighbours, and energies of pairs beside those at perception.

    A column each, and a third with the largest inverse of a distance. All come from one walk through the cells; who has met
    nobody near enough looks for the nearest further on.
    """
    lanes, real, dim = types.lanes, types.real, len(layout.axes)
    energetic = "potential" in layout.structure.frame.measures
    spacing, perception = layout.at.prey.spacing, layout.at.prey.perception

    @ti.func
    def meet(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        away = [near.across(here[k] - agents[j][k], k, reals) for k in ti.static(range(dim))]
        oneself = view.lane == ti.cast(j - view.first, real)
        distance2 = ti.select(oneself, NOBODY, dot(away, away))
        view.least[0] = smaller(view.least[0], distance2)
        if ti.static(energetic):
            inside = distance2 < view.reach2
            if anywhere(inside):
                energy = formulas.pair_energy(distance2, view.reach2, view.spacing2) - view.rim
                view.energy[0] += ti.select(inside, energy, 0.0)

    @ti.func
    def meet_nearest(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        """Meet an agent at the nearest of all its images."""
        away = [here[k] - agents[j][k] for k in ti.static(range(dim))]
        if ti.static(near.periodic):
            for k in ti.static(range(dim)):
                away[k] = ti.select(here[0] < 0.5 * FAR, displacement(away[k], ti.cast(reals[PERIOD + k], real)), FAR)
        distance2 = ti.select(view.lane == ti.cast(j - view.first, real), NOBODY, dot(away, away))
        view.least[0] = smaller(view.least[0], distance2)

    around, box = near.walks(meet).around, near.walks(meet_nearest).box

    @ti.func
    def searched(whole: ti.template(), reals: ti.template(), wide):
        """Give how far cells `wide` times the grid's reach away surely go [m], 0 where looking at everybody is less."""
        sure = ti.cast(NOBODY, ti.f64)
        cells = 1.0
        for k in ti.static(range(dim)):
            count = whole[COUNT_X + k]
            reach = whole[REACH_X + k] * wide
            if count > 1:
                sure = ti.min(sure, (1.0 - 1e-5) * reach / reals[PER_METRE + k])
                cells *= 2.0 * reach + 1.0
                if ti.static(near.periodic):  # noqa: SIM102 - one branch at compile time, one at run time
                    if 2 * reach + 1 > count:  # no cell may be visited twice, nor any image beyond the next
                        cells = NOBODY
        if wide > 1 and cells > whole[SLOTS]:
            sure = 0.0
        return ti.cast(sure, real)

    @ti.func
    def look_wider(view: ti.template(), p: ti.template(), here: ti.template(), block, end):
        """Let agents whose nearest is not within what was searched look further, one by one, in the end at all there are."""
        everybody = 0
        for lane in range(end - block * LANES):
            wide = 1
            while wide > 0 and everybody == 0:
                least = real(0.0)
                for k in ti.static(range(LANES)):
                    if k == lane:
                        least = view.least[0][k]
                sure = searched(here.whole, here.reals, wide)
                if least <= sure * sure:
                    wide = 0
                elif searched(here.whole, here.reals, 2 * wide) > 0.0:
                    wide *= 2
                    cells = near.cells_of(here.agents[block * LANES + lane], here.whole, here.reals)
                    reach = wide * ti.Vector([here.whole[REACH_X + k] for k in ti.static(range(3))])
                    alone = [1.0 * p[k] for k in ti.static(range(dim))]
                    alone[0] = ti.select(view.lane == ti.cast(lane, real), p[0], FAR)
                    box(view, alone, here.agents, here.whole, here.reals, here.trial, cells - reach, cells + reach)
                else:
                    everybody = 1
                    for j in range(here.trial * here.whole[SLOTS], near.alive_end(here.whole, here.trial)):
                        meet_nearest(view, p, here.agents, j, here.reals)

    @ti.func
    def add_pairs(own: ti.template(), here: ti.template(), body, block, end):
        lane = lanes([float(number) for number in ti.static(range(LANES))])
        reach2 = here.numbers[perception] * here.numbers[perception]
        spacing2 = here.numbers[spacing] * here.numbers[spacing]
        least, energy = [lanes(NOBODY)], [lanes(0.0)]
        rim = formulas.pair_energy(reach2, reach2, spacing2)
        view = Bundle(
            least=least, energy=energy, lane=lane, first=block * LANES, reach2=reach2, spacing2=spacing2, rim=rim,
        )  # fmt: skip
        p = [1.0 * each for each in ti.static(place(body))]
        around(view, p, here.agents, here.whole, here.reals, here.trial, block, end)
        look_wider(view, p, here, block, end)
        own[0] += body.alive * ti.sqrt(least[0])
        own[1] += 0.5 * body.alive * energy[0]
        own[2] = larger(own[2], body.alive / ti.sqrt(safe(least[0])))

    return pieces(3, add_pairs, greatest=(2,))


@dataclass(frozen=True)
class Labels:
    """Kernels that find groups."""

    join: Func  # give neighbours the lower of their labels
    shorten: Func  # give agents the label of those whose label they bear


def build_groups(layout: ParameterTable, types: Types, near: CellFuncs, body_of: Any) -> Labels:
    """Build the kernels, launched in turns until nothing changes: then agents of a group bear its first slot as label.

    near: the funcs of the grid that is searched; labels: [slot], at first each its own.
    """
    lanes, integers, dim = types.lanes, ti.types.vector(LANES, ti.i32), len(layout.axes)
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)
    distance = layout.at.distance

    @ti.func
    def meet(view: ti.template(), here: ti.template(), agents: ti.template(), j, reals: ti.template()):
        """Give both of a pair the lower label, and those whose labels these were, whichever of the two sees the other."""
        away = [near.across(here[k] - agents[j][k], k, reals) for k in ti.static(range(dim))]
        inside = dot(away, away) <= view.reach2
        if anywhere(inside):
            label = view.labels[j]
            lowest = ti.select(inside, view.own[0], NO_LABEL).min()
            if lowest < label:
                ti.atomic_min(view.labels[label], lowest)
                ti.atomic_min(view.labels[j], lowest)
                view.changed[0] = 1
                label = lowest
            view.own[0] = ti.select(inside & (view.own[0] > label), label, view.own[0])

    around = near.walks(meet).around

    @ti.func
    def join_block(
        agents: ti.template(), whole: ti.template(), reals: ti.template(), numbers: ti.template(), labels: ti.template(),
        changed: ti.template(), trial, block, end,
    ):  # fmt: skip
        """Give a block's agents, which there are up to slot `end`, and whose label they bore the least label around them."""
        p = [1.0 * each for each in ti.static(place(body_of(agents, block, end)))]
        first = [labels[ti.min(block * LANES + lane, end - 1)] for lane in ti.static(range(LANES))]
        own = [integers(first)]
        reach2 = numbers[distance] * numbers[distance]
        view = Bundle(own=own, labels=labels, changed=changed, reach2=lanes(reach2))
        around(view, p, agents, whole, reals, trial, block, end)
        for lane in ti.static(range(LANES)):
            if block * LANES + lane < end and own[0][lane] < first[lane]:
                ti.atomic_min(labels[first[lane]], own[0][lane])
                ti.atomic_min(labels[block * LANES + lane], own[0][lane])
                changed[0] = 1

    @ti.kernel
    def join(
        agents: near.agent_array, whole: whole_array, reals: near.real_array, numbers: types.lane_array(1),
        labels: whole_array, changed: whole_array,
    ):  # fmt: skip
        for index in range(LOOP):
            if index % TASK == 0:
                begin, past = share_of(index // TASK, whole[SLOTS] * whole[TRIALS] // LANES)
                for block in range(begin, past):
                    trial = block * LANES // whole[SLOTS]
                    end = ti.min((block + 1) * LANES, near.alive_end(whole, trial))
                    if end > block * LANES:
                        join_block(agents, whole, reals, numbers, labels, changed, trial, block, end)

    @ti.kernel
    def shorten(labels: whole_array, slots: ti.i32):
        """Let each agent bear the label of those whose label it bears."""
        for slot in range(slots):
            label = labels[slot]
            while labels[label] < label:
                label = labels[label]
            labels[slot] = label

    return Labels(join=join, shorten=shorten)


def build_refile(near: CellFuncs, other: CellFuncs, dim: int):
    """Build the kernel that puts a grid's agents into another grid with cells of its own size, where its sort expects them."""
    whole_array = ti.types.ndarray(dtype=ti.i32, ndim=1)

    @ti.kernel
    def refile(
        agents: near.agent_array, whole: whole_array,
        other_agents: other.agent_array, other_whole: whole_array, other_reals: other.real_array,
    ):  # fmt: skip
        total = whole[SLOTS] * whole[TRIALS]
        for slot in range(total):
            trial = slot // whole[SLOTS]
            cell = other_whole[CELLS] - 1
            if slot < near.alive_end(whole, trial):
                cell = other.place_of(agents[slot], other_whole, other_reals)
            other_whole[HEAD + slot] = trial * other_whole[CELLS] + cell
            other_whole[HEAD + 2 * total + slot] = whole[HEAD + total + slot]
            for k in ti.static(range(dim)):
                other_agents[total + slot][k] = agents[slot][k]

    return refile
