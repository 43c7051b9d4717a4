"""Networks: the forward pass of a neural strategy, an agent a lane, and what its answers change in a move.

Layer sizes select the code; weights are columns of the table, so that each trial of a batch may have a network of its own.
"""

from types import SimpleNamespace
from typing import Any

import taichi as ti

from tiswarm.dynamics.specialisation import Part
from tiswarm.dynamics.table import ParameterTable
from tiswarm.dynamics.views import Views
from tiswarm.simd.lanes import larger, smaller
from tiswarm.strategies import neural

STEEP = 8.5
"""Beyond this tanh is 1 to 1e-7."""


@ti.func
def tanh(x):
    """Give the hyperbolic tangent: odd, never falling, |error| < 1e-6, the same bits on every machine.

    Lambert's continued fraction of tanh(x / 2), cut behind its seventh link, and tanh x = 2 t / (1 + t²).
    """
    u = 0.5 * smaller(larger(x, -STEEP), STEEP)
    u2 = u * u
    p = u * (135135.0 + u2 * (17325.0 + u2 * (378.0 + u2)))
    q = 135135.0 + u2 * (62370.0 + u2 * (3150.0 + u2 * 28.0))
    return 2.0 * p * q / (q * q + p * p)


@ti.func
def sum_of(products: ti.template()):
    """Add a list up in four strands, which do not wait for each other's additions."""
    strands = [products[k] for k in ti.static(range(min(4, len(products))))]
    for k in ti.static(range(4, len(products))):
        strands[k % 4] += products[k]
    for k in ti.static(range(1, len(strands))):
        strands[0] += strands[k]
    return strands[0]


@ti.func
def forward(shape: ti.template(), numbers: ti.template(), first, agents: ti.template(), scratch, inputs: ti.template()):
    """Write every layer's numbers into an agent's rows from `scratch` on, the outputs last.

    numbers: first weight at row `first`; inputs: a list of lanes.
    """
    weight, row = first, scratch
    for j in range(shape.layers[1]):
        at = weight + j * (shape.layers[0] + 1)
        total = sum_of([numbers[at + k] * inputs[k] for k in ti.static(range(shape.layers[0]))])
        total += numbers[at + shape.layers[0]]
        agents[row + j] = total if ti.static(len(shape.layers) == 2) else tanh(total)
    for layer in ti.static(range(1, len(shape.layers) - 1)):
        weight += (shape.layers[layer - 1] + 1) * shape.layers[layer]
        below = row
        row += shape.layers[layer]
        for j in range(shape.layers[layer + 1]):
            at = weight + j * (shape.layers[layer] + 1)
            total = sum_of([numbers[at + k] * agents[below + k] for k in ti.static(range(shape.layers[layer]))])
            total += numbers[at + shape.layers[layer]]
            agents[row + j] = total if ti.static(layer == len(shape.layers) - 2) else tanh(total)


def build(layout: ParameterTable, see: Views, senses: Any) -> dict[Part, Any]:
    """Build a func for each networked part, which lets its network look and answer before anything steers an agent."""
    parts = [p for kind in ("prey", "predators") for p in layout.parts(kind, "strategy") if p.strategy.networked]
    return {p.part: _consult(p, len(layout.paths), see, senses) for p in parts}


def _consult(p: SimpleNamespace, width: int, see: Views, senses: Any) -> Any:
    shape = p.part.shape
    look = neural.thesis_inputs if shape.inputs == "thesis" else neural.own_inputs
    answers = shape.scratch - shape.layers[-1]

    @ti.func
    def consult(
        notes: ti.template(),
        here: ti.template(),
        agents: ti.template(),
        a,
        me: ti.template(),
        numbers: ti.template(),
        b,
        swarm: ti.template(),
        target: ti.template(),
        dice: ti.template(),
        orders: ti.template(),
    ):
        """Set an agent's gains, and orders: factors of goal and field, and a change of velocity along x and y."""
        weights = see.weights_of(p, numbers, b)
        senses.notice(p, notes, here, me, weights)
        way = see.sight(target, me, numbers, b)
        neural.find_ahead(notes, me, way)
        inputs = look(me, way, swarm, notes, dice)
        forward(shape, numbers, b * width + p.network, agents, a + p.scratch, inputs)
        out = a + p.scratch + answers
        led = weights.on > 0.5
        if ti.static(shape.outputs == "gains"):
            me.separation = ti.select(led, agents[out], me.separation)
            me.alignment = ti.select(led, agents[out + 1], me.alignment)
            me.cohesion = ti.select(led, agents[out + 2], me.cohesion)
            orders[0] = ti.select(led, agents[out + 3], orders[0])
            orders[1] = ti.select(led, agents[out + 4], orders[1])
        else:
            change = neural.world(notes, agents[out], agents[out + 1])
            if ti.static(shape.inputs == "thesis"):  # whose axes are the world's
                change[0], change[1] = agents[out], agents[out + 1]
            orders[2] = ti.select(led, change[0], orders[2])
            orders[3] = ti.select(led, change[1], orders[3])

    return consult
