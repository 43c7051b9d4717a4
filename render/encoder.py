"""The encoder: ffmpeg in a process of its own, fed by a thread, and a file that appears whole or not at all.

The only file that knows it. It comes with imageio-ffmpeg; that package's own writer takes packed RGB only, this one planar YUV.
"""

import fcntl
import os
import queue
import signal
import subprocess
import tempfile
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO

import numpy as np

from tiswarm.files import replacing

QUEUE = 4
"""Frames that may wait for the encoder; memory does not grow with a film's length."""

PIPE = 1 << 20

QUALITIES = {
    "draft": ("-preset", "ultrafast", "-crf", "26"),
    "good": ("-preset", "veryfast", "-crf", "19"),
    "best": ("-preset", "slow", "-crf", "15"),
}


class FilmError(RuntimeError):
    """A film that could not be written; the message is one line that says why."""


class Reel:
    """The way of frames to the encoder: blank buffers out, drawn ones in."""

    def __init__(self, size: tuple[int, int]):
        """Allocate the few buffers that go round."""
        self.broken = False
        self._drawn: queue.SimpleQueue[np.ndarray | None] = queue.SimpleQueue()
        self._spare: queue.SimpleQueue[np.ndarray] = queue.SimpleQueue()
        for _ in range(QUEUE):
            self._spare.put(np.zeros(size[0] * size[1] * 3 // 2, np.uint8))

    def blank(self) -> np.ndarray:
        """Take a buffer to draw in; wait for one while the encoder is behind."""
        return self._spare.get()

    def put(self, frame: np.ndarray) -> None:
        """Hand a drawn frame to the encoder."""
        if self.broken:
            raise _Stopped
        self._drawn.put(frame)

    def end(self) -> None:
        """Say that no frame follows."""
        self._drawn.put(None)

    def feed(self, pipe: IO[bytes]) -> None:
        """Write drawn frames to the encoder until the end; once it is gone, only give the buffers back."""
        if hasattr(fcntl, "F_SETPIPE_SZ"):
            with suppress(OSError):  # a larger pipe saves wake-ups, nothing more
                fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, PIPE)
        while (frame := self._drawn.get()) is not None:
            rest = memoryview(frame)
            try:
                while rest and not self.broken:
                    rest = rest[pipe.write(rest) :]
            except OSError:
                self.broken = True
            self._spare.put(frame)
        with suppress(OSError):
            pipe.close()


class _Stopped(Exception):  # noqa: N818
    """The encoder went away while frames were drawn."""


@contextmanager
def encoder(path: Path, size: tuple[int, int], fps: int, quality: tuple[str, ...], notes: dict[str, str]) -> Iterator[Reel]:
    """Run an encoder that writes `path`; nothing is left under that name unless the whole film was written."""
    with ExitStack() as stack:
        try:
            part = stack.enter_context(replacing(path))
            log = stack.enter_context(tempfile.TemporaryFile())
            # In a session of its own the encoder does not hear Ctrl-C: we end it, once, below.
            process = subprocess.Popen(
                _command(part, size, fps, quality, notes), stdin=subprocess.PIPE, stdout=log, stderr=log, bufsize=0, start_new_session=True
            )
        except OSError as error:
            raise FilmError(f"{path}: cannot be written: {error.strerror or error}") from None
        reel = Reel(size)
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


def _command(part: Path, size: tuple[int, int], fps: int, quality: tuple[str, ...], notes: dict[str, str]) -> list[str]:
    import imageio_ffmpeg

    colours = ["-color_range", "tv", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"]
    raw = ["-f", "rawvideo", "-pix_fmt", "yuv420p", *colours, "-s", f"{size[0]}x{size[1]}", "-r", str(fps), "-i", "pipe:0"]
    h264 = ["-an", "-c:v", "libx264", *quality, "-pix_fmt", "yuv420p", *colours, "-chroma_sample_location", "center"]
    tags = [word for key, value in notes.items() for word in ("-metadata", f"{key}={value}")]
    start = [imageio_ffmpeg.get_ffmpeg_exe(), "-hide_banner", "-loglevel", "error", "-nostdin", "-y"]
    return [*start, *raw, *h264, *tags, "-movflags", "+faststart", "-f", "mp4", os.fspath(part)]


def _reason(code: int, log: IO[bytes]) -> str:
    """Say why the encoder stopped: its last words, or the signal that ended it."""
    log.seek(0)
    words = log.read().decode(errors="replace").strip().splitlines()
    if code < 0:
        return f"ended by {signal.Signals(-code).name}"
    return words[-1] if words else f"exit code {code}"
