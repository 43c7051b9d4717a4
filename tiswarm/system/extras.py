"""Extras: libraries that only some users have: imported when they are needed, and named when they are missing."""

import importlib
from typing import Any


class MissingExtra(ImportError, ValueError):
    """A library that is not installed; the message is one line that names the command which installs it."""


def needed(extra: str, module: str) -> Any:
    """Import a module that an extra brings. Errors: MissingExtra."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise MissingExtra(f"{error.name or module} is not installed; pip install 'tiswarm[{extra}]'") from None
