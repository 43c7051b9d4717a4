"""Compiled: all that large swarms of one structure launch, built once per runtime."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

from tiswarm.dynamics import spawn, views
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.swarms import contacts, kernels, near_cells
from tiswarm.simd import runtime
from tiswarm.space import box
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
    return SwarmKernels(tick, _judging(_of_contact(layout), near) if layout.structure.mortal else None)


def _of_contact(layout: ParameterTable) -> Specialisation:
    """Give what of a structure a verdict's code depends on: kind of contact, world and fields."""
    structure = layout.structure
    wraps, kinds = box.wraps(structure.frame.boundary), ("prey", "predators")
    frame = replace(
        structure.frame, boundary="periodic" if wraps else "open", contact=structure.frame.contact if structure.hunted else "",
        verlet=False, per_second=False, clear=False, shapes=("", ""), capped=(False, False), unicycles=(), slow=(), narrow=(),
        choosy=(), measures=(), cells=(0, 0), plan="", plan_cells=(0, 0), safety="", apart=(),
    )  # fmt: skip
    fields = tuple(p.part for kind in kinds for p in layout.parts(kind, "avoidance", "field"))
    return Specialisation(frame, fields, structure.hunted)


def _judging(structure: Specialisation, near: SimpleNamespace) -> contacts.ContactKernels:
    """Give the kernels of contact, which swarms of many structures share."""

    def build() -> contacts.ContactKernels:
        types = runtime.types()
        layout = ParameterTable(structure, types.lanes)
        see = views.build(layout, types)
        return contacts.build(layout, types, see, near_cells.build(layout, types, see, near), near)

    return runtime.kept(("contact", structure, *(id(funcs) for funcs in vars(near).values())), build)
