"""Kernel cache: a folder for compiled kernels that can be written into; Taichi ends the process where it cannot."""

import os
import tempfile
from pathlib import Path

FOLDER = "TI_OFFLINE_CACHE_FILE_PATH"
"""What users name a folder of their own by, in the environment."""


def ensure_home() -> None:
    """Give the environment a HOME where it has none: Taichi ends the process on being imported without it."""
    if not os.environ.get("HOME"):
        try:
            os.environ["HOME"] = str(Path.home())
        except RuntimeError:  # the system knows no home of this user either
            os.environ["HOME"] = str(_temporary() or Path(os.sep))


def choose() -> tuple[str, bool, str]:
    """Choose where compiled kernels are kept.

    Returns the folder, whether kernels are kept there, and a line that says so where it is not the folder asked for.
    """
    wanted = Path(os.environ.get(FOLDER) or Path(os.environ.get("HOME") or os.sep, ".cache", "taichi", "ticache"))
    complaint = _complaint(wanted)
    if complaint is None:
        return str(wanted), True, ""
    told = f"the folder for compiled kernels, {wanted}, cannot be written into ({complaint})"
    temporary = _temporary()
    if temporary is not None:
        other = temporary / f"tiswarm-kernels-{os.getuid() if hasattr(os, 'getuid') else 'own'}"
        if _complaint(other) is None and _ours(other):
            return str(other), True, f"{told}; {other} is used; set {FOLDER} to another"
    return os.sep, False, f"{told}; kernels are compiled anew in every process; set {FOLDER} to another"


def _complaint(folder: Path) -> str | None:
    """Say why no file can be written into a folder, None where one can; it is made where it is not there."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(b"0")
    except OSError as error:
        return error.strerror or str(error)
    return None


def _ours(folder: Path) -> bool:
    """Tell whether a folder is ours alone: compiled code of strangers must not be run."""
    about = folder.lstat()
    return not hasattr(os, "getuid") or (about.st_uid == os.getuid() and not about.st_mode & 0o022)


def _temporary() -> Path | None:
    try:
        return Path(tempfile.gettempdir())
    except OSError:
        return None
