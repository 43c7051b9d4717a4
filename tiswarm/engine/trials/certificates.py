"""Certificates: the commands of a block's prey, corrected before anybody goes, so that no two come too near each other.

The rules are dynamics/barrier.py's.
"""

import taichi as ti

from tiswarm.dynamics import barrier
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.trials import joint, shared
from tiswarm.scenario.measures import CHANGED
from tiswarm.simd.lanes import dot, row_of
from tiswarm.simd.runtime import Func, Types


def build(layout: ParameterTable, types: Types) -> Func:
    """Build what corrects the commands that lie in the prey's next velocities, and notes whose are; nothing without safety."""
    form = layout.structure.frame.safety

    @ti.func
    def certify(block: ti.template()):
        pass

    if not form:
        return certify
    rules = barrier.build(layout)
    return (joint if form == "joint" else shared).build(layout, types, rules, _noted(layout))


def _noted(layout: ParameterTable) -> Func:
    """Build what writes an agent's velocity down, and whether it is another than its command."""
    rows, prey_rows, width = layout.rows, layout.agent_rows["prey"], len(layout.paths)
    most = layout.at.prey.max_speed

    @ti.func
    def allow(prey: ti.template(), numbers: ti.template(), b, count, i, u: ti.template()):
        a = row_of(b * count + i, prey_rows)
        away = [u[k] - prey[a + rows.next_motion[k]] for k in ti.static(range(2))]
        least = CHANGED * numbers[b * width + most]
        changed = (dot(away, away) > least * least) & (prey[a + rows.alive] > 0.5)
        prey[a + rows.corrected] = ti.select(changed, 1.0, 0.0)
        for k in ti.static(range(2)):
            prey[a + rows.next_motion[k]] = u[k]

    return allow
