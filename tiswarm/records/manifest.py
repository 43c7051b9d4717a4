"""Manifest: what made a result: version, precision, machine; so that it can be made again."""

import json
import platform
from typing import Any

from tiswarm.simd import backend
from tiswarm.simd.runtime import Settings
from tiswarm.system.machine import processor
from tiswarm.version import __version__


def manifest(settings: Settings, **told: Any) -> str:
    """Write down what made a result, so that it can be made again."""
    machine = {
        "processor": processor(),
        "threads": settings.threads,
        "system": platform.platform(),
        "python": platform.python_version(),
    }
    about = {
        "tiswarm": __version__,
        "taichi": backend.version(),
        "precision": settings.precision,
        "machine": machine,
    }
    return json.dumps({**about, **told}, indent=2) + "\n"
