"""Declared: what a class says of its numbers in the comments beside them: words and a unit."""

import inspect
import io
import re
import textwrap
import tokenize
from dataclasses import dataclass
from functools import cache

_UNIT = re.compile(r"\s*\[([^\]]+)\]")
_BARE = re.compile(r"((?:rad/s|m/s|m|s))(?:, (.*))?$")


@dataclass(frozen=True)
class Declared:
    """What is said of a number: words and unit, each empty where nothing is said."""

    words: str = ""
    unit: str = ""


def declared(owner: type) -> dict[str, Declared]:
    """Read the comments beside a class's annotated names, and those of its bases where it says nothing itself.

    A comment is "strength [m²/s]", or begins with a bare unit: "m, closer mates are separated from".
    """
    found: dict[str, Declared] = {}
    for cls in reversed(owner.__mro__):
        if cls.__module__ != "builtins" and "__annotations__" in vars(cls):
            found |= {name: _split(comment) for name, comment in _comments(cls).items()}
    return found


@cache
def _comments(cls: type) -> dict[str, str]:
    """Find the comment on the line of each annotated name."""
    try:
        source = textwrap.dedent(inspect.getsource(cls))
    except (OSError, TypeError):  # made without a file
        return {}
    found, lines = {}, source.splitlines()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            name = re.match(r"\s*(\w+):", lines[token.start[0] - 1])
            if name and name[1] in vars(cls)["__annotations__"]:
                found[name[1]] = token.string.lstrip("# ")
    return found


def _split(comment: str) -> Declared:
    """Part a comment into words and unit."""
    bare = _BARE.match(comment)
    if bare:
        return Declared(bare[2] or "", bare[1])
    unit = _UNIT.search(comment)
    return Declared(" ".join(_UNIT.sub("", comment, count=1).split()), unit[1] if unit else "")
