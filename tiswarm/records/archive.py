"""Archive: arrays in an .npz file from outside, read without trusting it: headers first, bounded, no pickles, no code."""

import re
import sys
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from math import prod
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

MOST_BYTES = 1 << 32
"""Most that a file, or all arrays of one, may take."""

MOST_ARRAYS = 256
MOST_AXES = 4

_INFLATED = 1032
"""Deflate makes at most so many bytes out of one."""

_HEADER = re.compile(r"\{'descr': '([<|][bifuU]\d{1,6})', 'fortran_order': (False|True), 'shape': \(([\d, ]*)\), \} *\n")
"""What NumPy writes before the numbers of an array: nothing else is read, least of all evaluated."""


class DamagedArchive(ValueError):
    """A file that holds no arrays that can be read; the message says why."""


@dataclass(frozen=True)
class Header:
    """What an array will be: its type, its shape, and whether columns come first."""

    dtype: np.dtype
    shape: tuple[int, ...]
    fortran: bool
    length: int  # of what stands before the numbers [bytes]

    @property
    def nbytes(self) -> int:
        """Count the bytes of its numbers."""
        return prod(self.shape) * self.dtype.itemsize


class Archive:
    """An .npz file, opened: `headers` says what it announces, before any of it is inflated.

    Errors: DamagedArchive for whatever is wrong with the file; OSError when there is none.
    """

    headers: dict[str, Header]

    def __init__(self, path: Path, most: int = MOST_BYTES) -> None:
        """Open a file and check what it announces against its size; most: bytes of all its arrays."""
        self._file = path.open("rb")
        try:
            self._open(path.stat().st_size, most)
        except BaseException:
            self._file.close()
            raise

    def _open(self, size: int, most: int) -> None:
        if size > most:
            raise DamagedArchive(f"is larger than {most:,} bytes")
        try:
            self._zip = zipfile.ZipFile(self._file)
            infos = self._zip.infolist()
            if len(infos) > MOST_ARRAYS or len({info.filename for info in infos}) < len(infos):
                raise DamagedArchive("holds too many arrays, or one twice")
            self.headers = {info.filename.removesuffix(".npy"): self._header(info) for info in infos}
        except DamagedArchive:
            raise
        except Exception as error:  # whatever zipfile raises, from KeyError to NotImplementedError, for a damaged file
            raise DamagedArchive(_reason(error)) from None
        announced = sum(header.nbytes for header in self.headers.values())
        if announced > most or sum(info.compress_size for info in infos) > size:
            raise DamagedArchive(f"announces {announced:,} bytes, more than it can hold")

    def _header(self, info: zipfile.ZipInfo) -> Header:
        if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise DamagedArchive("is compressed in a way that NumPy does not use")
        with self._zip.open(info) as file:
            start = file.read(10)
            if start[:8] != b"\x93NUMPY\x01\x00":
                raise DamagedArchive(f"{info.filename} is no array")
            length = int.from_bytes(start[8:], "little")
            found = _HEADER.fullmatch(file.read(length).decode("latin-1"))
        if found is None:
            raise DamagedArchive(f"{info.filename} has a header that NumPy does not write")
        shape = tuple(int(each) for each in found[3].split(",") if each.strip())
        header = Header(np.dtype(found[1]), shape, found[2] == "True", 10 + length)
        packed = info.compress_size if info.compress_type == zipfile.ZIP_STORED else info.compress_size * _INFLATED
        if header.dtype.itemsize == 0 or len(shape) > MOST_AXES:
            raise DamagedArchive(f"{info.filename} has a shape that no array of ours has")
        if header.length + header.nbytes != info.file_size or info.file_size > packed + _INFLATED:
            raise DamagedArchive(f"{info.filename} is not as large as it says")
        return header

    def read(self, name: str) -> np.ndarray:
        """Read one array, as large as its header says and not a byte more. Errors: DamagedArchive."""
        header = self.headers.get(name)
        if header is None:
            raise DamagedArchive(f"{name} is missing")
        try:
            with self._zip.open(f"{name}.npy") as file:
                content = file.read(header.length + header.nbytes)
                if file.read(1) or len(content) != header.length + header.nbytes:
                    raise DamagedArchive(f"{name} is not as large as it says")
        except (DamagedArchive, MemoryError):
            raise
        except Exception as error:  # as above
            raise DamagedArchive(_reason(error)) from None
        flat = np.frombuffer(content[header.length :], header.dtype) if header.nbytes else np.empty(0, header.dtype)
        if header.dtype.kind == "U" and flat.view(np.uint32).max(initial=0) > sys.maxunicode:
            raise DamagedArchive(f"{name} holds numbers that are no characters")
        return flat.reshape(header.shape, order="F" if header.fortran else "C").copy(order="C")

    def text(self, name: str, most: int) -> str:
        """Read one text of at most so many characters. Errors: DamagedArchive."""
        header = self.headers.get(name)
        if header is None or header.dtype.kind != "U" or header.shape or header.dtype.itemsize > 4 * most:
            raise DamagedArchive(f"{name} is no text")
        return str(self.read(name))

    def number(self, name: str) -> int:
        """Read one whole number. Errors: DamagedArchive."""
        header = self.headers.get(name)
        if header is None or header.dtype.kind not in "iu" or header.shape:
            raise DamagedArchive(f"{name} is no whole number")
        return int(self.read(name))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._file.close()


def digest(arrays: Mapping[str, np.ndarray]) -> str:
    """Name arrays by what they hold: their names, types, shapes and numbers."""
    found = sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        found.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        found.update(array.tobytes())
    return found.hexdigest()


def _reason(error: Any) -> str:
    return " ".join(str(error).split()) or type(error).__name__
