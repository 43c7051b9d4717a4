"""Worker: another process, with a Taichi of its own, that never keeps the server waiting: what it says is heard by a thread."""

import multiprocessing
import queue
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

Message = tuple[Any, ...]

LAST = 1.5
"""Seconds that a process has to end by itself."""


@dataclass(frozen=True)
class Settings:
    """What a process that computes is started with, as in `tiswarm.init`. strategy_path: folders with a user's strategies."""

    precision: str = "f32"
    threads: int | None = None
    strategy_path: tuple[Path, ...] = ()

    def begin(self) -> None:
        """Start Taichi in a process."""
        import tiswarm

        for folder in self.strategy_path:
            tiswarm.add_path(folder)
        tiswarm.init(self.precision, self.threads)  # type: ignore[arg-type]


class Worker:
    """A process, what is said to it, and what it says."""

    def __init__(
        self, target: Callable[..., None], arguments: Sequence[Any], heard: Callable[["Worker", Message], None]
    ) -> None:
        """Start target(pipe, *arguments) in a process. heard: called in a thread; ("gone",) is the last that it hears."""
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._words: queue.SimpleQueue[Message | None] = queue.SimpleQueue()
        self._process = context.Process(target=_guarded, args=(target, theirs, *arguments), daemon=True)
        with _deaf():
            self._process.start()
        theirs.close()
        self._heard = heard
        self._closed = False
        for loop in (self._listen, self._speak):
            threading.Thread(target=loop, daemon=True).start()

    def send(self, *message: Any) -> None:
        """Say something, without waiting for it to be read."""
        self._words.put(message)

    def end(self) -> None:
        """Ask the process to end, without waiting for it."""
        self._closed = True
        self._words.put(None)

    def leave(self) -> None:
        """End the process while others go on."""
        self.end()
        threading.Thread(target=self.close, daemon=True).start()

    def close(self) -> None:
        """End the process, and wait until it has."""
        self.end()
        self._process.join(LAST)
        if self._process.is_alive():  # it compiles, which nothing interrupts
            self._process.kill()
            self._process.join(LAST)

    def _listen(self) -> None:
        with suppress(EOFError, OSError):
            while not self._closed:
                self._heard(self, self._pipe.recv())
        if not self._closed:
            self._heard(self, ("gone",))

    def _speak(self) -> None:
        with suppress(OSError):
            while (message := self._words.get()) is not None:
                self._pipe.send(message)
            self._pipe.send(("end",))


@contextmanager
def _deaf() -> Iterator[None]:
    """Let a process that is started in here never hear Ctrl-C, which is for this one: its end closes the pipe."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


Hear = Callable[[Worker, Message], None]


def _guarded(target: Callable[..., None], pipe: Connection, *arguments: Any) -> None:
    """Run a process until the other side is gone; tell in one line what ends it before."""
    try:
        target(pipe, *arguments)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        pass
    except Exception as error:  # a strategy of the user's that does not compile, memory, ...
        lines = str(error).strip().splitlines() or [type(error).__name__]
        with suppress(OSError):
            pipe.send(("failed", lines[0] if isinstance(error, ValueError | OSError) else lines[-1]))
