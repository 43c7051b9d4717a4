"""Compiled: all that large swarms of one structure launch, built once per runtime."""

from dataclasses import dataclass
from types import SimpleNamespace

from tiswarm.dynamics import spawn, views
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.swarms import contacts, kernels, near_cells
from tiswarm.simd import runtime
from tiswarm.space.cell_list import Grid


@dataclass(frozen=True)
class SwarmKernels:
    """All that large swarms of one structure launch; contacts: None where nobody dies or arrives."""

    tick: kernels.TickKernels
    contacts: contacts.ContactKernels | None


def of(layout: ParameterTable, grids: dict[str, Grid]) -> SwarmKernels:
    """Give the kernels for a structure and kinds of grids, built once per runtime."""
    near = SimpleNamespace(**{kind: grid.funcs for kind, grid in grids.items()})
    key = ("swarm", layout.structure, *(id(funcs) for funcs in vars(near).values()))
    return runtime.kept(key, lambda: _build(layout, near))


def _build(layout: ParameterTable, near: SimpleNamespace) -> SwarmKernels:
    types = runtime.types()
    see = views.build(layout, types)
    senses = near_cells.build(layout, types, see, near)
    uniform = spawn.build(layout, types).uniform
    tick = kernels.build(layout, types, see, senses, near, uniform)
    judged = contacts.build(layout, types, see, senses, near) if layout.structure.mortal else None
    return SwarmKernels(tick, judged)
