"""Network columns: where the weights of networks lie in the table of a batch, a column each."""

from collections.abc import Mapping, Sequence

import numpy as np

from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.network import Shape


def shape_of(scenarios: Sequence[Scenario], kind: str) -> Shape | None:
    """Give the shape of the networks that lead a kind of several scenarios, None without.

    Errors: ScenarioError when they differ.
    """
    found = {network.shape for network in (each.network(kind) for each in scenarios) if network is not None}
    if len(found) > 1:
        layers = " and ".join(sorted(f"{shape.inputs} {'-'.join(map(str, shape.layers))}" for shape in found))
        raise ScenarioError(f"batch: networks differ in shape ({layers}); run them one after the other")
    return next(iter(found), None)


def paths_of(kind: str, name: str, shape: Shape | None) -> list[str]:
    """Name the columns of a strategy's network."""
    return [f"{kind}.strategy:{name}.network.{k}" for k in range(shape.size if shape else 0)]


def columns_of(
    kind: str, name: str, shape: Shape, scenarios: Sequence[Scenario], given: Mapping[str, np.ndarray] | None
) -> dict[str, np.ndarray]:
    """Map the columns to the weights of networks: [row].

    given: prey or predators -> [row, weight], in the place of the scenarios' own; a scenario without a network has zeros.
    """
    if given and kind in given:
        rows = np.asarray(given[kind], np.float64)
    else:
        own = [each.network(kind) for each in scenarios]
        rows = np.stack([np.zeros(shape.size) if one is None else one.weights for one in own])
    return dict(zip(paths_of(kind, name, shape), rows.T, strict=True))
