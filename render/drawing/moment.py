"""Moment: one moment of a trial for papers, as a PDF or SVG of vectors."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from render.captions.layout import SIDE, unit_of
from render.composition import Composition, Subject
from render.drawing.manuscript import Manuscript
from render.drawing.page import Page
from render.encoder import FilmError
from render.films import checked_size, notes
from render.scene.background import Field
from render.style import look_of
from tiswarm.system.extras import needed
from tiswarm.system.files import replacing
from tiswarm.system.words import reason

UNIT = 0.42
"""Points of a unit of type: captions in 7 to 8 points, as papers have them."""

WIDE, HIGH, SQUARE = 1280, 900, (1400, 900)
"""Width of a page whose caption is below [px], height of one whose caption is beside, and the size of one of several worlds."""

BELOW = 165
"""Height of a caption below [units of type]."""

BROAD = 1.45
"""Worlds that are this much wider than high have their caption below."""


def moment(
    subject: Subject,
    path: str | os.PathLike,
    time: float,
    size: tuple[int, int] | None = None,
    *,
    labels: Sequence[str] | None = None,
    field: Field | None = None,
    **look: Any,
) -> Path:
    """Write one moment as vectors: shapes as paths, words as text; the cloud of a crowd alone is a picture. Extra `plot`.

    path: .pdf or .svg. time [ticks]: from 0 to the trial's last. size: of the frame that is laid out [px]; when None it follows
    the world's. Type has the size that papers have, whatever the frame's. look: as for a film, but its theme is "print".

    Errors: ValueError or TypeError for a choice that is not possible; MissingExtra; FilmError when it cannot be written.
    """
    target = Path(path)
    kind = check_moment(target)
    style = look_of({"theme": "print", **look})
    subjects: list[Any] = list(subject) if isinstance(subject, Sequence) else [subject]
    last = max((each.ticks for each in subjects), default=0)
    if not 0 <= time <= last:
        raise ValueError(f"time: {time:g} is outside the trial; use 0 to {last}")
    size = size or (page_size(subjects[0]) if len(subjects) == 1 else SQUARE)
    checked_size(size, even=False)
    manuscript = Manuscript()
    stage = Composition(subject, size, style, yuv=False, labels=labels, field=field, atlas=manuscript)
    if stage.caption:
        stage.caption.progresses = False
    backdrop = None if style.transparent else style.colours["backdrop"]
    page = Page(size, UNIT / unit_of(size), manuscript, backdrop, kind)
    try:
        with replacing(target) as part:
            page.draw(stage.shapes(time), stage.windows, np.array(style.colours["world"]))
            page.save(part, notes(stage))
    except OSError as error:
        raise FilmError(f"{target}: cannot be written: {reason(error)}") from None
    return target


def check_moment(path: Path) -> str:
    """Give the format that a path's suffix names: "pdf" or "svg". Errors: ValueError for another one; MissingExtra."""
    kind = path.suffix.lower().removeprefix(".")
    if kind not in ("pdf", "svg"):
        raise ValueError(f"{path}: unknown format {path.suffix!r}; use .pdf or .svg")
    needed("plot", "matplotlib")
    return kind


def page_size(subject: Any) -> tuple[int, int]:
    """Give a frame [px] that a world and its caption fill: the caption beside it, or below where it is broad."""
    width, height = subject.scenario.world.size[:2]
    aspect = width / height
    if aspect >= BROAD:
        return WIDE, round(WIDE / aspect * 720 / (720 - BELOW))
    return round(HIGH * max(aspect, 0.4) + SIDE * unit_of((HIGH, HIGH))), HIGH
