"""Films, frames, posters and contact sheets of recordings."""

import base64
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from render.composition import Composition, Subject
from render.encoder import FilmError, Format, encoder, find_ffmpeg, format_of
from render.loop import drawn, faded
from render.scene.background import Field
from render.style import look_of
from render.timeline import Rate
from tiswarm.system.files import replacing
from tiswarm.system.words import reason
from tiswarm.version import __version__

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Film(os.PathLike):
    """A film that was written: its path, frame size [px], rate [1/s] and number of frames. A notebook shows it inline."""

    path: Path
    size: tuple[int, int]
    fps: Rate
    frames: int

    def __fspath__(self) -> str:
        return os.fspath(self.path)

    def _repr_html_(self) -> str:
        kind = {".webm": "video/webm", ".gif": "image/gif", ".webp": "image/webp"}.get(self.path.suffix.lower(), "video/mp4")
        if not self.path.is_file():
            return f"<code>{self.path}</code>"
        source = f"data:{kind};base64,{base64.b64encode(self.path.read_bytes()).decode()}"
        if kind.startswith("image"):
            return f'<img src="{source}" width="{self.size[0]}">'
        return f'<video src="{source}" width="{self.size[0]}" style="max-width:100%" controls loop></video>'


def film(
    subject: Subject,
    path: str | os.PathLike,
    size: tuple[int, int] = (1280, 720),
    fps: Rate | None = None,
    *,
    quality: str = "good",
    labels: Sequence[str] | None = None,
    field: Field | None = None,
    progress: Progress | None = None,
    **look: Any,
) -> Film:
    """Film a recording or a live simulation, or several side by side.

    A live simulation (see `render.live.Live`) runs while it is filmed and is not kept: memory does not grow with its length.

    path: its suffix chooses the format: .mp4 (H.264), .webm (VP9), .gif, .webp, or none for a folder of PNG frames.
    size: width and height [px], both even for video. fps: frames per second, by default 60, or 25 in a GIF or WebP;
    29.97 and Fraction(30000, 1001) are possible.
    quality: "draft", "good" or "best".
    labels: names of several recordings, by default what tells them apart. field: arrows to draw on the ground.
    progress: called with frames done and frames in all.
    look: theme, speed, trail, camera, overlay, slow, chart, story, cards, loop, transparent: see Look.

    Errors: ValueError or TypeError for a choice that is not possible; FilmError when the film cannot be written, and then
    no file is left.
    """
    target, style = Path(path), look_of(look)
    form, rate = check_film(target, size, fps, quality, transparent=style.transparent)
    stage = Composition(subject, size, style, yuv=form.yuv, labels=labels, field=field)
    done, total = 0, stage.length(rate) - (faded(stage, rate) if stage.look.loop else 0)
    with encoder(target, size, rate, form, notes(stage), stage.canvas.blank) as reel:
        for plate in drawn(stage, rate, reel.blank):
            reel.put(plate)
            done += 1
            if progress:
                progress(done, total)
    return Film(target, size, int(rate) if rate.denominator == 1 else rate, done)


def check_film(
    path: Path, size: tuple[int, int], fps: Rate | None = None, quality: str = "good", *, transparent: bool = False
) -> tuple[Format, Fraction]:
    """Check what can be known of a film before anything runs: give its format and its frames per second.

    Errors: as `film`.
    """
    form = format_of(path, quality, transparent=transparent)
    try:
        rate = Fraction(form.fps if fps is None else fps).limit_denominator(100_000)
    except (ValueError, OverflowError):
        rate = Fraction(0)
    if not 1 <= rate <= form.fastest:
        raise ValueError(f"fps: {fps} is not possible; use 1 to {form.fastest}")
    checked_size(size, even=form.yuv)
    find_ffmpeg()
    return form, rate


def check_image(path: Path, *, transparent: bool = False) -> None:
    """Raise ValueError unless an image, or a transparent one, can be written in the format that the path's suffix names."""
    from PIL import Image

    Image.init()
    known = {suffix for suffix, form in Image.registered_extensions().items() if form in Image.SAVE}
    if path.suffix.lower() not in known:
        raise ValueError(f"{path}: unknown format {path.suffix!r}; use .png, .jpg or .webp")
    if transparent and path.suffix.lower() not in (".png", ".webp"):
        raise ValueError(f"{path}: no transparent picture is written as {path.suffix}; use .png or .webp")


def frames(
    subject: Subject,
    size: tuple[int, int] = (1280, 720),
    fps: Rate = 60,
    *,
    labels: Sequence[str] | None = None,
    field: Field | None = None,
    **look: Any,
) -> Iterator[np.ndarray]:
    """Yield a film's frames, one after the other: [y, x, channel] of uint8, each an array of its own.

    A transparent look has four channels: red, green, blue, not multiplied by the fourth, opacity.

    Errors: ValueError or TypeError for a choice that is not possible, at once.
    """
    checked_size(size, even=False)
    stage = Composition(subject, size, look_of(look), yuv=False, labels=labels, field=field)
    return (plate.bytes.reshape(size[1], size[0], -1) for plate in drawn(stage, fps, stage.canvas.blank))


