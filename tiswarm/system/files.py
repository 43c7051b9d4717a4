"""Files: written whole or not at all."""

import errno
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock

from tiswarm.system.owner import Owner

_TEMPORARY = re.compile(r"\..*\.([0-9a-f]{8})-(\d{1,9})-([0-9a-f]*)\.\w{8}\.part(\.[^.]+)?", re.DOTALL)
"""Names of temporary files and folders: whose they are."""

_asking = Lock()  # for the umask, which can only be read by setting it
_swept: set[tuple[int, Path]] = set()  # process and folder: once is enough, since only killed runs leave something behind


@contextmanager
def replacing(path: Path, durable: bool = False) -> Iterator[Path]:
    """Give a temporary path beside `path` that becomes `path` at the end, or vanishes on any error and on Ctrl-C.

    A symbolic link stays one: what it points at is replaced. What killed runs left in the folder is swept.
    durable: the file outlives a power cut that follows.

    Errors: OSError, which names `path`.
    """
    path = _beyond_links(path)
    with _named(path):
        if path.is_dir():
            raise IsADirectoryError(errno.EISDIR, "is a folder; name a file")
        descriptor, name = tempfile.mkstemp(*_temporary(path), dir=_swept_folder(path.parent))
        os.close(descriptor)
        part = Path(name)
        try:
            yield part
            part.chmod(0o666 & ~_umask())
            if durable:
                _to_disc(part)
            part.replace(path)
            if durable:
                _to_disc(path.parent)
        except BaseException:
            part.unlink(missing_ok=True)
            raise


@contextmanager
def replacing_folder(path: Path) -> Iterator[Path]:
    """Give a temporary folder beside `path` that becomes `path` at the end, or vanishes on any error.

    Errors: OSError, which names `path`; FileExistsError for a file or a folder that is not empty.
    """
    path = _beyond_links(path)
    with _named(path):
        if path.exists() and (not path.is_dir() or any(path.iterdir())):
            raise FileExistsError(errno.EEXIST, "is there already and not an empty folder")
        part = Path(tempfile.mkdtemp(*_temporary(path), dir=_swept_folder(path.parent)))
        try:
            yield part
            part.chmod(0o777 & ~_umask())
            part.replace(path)
        except BaseException:
            shutil.rmtree(part, ignore_errors=True)
            raise


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Let errors of the system name the file that was wanted, not a temporary one or none."""
    try:
        yield
    except OSError as error:
        told = error.filename
        if told is None or isinstance(told, int) or _TEMPORARY.fullmatch(Path(os.fsdecode(told)).name):
            error.filename, error.filename2 = str(path), None
        raise


def _beyond_links(path: Path) -> Path:
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def _temporary(path: Path) -> tuple[str, str]:
    """Give suffix and prefix of a temporary name beside `path`: it says whose it is, and is short even where `path` is long."""
    suffix = path.suffix if len(path.suffix) <= 16 else ""
    return f".part{suffix}", f".{path.stem[:30]}.{Owner.this().mark}."


def _swept_folder(folder: Path) -> Path:
    """Make a folder, and delete what killed runs left in it."""
    folder.mkdir(parents=True, exist_ok=True)
    key = (os.getpid(), folder.absolute())
    if key not in _swept:
        _swept.add(key)
        sweep(folder)
    return folder


def sweep(folder: Path) -> None:
    """Delete temporary files and folders whose owner is dead, and nothing else."""
    with suppress(OSError):
        for place in folder.glob(".*.part*"):
            found = _TEMPORARY.fullmatch(place.name)
            if found and not Owner(found[1], int(found[2]), found[3]).lives:
                if place.is_dir() and not place.is_symlink():
                    shutil.rmtree(place, ignore_errors=True)
                else:
                    place.unlink(missing_ok=True)


def _to_disc(path: Path) -> None:
    """Wait until a file, or a folder's list of files, is on the disc; some systems have no such thing for folders."""
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except PermissionError:
        return
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.EBADF, errno.ENOTSUP):
            raise
    finally:
        os.close(descriptor)


def write_text(path: Path, text: str) -> None:
    """Write a file of text whole or not at all."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")


def read_bounded(path: Path, most: int) -> bytes:
    """Read a file that comes from outside. Errors: ValueError for more than `most` bytes; OSError."""
    with path.open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"is larger than {most:,} bytes")
    return content


def check_writable(folder: Path) -> None:
    """Raise OSError unless files can be written into a folder, which need not be there yet."""
    nearest = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not nearest.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "is a file where a folder must be", str(nearest))
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise PermissionError(errno.EACCES, "cannot be written into", str(nearest))


def _umask() -> int:
    with _asking:
        mask = os.umask(0)
        os.umask(mask)
    return mask
