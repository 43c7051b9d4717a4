"""Gallery: every preset with a frame of its film, the command and its TOML. `python docs/site/frames.py` draws the frames."""

from math import ceil
from pathlib import Path

from tiswarm.scenario import presets

FRAMES = Path(__file__).parents[1] / "gallery"

LONGEST = 60
"""Seconds that a film of the gallery plays; films show ten ticks a second unless they are told otherwise."""

INTRODUCTION = """---
hide: [navigation]
---

# Gallery

Every preset that comes with tiswarm: a frame of its film, the command that makes the film, and the file as a start for one of
your own.
"""

TITLES = {
    "delft": "Delft: obstacles, a target, predators",
    "demo": "Showcases",
    "lookout": "Lookout: spheres in space",
    "m20": "Hawk and swallows",
    "sanitation": "Sanitation robots",
}


def frame_of(name: str) -> Path:
    """Say where a preset's frame lies."""
    return FRAMES / f"{name.replace('/', '-')}.jpg"


def command_for(name: str) -> str:
    """Say which command films a preset, in a minute at most."""
    folder, _, plain = name.partition("/")
    if folder == "demo":
        return f"tiswarm demo {plain}"
    ticks = presets.load(name).world.ticks
    return f"tiswarm film {name}" + (f" --speed {ceil(ticks / LONGEST)}" if ticks > 10 * LONGEST else "")


def page() -> str:
    """Write the page. Errors: FileNotFoundError where a preset has no frame."""
    parts = [INTRODUCTION]
    above = ""
    for name, file in presets.presets().items():
        folder = name.partition("/")[0]
        if folder != above:
            parts += ["</div>\n"] * bool(above)
            parts += [f"## {TITLES.get(folder, folder.capitalize())}\n", '<div class="gallery" markdown>\n']
            above = folder
        parts.append(_entry(name, file))
    return "\n".join([*parts, "</div>\n"])


def _entry(name: str, file: Path) -> str:
    frame = frame_of(name)
    if not frame.is_file():
        raise FileNotFoundError(f"{frame}: the gallery needs a frame of {name}; run python docs/site/frames.py {name}")
    toml = file.read_text(encoding="utf-8").rstrip().replace("\n", "\n    ")
    title = presets.load(name).title
    return f"""<div markdown>
![{title}](gallery/{frame.name})
<div class="about" markdown>
### `{name}` {{ #{name.replace("/", "-")} }}

{title}

```console
{command_for(name)}
```

??? note "TOML"

    ```toml
    {toml}
    ```

</div>
</div>
"""
