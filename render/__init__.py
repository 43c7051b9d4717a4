"""render: pictures and films of tiswarm's recordings."""

import importlib
from typing import TYPE_CHECKING, Any

_HOMES = {"film": "films", "FilmError": "encoder", "Theme": "theme", "THEMES": "theme"}

__all__ = [*_HOMES]  # noqa: PLE0604

if TYPE_CHECKING:
    from render.encoder import FilmError
    from render.films import film
    from render.theme import THEMES, Theme


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: importing render must not wait for Taichi."""
    if name not in _HOMES:
        raise AttributeError(f"module 'render' has no attribute '{name}'")
    return getattr(importlib.import_module(f"render.{_HOMES[name]}"), name)
