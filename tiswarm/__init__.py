"""tiswarm: predator-prey swarms, thousands of trials in parallel on a laptop's CPU."""

import importlib
import os
from typing import TYPE_CHECKING, Any

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "False")

__version__ = "0.1.0"

_HOMES = {
    "init": "runtime",
    "load": "presets",
    "Scenario": "scenario",
    "ScenarioError": "explain",
    "add_path": "registry",
    "Start": "start",
    "simulate": "batch",
    "record": "single",
    "Results": "results",
    "Estimate": "results",
    "compare": "results",
    "Recording": "recording",
    "Swarm": "swarm",
}

__all__ = [
    "Estimate",
    "Recording",
    "Results",
    "Scenario",
    "ScenarioError",
    "Start",
    "Swarm",
    "__version__",
    "add_path",
    "compare",
    "init",
    "load",
    "record",
    "simulate",
]

if TYPE_CHECKING:
    from tiswarm.batch import simulate
    from tiswarm.explain import ScenarioError
    from tiswarm.presets import load
    from tiswarm.recording import Recording
    from tiswarm.registry import add_path
    from tiswarm.results import Estimate, Results, compare
    from tiswarm.runtime import init
    from tiswarm.scenario import Scenario
    from tiswarm.single import record
    from tiswarm.start import Start
    from tiswarm.swarm import Swarm


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: `tiswarm --help` must not wait for Taichi."""
    if name not in _HOMES:
        raise AttributeError(f"module 'tiswarm' has no attribute '{name}'")
    return getattr(importlib.import_module(f"tiswarm.{_HOMES[name]}"), name)
