"""page: one self-contained HTML file to look into recordings, and the modules of JavaScript that it is made of."""

from render.page.document import replay

__all__ = ["replay"]
