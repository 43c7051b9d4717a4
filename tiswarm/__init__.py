"""tiswarm: predator-prey swarms, thousands of trials in parallel on a laptop's CPU."""

import importlib
import os
from typing import TYPE_CHECKING, Any

from tiswarm.simd import backend
from tiswarm.simd.kernel_cache import ensure_home
from tiswarm.version import __version__

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "False")
ensure_home()
backend.choose()

_HOMES = {
    "init": "simd.runtime",
    "load": "scenario.presets",
    "Scenario": "scenario.model",
    "ScenarioError": "scenario.errors",
    "add_path": "strategies.registry",
    "Start": "scenario.start",
    "simulate": "engine.run",
    "record": "engine.run",
    "Simulation": "engine.run",
    "Results": "records.results",
    "Estimate": "records.results",
    "compare": "records.results",
    "Recording": "records.recording",
    "Swarm": "engine.swarms.simulation",
    "Report": "studies.report",
    "study": "studies.run",
    "tune": "learning.tune",
    "Environment": "environments.environment",
    "env": "environments.make",
    "gym_env": "environments.make",
    "parallel_env": "environments.make",
    "vector_env": "environments.make",
}

__all__ = [
    "Environment",
    "Estimate",
    "Recording",
    "Report",
    "Results",
    "Scenario",
    "ScenarioError",
    "Simulation",
    "Start",
    "Swarm",
    "__version__",
    "add_path",
    "compare",
    "env",
    "gym_env",
    "init",
    "load",
    "parallel_env",
    "record",
    "simulate",
    "study",
    "tune",
    "vector_env",
]

if TYPE_CHECKING:
    from tiswarm.engine.run import Simulation, record, simulate
    from tiswarm.engine.swarms.simulation import Swarm
    from tiswarm.environments.environment import Environment
    from tiswarm.environments.make import env, gym_env, parallel_env, vector_env
    from tiswarm.learning.tune import tune
    from tiswarm.records.recording import Recording
    from tiswarm.records.results import Estimate, Results, compare
    from tiswarm.scenario.errors import ScenarioError
    from tiswarm.scenario.model import Scenario
    from tiswarm.scenario.presets import load
    from tiswarm.scenario.start import Start
    from tiswarm.simd.runtime import init
    from tiswarm.strategies.registry import add_path
    from tiswarm.studies.report import Report
    from tiswarm.studies.run import study


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: `tiswarm --help` must not wait for Taichi."""
    if name not in _HOMES:
        raise AttributeError(f"module 'tiswarm' has no attribute '{name}'")
    return getattr(importlib.import_module(f"tiswarm.{_HOMES[name]}"), name)
