"""Changes: what a scenario has other than the preset that it was loaded from."""

from collections.abc import Iterator, Mapping
from typing import Any

from tiswarm.scenario import presets
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import UNCOUNTED, Scenario
from tiswarm.scenario.parts import plain


def changes(scenario: Scenario) -> dict[str, Any]:
    """Map the path of each key that differs from the scenario's preset to its value, strategies first.

    Weights are compared with those that the preset would have under the scenario's strategies. A scenario that came from
    elsewhere than a preset of tiswarm's has no changes: nothing is known of them.
    """
    if scenario.preset not in presets.presets():
        return {}
    try:
        base = presets.load(scenario.preset)
        roles = {
            f"{kind}.{role}": getattr(getattr(scenario, kind), role)
            for kind in ("prey", "predators")
            for role in ("strategy", "avoidance")
            if getattr(getattr(scenario, kind), role) != getattr(getattr(base, kind), role)
        }
        same = base.replaced(roles) if roles else base
    except ScenarioError:  # a preset that has changed since, or strategies that it cannot have
        return {}
    before = dict(_leaves(plain(same)))
    return roles | {path: value for path, value in _leaves(plain(scenario)) if before.get(path) != value}


def _leaves(table: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if not path and key in UNCOUNTED:
            continue
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{path}{key}.")
        else:
            yield f"{path}{key}", value
