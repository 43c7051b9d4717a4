"""Owner: which run of a program holds a file or a folder, and whether it still lives."""

import json
import os
import platform
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import IO

from tiswarm.system.progress import begin_work

LOCK = ".lock"

_held: dict[Path, int] = {}  # folder -> thread that holds it: a run may lock what it holds once more


@dataclass(frozen=True)
class Owner:
    """A process on one machine: its number alone would not do, since numbers are given out again.

    machine: a short hash of the machine's name and identity; started: when the process began, counted from the machine's own
    start, with a hash of that; empty where the system does not tell.
    """

    machine: str
    pid: int
    started: str

    @classmethod
    def this(cls) -> "Owner":
        """Name the process that asks."""
        return cls(_machine(), os.getpid(), _started(os.getpid()))

    @property
    def mark(self) -> str:
        """Write the owner so that it can be a part of a file's name."""
        return f"{self.machine}-{self.pid}-{self.started}"

    @property
    def is_here(self) -> bool:
        """Tell whether it runs, or ran, on this machine: of others nothing can be known."""
        return self.machine == _machine()

    @property
    def lives(self) -> bool:
        """Tell whether it still runs, as far as can be known from here; in doubt it does."""
        if not self.is_here:
            return True
        if self.started:
            return _started(self.pid) == self.started
        with suppress(ProcessLookupError, OverflowError):
            if os.name == "posix":  # elsewhere the signal 0 would be one
                with suppress(PermissionError):
                    os.kill(self.pid, 0)
            return True
        return False


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder until the end, so that no second run writes into it; what a dead run held is taken over.

    A folder that was made for it and stays empty goes again.

    Errors: ValueError that says who holds it; OSError when the folder cannot be written.
    """
    key = Path(os.path.realpath(folder))
    if _held.get(key) == threading.get_ident():
        yield
        return
    begin_work()
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    place = folder / LOCK
    _take(place)
    _held[key] = threading.get_ident()
    try:
        yield
    finally:
        del _held[key]
        with _alone(place) as file:
            if _read(file) == Owner.this():
                place.unlink(missing_ok=True)
        with suppress(OSError):
            for path in made:
                path.rmdir()


def _take(place: Path) -> None:
    """Write into a lock file who holds it from now on. Errors: ValueError when somebody does who lives."""
    with _alone(place) as file:
        holder = _read(file)
        if holder is not None and holder.lives:
            where = "" if holder.is_here else f" on another machine ({holder.machine}; if it is over, delete {place})"
            raise ValueError(
                f"{place.parent}: process {holder.pid}{where} is writing into this folder; wait for it, or name another with -o"
            )
        file.seek(0)
        file.truncate()
        file.write(json.dumps(asdict(Owner.this())))
        file.flush()


@contextmanager
def _alone(place: Path) -> Iterator[IO[str]]:
    """Open a lock file while nobody else reads or writes it, where the system can hold others off."""
    while True:
        file = os.fdopen(os.open(place, os.O_RDWR | os.O_CREAT, 0o666), "r+", encoding="utf-8", errors="replace")
        with file:
            with suppress(ImportError, OSError):  # some systems and network folders have no such locks
                import fcntl

                fcntl.flock(file, fcntl.LOCK_EX)
            if _is_at(file, place):  # else its holder deleted it meanwhile
                yield file
                return


def _is_at(file: IO[str], place: Path) -> bool:
    try:
        return place.stat().st_ino == os.fstat(file.fileno()).st_ino
    except FileNotFoundError:
        return False


def _read(file: IO[str]) -> Owner | None:
    """Read who holds a lock; a file that says nothing sensible is held by nobody."""
    try:
        told = json.loads(file.read(1000))
        owner = Owner(str(told["machine"]), int(told["pid"]), str(told["started"]))
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
        return None
    return owner if owner.pid > 0 else None


@cache
def _machine() -> str:
    name = platform.node()
    with suppress(OSError):
        name += Path("/etc/machine-id").read_text(encoding="ascii", errors="replace")
    return sha256(name.encode(errors="replace")).hexdigest()[:8]


def _started(pid: int) -> str:
    """Tell when a process began, "" for one that is not there or where the system does not tell."""
    try:
        told = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
    except OSError:
        return ""
    return f"{_boot()}{int(told[19]):x}" if told[0] not in "ZX" else ""  # a zombie has ended


@cache
def _boot() -> str:
    try:
        return sha256(Path("/proc/sys/kernel/random/boot_id").read_bytes()).hexdigest()[:6]
    except OSError:
        return ""
