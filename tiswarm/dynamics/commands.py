"""Commands: agents that obey numbers from outside, which a program writes into their rows before each move."""

from typing import Any, Literal

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.simd import philox
from tiswarm.simd.lanes import motion
from tiswarm.simd.runtime import Types

Command = Literal["velocity", "acceleration", "gains"]


def modes(layout: ParameterTable) -> dict[str, Command]:
    """Map the kinds of agents that obey to what they are told: where to go, or factors of the ordinary terms' gains."""
    return dict(layout.structure.commanded)  # type: ignore[arg-type]


def build(layout: ParameterTable, types: Types, turned: Any, deflected: Any, dice_of: Any, steps: Any) -> dict[str, Any]:
    """Build for each kind that is told where to go what moves one of its agents, in the place of all that it would do itself.

    Avoidances that turn or deflect a course, walls' reflection and the speed cap still act: they are what a body can do.
    """
    found = modes(layout)
    moved = {kind: mode for kind, mode in found.items() if mode != "gains"}
    return {kind: _driven(layout, types, kind, mode, turned, deflected, dice_of, steps) for kind, mode in moved.items()}


def _driven(
    layout: ParameterTable, types: Types, kind: str, mode: Command, turned: Any, deflected: Any, dice_of: Any, steps: Any
) -> Any:
    lanes, rows, told = types.lanes, layout.rows, layout.commands[kind]
    own, deflects = getattr(steps, kind), bool(layout.parts(kind, "avoidance", "deflect"))
    width, at = len(layout.paths), layout.at
    purpose = philox.DEFLECTION if kind == "prey" else philox.PREDATOR_DEFLECTION

    @ti.func
    def drive(
        here: ti.template(),
        draw: ti.template(),
        agents: ti.template(),
        a,
        me: ti.template(),
        numbers: ti.template(),
        b,
        others: ti.template(),
        target: ti.template(),
    ):
        """Take the velocity, or the change of it a second, that is written down; turn; cap; p += v dt."""
        course = [1.0 * agents[a + row] for row in ti.static(told)]
        if ti.static(mode == "acceleration"):
            for k in ti.static(range(len(told))):
                course[k] = motion(me)[k] + numbers[b * width + at.dt] * course[k]
        turned(course, here, kind, me, numbers, b)
        own.limited(course, me, numbers, b)
        if ti.static(deflects):
            deflected(course, here, kind, me, numbers, b, target, dice_of(draw, purpose))
        agents[a + rows.seen] = lanes(0.0)
        own.advance(agents, a, course, me, numbers, b)

    return drive


@ti.func
def regain(agents: ti.template(), a, told: ti.template(), me: ti.template(), orders: ti.template()):
    """Multiply an agent's gains by the factors that are written down, in the order of table.GAINS."""
    me.separation = me.separation * agents[a + told[0]]
    me.alignment = me.alignment * agents[a + told[1]]
    me.cohesion = me.cohesion * agents[a + told[2]]
    orders[0] = orders[0] * agents[a + told[3]]
    orders[1] = orders[1] * agents[a + told[4]]
