"""Document: the file that the page is: its script, its style, its words, and the recordings it shows."""

import base64
import hashlib
import html
import json
import os
import re
from collections.abc import Sequence
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import Any

from render.page.pack import packed
from render.scene.background import Field
from render.theme import DARK, LIGHT
from tiswarm.records.recording import Recording
from tiswarm.system.files import replacing
from tiswarm.version import __version__

MODULES = (
    "decode",
    "paths",
    "shapes",
    "camera",
    "ground",
    "agents",
    "events",
    "trails",
    "overlays",
    "scene",
    "shaders",
    "webgl",
    "flat",
    "plots",
    "card",
    "clock",
    "pointers",
    "stage",
    "controls",
    "keys",
    "player",
)
"""The modules of all pages, each behind those that it imports from: the order in which they are joined."""

REPLAY = (*MODULES, "gallery", "main")
"""The modules of a page that shows recordings."""

LIVE = (*MODULES, "window", "cloud", "pulse", "desk", "outcomes", "hand", "live")
"""The modules of a page that shows a simulation which runs."""

MOST = 4
"""Recordings that can be compared side by side."""


def replay(
    recording: Recording | Sequence[Recording],
    path: str | os.PathLike,
    *,
    exact: bool = False,
    labels: Sequence[str] | None = None,
    fields: Sequence[Field | None] | None = None,
    gallery: bool = False,
    title: str | None = None,
) -> Path:
    """Write a page that plays a recording, or compares two to four side by side; it needs no network and no other file.

    exact: float32 instead of 16 bits a number. labels: a name for each recording. fields: arrows of each one's avoidance.
    gallery: an overview of any number of recordings instead, each a click away. title: of the gallery.

    Errors: ValueError for no recording, and for more than four to compare, or flat and 3-D ones at once; OSError.
    """
    recordings = [recording] if isinstance(recording, Recording) else list(recording)
    if not recordings:
        raise ValueError("replay: no recording given; record one with tiswarm.record(...)")
    if not gallery and len(recordings) > MOST:
        raise ValueError(f"replay: {len(recordings)} recordings are too many to compare; use 1 to {MOST}, or gallery=True")
    if not gallery and len({each.dim for each in recordings}) > 1:
        raise ValueError("replay: some recordings are flat and some are 3-D; play them one by one, or use gallery=True")
    names = [""] * len(recordings) if labels is None else list(labels)
    arrows = [None] * len(recordings) if fields is None else list(fields)
    if len(names) != len(recordings) or len(arrows) != len(recordings):
        raise ValueError("replay: labels and fields must be as many as recordings")
    parts = []
    for each, name, field in zip(recordings, names, arrows, strict=True):
        header, numbers = packed(each, exact=exact, field=field)
        parts.append(({**header, "label": name}, numbers))
    heading = title or recordings[0].scenario.title
    with replacing(Path(path)) as part:
        part.write_text(document(parts, heading, gallery), encoding="utf-8")
    return Path(path)


def document(parts: Sequence[tuple[dict[str, Any], str]], title: str, gallery: bool) -> str:
    """Write the page around headers and numbers."""
    told = "\n".join(
        f'<script type="application/json" class="header">{_embedded(header)}</script>\n'
        f'<script type="application/octet-stream" class="numbers">{numbers}</script>'
        for header, numbers in parts
    )
    return _written(title, "gallery" if gallery else "player", REPLAY, _read("page.css"), told)[1]


def live(title: str, host: str) -> tuple[str, str]:
    """Write the page of a simulation that runs; give its policy and its text. host: name and port that it may talk to."""
    style = _read("page.css") + _read("live.css")
    return _written(title, "live", LIVE, style, "", panel=_read("live.html"), connect=f"connect-src ws://{host}; ")


def _written(
    title: str, view: str, modules: Sequence[str], style: str, told: str, panel: str = "", connect: str = ""
) -> tuple[str, str]:
    """Give a page's policy and its text."""
    script = joined(modules)
    settings = {
        "version": __version__,
        "title": title,
        "view": view,
        "themes": {"dark": asdict(DARK), "light": asdict(LIGHT)},
    }
    policy = (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}'; {connect}"
        "base-uri 'none'; form-action 'none'"
    )
    body = _read("page.html")
    for key, value in (
        ("POLICY", policy),
        ("TITLE", html.escape(_shortened(title))),
        ("STYLE", style),
        ("PANEL", panel),
        ("SETTINGS", _embedded(settings)),
        ("RECORDINGS", told),
        ("SCRIPT", script),
    ):
        before, marker, after = body.partition(f"<!--{key}-->")
        assert marker, key
        body = before + value + after
    return policy, body


def joined(modules: Sequence[str] = REPLAY) -> str:
    """Join modules to one script: what they import from each other is simply there."""
    texts = []
    for name in modules:
        text = re.sub(r"^import [^;]*;\n", "", _read(f"{name}.js"), flags=re.MULTILINE)
        text = re.sub(r"^ */\*\*(?:[^*]|\*(?!/))*\*/\n", "", text, flags=re.MULTILINE)  # types are for whoever writes modules
        texts.append(re.sub(r"^export ", "", text, flags=re.MULTILINE))
    return "\n" + "\n".join(texts)


def _read(name: str) -> str:
    return (files("render.page") / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """Name a script or a style by what it says, as a page's policy does."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _embedded(value: Any) -> str:
    """Write JSON that can end no script, whatever words it holds."""
    text = json.dumps(value, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _shortened(title: str, most: int = 200) -> str:
    return title if len(title) <= most else title[: most - 1] + "…"