def poster(
    subject: Subject,
    path: str | os.PathLike,
    size: tuple[int, int] = (1280, 720),
    *,
    time: float | None = None,
    labels: Sequence[str] | None = None,
    field: Field | None = None,
    **look: Any,
) -> Path:
    """Write one frame as an image; the path's suffix chooses the format. time [ticks]: by default a recording's liveliest.

    Errors: as `film`.
    """
    style = look_of(look)
    check_image(Path(path), transparent=style.transparent)
    checked_size(size, even=False)
    stage = Composition(subject, size, style, yuv=False, labels=labels, field=field)
    if time is None and stage.is_live:
        raise ValueError("time: say at which tick; a live simulation does not know its liveliest moment beforehand")
    return _save(_image(stage, liveliest(stage) if time is None else time, size), Path(path))


def still(subject: Subject, size: tuple[int, int] = (1280, 720), *, time: float, **look: Any) -> np.ndarray:
    """Give one frame at a time [ticks]: [y, x, channel] of uint8, as `frames` does. Errors: as `frames`."""
    checked_size(size, even=False)
    return _image(Composition(subject, size, look_of(look), yuv=False, labels=None, field=None), time, size)


def sheet(
    subject: Subject,
    path: str | os.PathLike,
    size: tuple[int, int] = (640, 360),
    *,
    shape: tuple[int, int] = (3, 4),
    labels: Sequence[str] | None = None,
    field: Field | None = None,
    **look: Any,
) -> Path:
    """Write a contact sheet: `shape` = columns and rows of frames of `size`, evenly spread from the first to the last tick.

    Errors: as `film`.
    """
    style = look_of(look)
    check_image(Path(path), transparent=style.transparent)
    checked_size(size, even=False)
    columns, rows = shape
    if columns < 1 or rows < 1:
        raise ValueError(f"shape: {columns}x{rows} is not possible; use 1 or more columns and rows")
    stage = Composition(subject, size, style, yuv=False, labels=labels, field=field)
    last = stage.scene.paths.last
    gap = max(min(size) // 40, 2)
    paper = np.zeros((rows * (size[1] + gap) + gap, columns * (size[0] + gap) + gap, 4 if style.transparent else 3), np.uint8)
    if not style.transparent:
        paper[:] = [int(stage.scene.theme.line[n : n + 2], 16) // 4 for n in (1, 3, 5)]
    for n, time in enumerate(np.linspace(0, last, columns * rows)):
        top, left = gap + n // columns * (size[1] + gap), gap + n % columns * (size[0] + gap)
        paper[top : top + size[1], left : left + size[0]] = _image(stage, float(time), size)
    return _save(paper, Path(path))


def liveliest(stage: Composition) -> float:
    """Find the time [ticks] at which most has happened lately while most agents are still there."""
    paths = stage.scene.paths
    paths.reach(paths.last)  # from there all ends are known
    moments = np.arange(paths.last + 1)
    scores = 0.01 * np.sin(np.pi * moments / max(paths.last, 1))  # where nothing ever happens, the middle
    for scene in range(len(stage.boxes)):
        mine = paths.scene == scene
        since = moments[:, None] - paths.end[mine]
        events = ((since >= 0) * np.exp(-np.maximum(since, 0) / 6) * np.where(paths.is_prey[mine], 2.0, 0.7)).sum(axis=1)
        scores += (0.2 + events) * (since < 0).mean(axis=1)
    return float(moments[scores.argmax()]) + 0.5


def checked_size(size: tuple[int, int], *, even: bool) -> None:
    """Raise ValueError unless frames can have this size, naming the nearest that they can have."""
    if min(size) < 16 or max(size) > 16384:
        raise ValueError(f"size: {size[0]}x{size[1]} is not possible; use 16 to 16384 pixels each way")
    if even and any(edge % 2 for edge in size):
        near = "x".join(str(edge + edge % 2) for edge in size)
        raise ValueError(f"size: {size[0]}x{size[1]} has an odd edge, which video cannot have; use {near}")


def _image(stage: Composition, time: float, size: tuple[int, int]) -> np.ndarray:
    return stage.frame(time, stage.canvas.blank()).reshape(size[1], size[0], -1)


def _save(image: np.ndarray, path: Path) -> Path:
    from PIL import Image

    try:
        with replacing(path) as part:
            Image.fromarray(image).save(part)
    except OSError as error:
        raise FilmError(f"{path}: cannot be written: {reason(error)}") from None
    return path


def notes(stage: Composition) -> dict[str, str]:
    """Say in the film's metadata where it comes from."""
    recordings = stage.scene.subjects
    first = recordings[0]
    parts = {
        "preset": ", ".join(dict.fromkeys(each.scenario.preset or "none" for each in recordings)),
        "trials": ", ".join(f"trial {each.trial} of seed {each.seed}" for each in recordings),
        "prey": ", ".join(dict.fromkeys(each.scenario.prey.strategy for each in recordings)),
        "scenario": ", ".join(dict.fromkeys(each.scenario.hash() for each in recordings)),
        "tiswarm": __version__,
    }
    return {
        "title": first.scenario.title,
        "comment": "; ".join(f"{name}: {value}" for name, value in parts.items()),
        "artist": "tiswarm",
    }
