"""Commands: agents that obey numbers from outside, which a program writes into their rows before each move."""

from typing import Any, Literal

import taichi as ti

from tiswarm.dynamics.integrator import Steps
from tiswarm.dynamics.table import ParameterTable
from tiswarm.simd.lanes import motion
from tiswarm.simd.runtime import Types

Command = Literal["velocity", "acceleration", "gains"]


def modes(layout: ParameterTable) -> dict[str, Command]:
    """Map the kinds of agents that obey to what they are told: how to move, or factors of the ordinary terms' gains."""
    return dict(layout.structure.commanded)  # type: ignore[arg-type]


def build(layout: ParameterTable, types: Types, steps: Steps) -> dict[str, Any]:
    """Build for each kind that is told how to move what moves an agent of it, in the place of all that it would do itself."""
    told = {kind: mode for kind, mode in modes(layout).items() if mode != "gains"}
    return {kind: _driven(layout, types, steps, kind, mode) for kind, mode in told.items()}


def _driven(layout: ParameterTable, types: Types, steps: Steps, kind: str, mode: Command) -> Any:
    lanes, rows, told = types.lanes, layout.rows, layout.commands[kind]
    own, width, at = getattr(steps, kind), len(layout.paths), layout.at

    @ti.func
    def drive(
        here: ti.template(),  # noqa: ARG001 - this and what follows as of agents that do not obey
        draw: ti.template(),  # noqa: ARG001
        agents: ti.template(),
        a,
        me: ti.template(),
        numbers: ti.template(),
        b,
        others: ti.template(),  # noqa: ARG001
        target: ti.template(),  # noqa: ARG001
    ):
        """Take the velocity that is written down, or add the acceleration; cap; p += v dt."""
        course = [1.0 * agents[a + row] for row in ti.static(told)]
        if ti.static(mode == "acceleration"):
            for k in ti.static(range(len(told))):
                course[k] = motion(me)[k] + numbers[b * width + at.dt] * course[k]
        own.limited(course, me, numbers, b)
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
