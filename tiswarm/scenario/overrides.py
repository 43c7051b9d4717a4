"""Overrides: a scenario's table with some of its keys changed."""

from collections.abc import Mapping
from copy import deepcopy
from typing import Any

from tiswarm.scenario.errors import ScenarioError
from tiswarm.strategies import registry


def overridden(table: dict[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Change keys of a table; with another strategy or avoidance, weights that it does not know go.

    Errors: ScenarioError.
    """
    out = deepcopy(table)
    for path, value in overrides.items():
        *above, last = path.split(".")
        place: Any = out
        for key in above:
            place = place[_index(place, key, path)] if isinstance(place, list) else place.setdefault(key, {})
            if not isinstance(place, dict | list):
                raise ScenarioError(f"{path}: '{key}' holds a value, not a table")
        plain = value.tolist() if hasattr(value, "tolist") else value  # NumPy's numbers and arrays
        place[_index(place, last, path) if isinstance(place, list) else last] = plain
    kind: registry.Side
    for kind in ("prey", "predators"):
        if f"{kind}.strategy" in overrides or f"{kind}.avoidance" in overrides:
            _drop_stale_weights(out, kind, overrides)
    return out


def _drop_stale_weights(table: dict[str, Any], kind: registry.Side, overrides: Mapping[str, Any]) -> None:
    agents = table.get(kind)
    if not isinstance(agents, dict):
        return  # the check of the whole scenario says what is wrong
    weights = agents.get("weights")
    chosen = [(catalogue, agents.get(role, "")) for role, catalogue in registry.catalogues(kind)]
    known = all(name in registry.names(catalogue) for catalogue, name in chosen)
    if isinstance(weights, dict) and known and f"{kind}.weights" not in overrides:
        kept = {key for catalogue, name in chosen for key in registry.defaults(catalogue, name)}
        agents["weights"] = {
            key: value for key, value in weights.items() if key in kept or f"{kind}.weights.{key}" in overrides
        }


def _index(items: list[Any], key: str, path: str) -> int:
    if not (key.isascii() and key.isdecimal()) or int(key) >= len(items):
        places = f"use 0 to {len(items) - 1}" if items else "it is empty"
        raise ScenarioError(f"{path}: '{key}' is no place in a list of {len(items)}; {places}")
    return int(key)
