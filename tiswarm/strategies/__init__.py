"""Strategies: behaviours, one file each, found by name, and the terms they share. No array, no loop over agents.

Whoever writes a strategy imports from here alone: its base (`Prey`, `Predator`, `Avoidance`), what a term may use on its
numbers (simd/lanes.py), and the flocking that all share (flocking.py).
"""

import importlib
from typing import TYPE_CHECKING, Any

_HOMES = {
    "Prey": "tiswarm.strategies.prey",
    "Predator": "tiswarm.strategies.predators",
    "Avoidance": "tiswarm.strategies.avoidance",
    "ReachingField": "tiswarm.strategies.avoidance",
    "note_mate": "tiswarm.strategies.flocking",
    "shortest": "tiswarm.space.box_lanes",
    **dict.fromkeys(
        [
            *("TINY", "anywhere", "capped", "coordinates", "cosine", "dot", "heading", "larger", "logarithm", "minus"),
            *("motion", "near", "place", "plus", "rates", "safe", "scaled", "sine", "smaller", "unit", "vector"),
        ],
        "tiswarm.simd.lanes",
    ),
}

if TYPE_CHECKING:
    from tiswarm.simd.lanes import TINY as TINY
    from tiswarm.simd.lanes import anywhere as anywhere
    from tiswarm.simd.lanes import capped as capped
    from tiswarm.simd.lanes import coordinates as coordinates
    from tiswarm.simd.lanes import cosine as cosine
    from tiswarm.simd.lanes import dot as dot
    from tiswarm.simd.lanes import heading as heading
    from tiswarm.simd.lanes import larger as larger
    from tiswarm.simd.lanes import logarithm as logarithm
    from tiswarm.simd.lanes import minus as minus
    from tiswarm.simd.lanes import motion as motion
    from tiswarm.simd.lanes import near as near
    from tiswarm.simd.lanes import place as place
    from tiswarm.simd.lanes import plus as plus
    from tiswarm.simd.lanes import rates as rates
    from tiswarm.simd.lanes import safe as safe
    from tiswarm.simd.lanes import scaled as scaled
    from tiswarm.simd.lanes import sine as sine
    from tiswarm.simd.lanes import smaller as smaller
    from tiswarm.simd.lanes import unit as unit
    from tiswarm.simd.lanes import vector as vector
    from tiswarm.space.box_lanes import shortest as shortest
    from tiswarm.strategies.avoidance import Avoidance as Avoidance
    from tiswarm.strategies.avoidance import ReachingField as ReachingField
    from tiswarm.strategies.flocking import note_mate as note_mate
    from tiswarm.strategies.predators import Predator as Predator
    from tiswarm.strategies.prey import Prey as Prey


def __getattr__(name: str) -> Any:
    """Import a name when it is first used: listing strategies must not wait for Taichi."""
    if name not in _HOMES:
        raise AttributeError(f"module 'tiswarm.strategies' has no attribute '{name}'")
    return getattr(importlib.import_module(_HOMES[name]), name)
