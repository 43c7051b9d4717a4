"""live: a simulation that runs while a page shows it, and that the page's reader turns."""

from render.live.server import serve

__all__ = ["serve"]
