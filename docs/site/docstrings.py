"""Docstrings: the house's form, a line for each argument and one for errors, as lists that MkDocs shows."""

import re
from typing import Any

from griffe import Extension, Object

ARGUMENT = re.compile(r"^(?:[a-z_]+(?:, [a-z_]+)*|Errors|Returns): ")


class Lists(Extension):
    """Turn lines such as `path: its suffix chooses the format` into entries of a list."""

    def on_instance(self, *, obj: Object, **_: Any) -> None:
        """Rewrite the docstring of whatever was read."""
        if obj.docstring:
            obj.docstring.value = listed(obj.docstring.value)


def listed(text: str) -> str:
    """Rewrite one docstring; its first line stays."""
    first, *others = text.split("\n")
    lines = [first]
    inside = False
    for line in others:
        if ARGUMENT.match(line):
            name, _, told = line.partition(": ")
            lines += [""] * (not inside) + [f"- **{name}**: {told}"]
            inside = True
        else:
            inside = inside and bool(line.strip())
            lines.append(f"  {line}" if inside else line)
    return "\n".join(lines)
