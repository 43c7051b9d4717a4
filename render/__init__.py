"""render: pictures and films of tiswarm's recordings."""

import importlib
from typing import TYPE_CHECKING, Any

_HOMES = {
    "film": "films",
    "check_film": "films",
    "check_image": "films",
    "frames": "films",
    "poster": "films",
    "moment": "drawing.moment",
    "check_moment": "drawing.moment",
    "sheet": "films",
    "still": "films",
    "replay": "page.document",
    "Among": "captions.among",
    "Film": "films",
    "Field": "scene.background",
    "Live": "source",
    "FilmError": "encoder",
    "QUALITIES": "encoder",
    "Look": "style",
    "OVERLAYS": "style",
    "USES": "style",
    "subtitles": "story",
    "Theme": "theme",
    "THEMES": "theme",
}

__all__ = [
    "OVERLAYS",
    "QUALITIES",
    "THEMES",
    "USES",
    "Among",
    "Field",
    "Film",
    "FilmError",
    "Live",
    "Look",
    "Theme",
    "check_film",
    "check_image",
    "check_moment",
    "film",
    "frames",
    "moment",
    "poster",
    "replay",
    "sheet",
    "still",
    "subtitles",
]

if TYPE_CHECKING:
    from render.captions.among import Among
    from render.drawing.moment import check_moment, moment
    from render.encoder import QUALITIES, FilmError
    from render.films import Film, check_film, check_image, film, frames, poster, sheet, still
    from render.page.document import replay
    from render.scene.background import Field
    from render.source import Live
    from render.story import subtitles
    from render.style import OVERLAYS, USES, Look
    from render.theme import THEMES, Theme


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: importing render must not wait for Taichi."""
    if name not in _HOMES:
        raise AttributeError(f"module 'render' has no attribute '{name}'")
    return getattr(importlib.import_module(f"render.{_HOMES[name]}"), name)
