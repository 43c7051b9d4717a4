"""Described: what a key of a preset is, as the comment beside it in the source says, for the schema and the reference."""

import ast
import inspect
import io
import textwrap
import tokenize
from functools import cache
from typing import Any


@cache
def comments(table: type[Any]) -> dict[str, str]:
    """Map the keys that a table states itself to their comments: beside them, or else in the lines right above them."""
    source = textwrap.dedent(inspect.getsource(table))
    beside, above = _comments_of(source)
    found = {}
    for node in ast.parse(source).body[0].body:  # type: ignore[attr-defined]
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            assert node.end_lineno is not None
            told = beside.get(node.end_lineno) or _block_above(above, node.lineno)
            if told:
                found[node.target.id] = told
    return found


def _comments_of(source: str) -> tuple[dict[int, str], dict[int, str]]:
    """Map lines to the comments that stand beside code, and to those that have a line of their own."""
    beside: dict[int, str] = {}
    above: dict[int, str] = {}
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            alone = not token.line[: token.start[1]].strip()
            (above if alone else beside)[token.start[0]] = token.string.lstrip("# ")
    return beside, above


def _block_above(above: dict[int, str], line: int) -> str:
    lines: list[str] = []
    while (line := line - 1) in above:
        lines.insert(0, above[line])
    return " ".join(lines)


def description(table: type[Any], key: str) -> str:
    """Say what a key is, nothing where no comment does: a table's own comment goes before that of a table it extends."""
    return next(
        (told for each in table.__mro__ if key in vars(each).get("__annotations__", {}) and (told := comments(each).get(key))),
        "",
    )
