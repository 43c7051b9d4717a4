"""The encoder: ffmpeg in a process of its own, fed by a thread, and a file that appears whole or not at all.

The only file that knows it. It comes with imageio-ffmpeg; that package's own writer takes packed RGB only, this one planar YUV.
"""

import os
import queue
import re
import shutil
import signal
import subprocess
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import IO

import numpy as np

from render.raster.framebuffer import Framebuffer
from tiswarm.simd.threads import available_threads
from tiswarm.system.files import replacing, replacing_folder
from tiswarm.system.progress import deferring_interrupts
from tiswarm.system.words import reason, safe

PLATES = 2
"""One is drawn on while the other is written. More would help nobody, for the encoder has a queue of its own; but they would
leave the cache before it is their turn again, and differ more from what is then drawn on them."""

PIPE = 1 << 20

COLOURS = ("-color_range", "tv", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709")

QUALITIES = ("draft", "good", "best")
_H264 = (("-preset", "ultrafast", "-crf", "26"), ("-preset", "veryfast", "-crf", "19"), ("-preset", "slow", "-crf", "15"))
_VP9 = (("8", "40"), ("5", "30"), ("2", "24"))  # effort (lower is more) and constant quality
_GIF = (("1", "bayer:bayer_scale=5"), ("1", "bayer:bayer_scale=3"), ("1", "sierra2_4a"))
_PNG = ("1", "6", "9")
_WEBP = (("0", "70"), ("2", "80"), ("5", "92"))  # effort and quality
_YUVA = ("-pix_fmt", "yuva420p", "-auto-alt-ref", "0")  # frames that are not shown have no opacity

_OPAQUE = {".mp4": "keeps no opacity", ".gif": "knows no pixel that is opaque in part"}


@dataclass(frozen=True)
class Format:
    """How frames are encoded.

    yuv: they come as planar 4:2:0, which wants even edges, else as RGB. fps: the usual rate. fastest: the highest rate.
    output: the encoder's arguments. folder: what is written is a folder of images. alpha: they come with opacity.
    """

    yuv: bool
    fps: int
    fastest: int
    output: tuple[str, ...]
    folder: bool = False
    alpha: bool = False


def format_of(path: Path, quality: str, *, transparent: bool = False) -> Format:
    """Choose a format by the path's suffix: .mp4, .webm, .gif, .webp, or none for a folder of PNG images.

    Errors: ValueError for another suffix, an unknown quality, or one that keeps no opacity where that is wanted.
    """
    if quality not in QUALITIES:
        raise ValueError(f"quality: unknown {quality!r}; use one of {', '.join(QUALITIES)}")
    level, kind = QUALITIES.index(quality), path.suffix.lower()
    if transparent and kind in _OPAQUE:
        raise ValueError(f"{path}: {kind} {_OPAQUE[kind]}; use .webm, .webp, or no suffix for PNG images")
    match kind:
        case ".mp4":
            place = (
                "-pix_fmt",
                "yuv420p",
                *COLOURS,
                "-chroma_sample_location",
                "center",
                "-movflags",
                "+faststart",
                "-f",
                "mp4",
            )
            # A draft costs its encoder no more than its drawing: on two cores, more threads than one take an eighth off a film.
            threads = ("-threads", str(max(available_threads() // 2, 1))) if quality == "draft" else ()
            return Format(True, 60, 1000, ("-c:v", "libx264", *_H264[level], *threads, *place))
        case ".webm":
            effort, constant = _VP9[level]
            speed = ("-deadline", "good", "-cpu-used", effort, "-row-mt", "1", "-crf", constant, "-b:v", "0")
            coded = ("-c:v", "libvpx-vp9", *speed, *(_YUVA if transparent else ("-pix_fmt", "yuv420p")), *COLOURS, "-f", "webm")
            return Format(True, 60, 1000, coded, alpha=transparent)
        case ".gif":
            # A palette for each frame: one for all would need the whole film in memory first.
            new, dither = _GIF[level]
            palette = f"split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new={new}:dither={dither}"
            return Format(False, 25, 50, ("-filter_complex", palette, "-loop", "0", "-f", "gif"))
        case ".webp":
            # From RGB: WebP's own YUV is BT.601.
            effort, kept = _WEBP[level]
            output = ("-c:v", "libwebp_anim", "-quality", kept, "-compression_level", effort, "-pix_fmt", "bgra", "-loop", "0")
            return Format(False, 25, 100, (*output, "-f", "webp"), alpha=transparent)
        case "":
            images = ("-c:v", "png", "-compression_level", _PNG[level], "-f", "image2")
            return Format(False, 60, 1000, images, folder=True, alpha=transparent)
    raise ValueError(f"{path}: unknown format {path.suffix!r}; use .mp4, .webm, .gif, .webp, or no suffix for PNG images")


class FilmError(RuntimeError):
    """A film that could not be written; the message is one line that says why."""


class Reel:
    """The way of frames to the encoder: blank buffers out, drawn ones in."""

    def __init__(self, blank: Callable[[], Framebuffer], coded: Callable[[np.ndarray], np.ndarray]):
        """Allocate the few plates that go round. coded: makes of their bytes what the encoder takes."""
        self.broken, self._coded = False, coded
        self._drawn: queue.SimpleQueue[Framebuffer | None] = queue.SimpleQueue()
        self._spare: queue.SimpleQueue[Framebuffer] = queue.SimpleQueue()
        for _ in range(PLATES):
            self._spare.put(blank())

    def blank(self) -> Framebuffer:
        """Take a plate to draw on; wait for one while the encoder is behind."""
        calm = self._spare.empty()
        plate = self._spare.get()
        plate.calm = calm
        return plate

    def put(self, frame: Framebuffer) -> None:
        """Hand a drawn frame to the encoder."""
        if self.broken:
            raise _Stopped
        self._drawn.put(frame)

    def end(self) -> None:
        """Say that no frame follows."""
        self._drawn.put(None)

    def feed(self, pipe: IO[bytes]) -> None:
        """Write drawn frames to the encoder until the end; once it is gone, only give the buffers back."""
        with suppress(ImportError, AttributeError, OSError):  # a larger pipe saves wake-ups, nothing more
            import fcntl

            fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, PIPE)
        while (frame := self._drawn.get()) is not None:
            rest = self._coded(frame.bytes).data
            try:
                while rest and not self.broken:
                    rest = rest[pipe.write(rest) :]
            except OSError:
                self.broken = True
            self._spare.put(frame)
        with suppress(OSError):
            pipe.close()


class _Stopped(Exception):
    """The encoder went away while frames were drawn."""


@contextmanager
def encoder(
    path: Path, size: tuple[int, int], rate: Fraction, form: Format, notes: dict[str, str], blank: Callable[[], Framebuffer]
) -> Iterator[Reel]:
    """Run an encoder that writes `path`, fed with plates that `blank` allocates.

    Nothing is left under that name unless the whole film was written.

    Errors: FilmError, which gives the encoder's reason.
    """
    with ExitStack() as stack:
        try:
            part = stack.enter_context(replacing_folder(path) if form.folder else replacing(path))
            log = stack.enter_context(tempfile.TemporaryFile())
            # In a session of its own the encoder does not hear Ctrl-C: we end it, once, below.
            with deferring_interrupts():  # else nobody knew of the process, which would write on
                process = subprocess.Popen(
                    _command(_output(part, form), size, rate, form, notes),
                    stdin=subprocess.PIPE,
                    stdout=log,
                    stderr=log,
                    bufsize=0,
                    start_new_session=True,
                )
                stack.callback(_end, process)
        except OSError as error:
            raise FilmError(f"{path}: cannot be written: {reason(error)}") from None
        reel = Reel(blank, _coding(size, form))
        feeder = threading.Thread(target=reel.feed, args=(process.stdin,), name="film encoder", daemon=True)
        feeder.start()
        try:
            yield reel
        except _Stopped:
            pass
        except BaseException:
            process.kill()
            raise
        finally:
            reel.end()
            feeder.join()
            process.wait()
        if process.returncode or reel.broken:
            raise FilmError(f"{path}: the encoder failed: {_reason(process.returncode, log)}")


def _coding(size: tuple[int, int], form: Format) -> Callable[[np.ndarray], np.ndarray]:
    """Give what makes of a frame's bytes what the encoder takes."""
    if not (form.yuv and form.alpha):
        return lambda drawn: drawn
    from render.raster.planar import planar

    return partial(planar, size=size)


def _end(process: subprocess.Popen) -> None:
    """Let no encoder outlive its film: it would write on under a name that is gone."""
    if process.poll() is None:
        process.kill()
        process.wait()


def _output(part: Path, form: Format) -> str:
    """Name what ffmpeg writes: it takes what is before a colon for a protocol, and "%" in a series of images for a number."""
    return f"file:{os.fspath(part).replace('%', '%%')}/frame-%05d.png" if form.folder else f"file:{part}"


def find_ffmpeg() -> str:
    """Find the encoder. Errors: FilmError that says how to get it."""
    try:
        import imageio_ffmpeg

        found = str(imageio_ffmpeg.get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        found = ""
    if not shutil.which(found):
        where = f" at {found}" if found else ""
        raise FilmError(
            f"cannot be written: there is no ffmpeg{where}; pip install imageio-ffmpeg, or set IMAGEIO_FFMPEG_EXE to one"
        )
    return found


def version_of_ffmpeg() -> str:
    """Tell the encoder's version, or why there is none, in a line."""
    try:
        told = subprocess.run([find_ffmpeg(), "-version"], capture_output=True, text=True, check=True, timeout=10).stdout
    except (FilmError, OSError, subprocess.SubprocessError) as error:
        return f"that {error}" if isinstance(error, FilmError) else "that does not answer"
    return told.partition(" Copyright")[0].removeprefix("ffmpeg version ")


def _command(output: str, size: tuple[int, int], rate: Fraction, form: Format, notes: dict[str, str]) -> list[str]:
    kinds = ("yuva420p", "rgba") if form.alpha else ("yuv420p", "rgb24")
    pixels = ("-pix_fmt", kinds[0], *COLOURS) if form.yuv else ("-pix_fmt", kinds[1])
    raw = ("-f", "rawvideo", *pixels, "-s", f"{size[0]}x{size[1]}", "-r", str(rate), "-i", "pipe:0", "-an")
    tags = [word for key, value in notes.items() for word in ("-metadata", f"{key}={safe(value)}")]
    start = (find_ffmpeg(), "-hide_banner", "-loglevel", "error", "-nostdin", "-y")
    return [*start, *raw, *form.output, *tags, output]


def _reason(code: int, log: IO[bytes]) -> str:
    """Say why the encoder stopped: its last words, or the signal that ended it."""
    if code < 0:
        return f"it was ended by {signal.Signals(-code).name} ({signal.strsignal(-code)})"
    log.seek(0)
    words = log.read().decode(errors="replace").strip().splitlines()
    return re.sub(r"^\[.*?\] ", "", words[-1]) if words else f"exit code {code}"
