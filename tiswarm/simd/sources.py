"""Sources: the text and the syntax tree of a func, read once, however often Taichi asks for them.

Taichi asks at each call of a func, and again for each func that is built of the same code. `inspect` finds where a func ends by
taking its file apart into tokens, in Python; the func's code knows.
"""

import ast
import functools
import inspect
import linecache
from collections import defaultdict
from collections.abc import Callable
from types import CodeType
from typing import Any


def once(read: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Read what belongs to a func's code once, however many funcs are built of it."""
    known: dict[tuple[str, CodeType], Any] = {}

    @functools.wraps(read)
    def reading(func: Any) -> Any:
        code = inspect.unwrap(func).__code__
        key = code.co_filename, code  # codes of two files may be equal
        if key not in known:
            known[key] = read(func)
        return known[key]

    return reading


def lines_of(read: Callable[[Any], tuple[list[str], int]]) -> Callable[[Any], tuple[list[str], int]]:
    """Give a func's lines, and the number of the first, from what its code says of them.

    read: finds them in another way, where the code does not tell: for a func that goes on behind its last instruction (by a
    text that nobody uses, for one), or that has no file.
    """

    @functools.wraps(read)
    def reading(func: Any) -> tuple[list[str], int]:
        code = inspect.unwrap(func).__code__
        begin, end = code.co_firstlineno, _last_line(code)
        linecache.checkcache(code.co_filename)  # a module may have been changed, and loaded again
        lines = linecache.getlines(code.co_filename)
        found = lines[begin - 1 : end]
        if not any(line.lstrip().startswith("def ") for line in found):  # decorators may come first
            return read(func)
        behind = next((line for line in lines[end:] if line.strip() and not line.lstrip().startswith("#")), "")
        return read(func) if _indent(behind) > _indent(found[0]) else (found, begin)

    return reading


def _last_line(code: CodeType) -> int:
    """Give the last line of a code's instructions, 0 where it does not tell."""
    within = [_last_line(each) for each in code.co_consts if isinstance(each, CodeType)]
    return max([end or 0 for _, end, _, _ in code.co_positions()] + within)


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())


class Trees:
    """Syntax trees of sources, lent to one walk at a time: what it notes on the nodes is wiped off after it."""

    def __init__(self) -> None:
        """Begin without any."""
        self._free: dict[str, list[ast.Module]] = defaultdict(list)
        self._clean: dict[ast.Module, tuple[str, list[tuple[dict, dict]]]] = {}

    def take(self, source: str) -> ast.Module:
        """Give a tree of a source that nobody walks through."""
        if self._free[source]:
            return self._free[source].pop()
        tree = ast.parse(source)
        self._clean[tree] = source, [(vars(node), dict(vars(node))) for node in _nodes(tree)]
        return tree

    def put(self, tree: ast.Module) -> None:
        """Take a tree back, as it was."""
        if tree not in self._clean:  # parsed before there were any
            return
        source, nodes = self._clean[tree]
        for noted, clean in nodes:
            noted.clear()
            noted.update(clean)
        self._free[source].append(tree)

    def returned_by(self, walk: Callable[[ast.Module, Any], Any]) -> Callable[[ast.Module, Any], Any]:
        """Take the tree of a walk back when it ends."""

        @functools.wraps(walk)
        def walking(tree: ast.Module, context: Any) -> Any:
            try:
                return walk(tree, context)
            finally:
                self.put(tree)

        return walking


def _nodes(tree: ast.AST) -> list[ast.AST]:
    """List all nodes of a tree; as `ast.walk`, in a third of its time."""
    found = [tree]
    for node in found:
        for value in vars(node).values():
            if isinstance(value, ast.AST):
                found.append(value)
            elif isinstance(value, list):
                found.extend(each for each in value if isinstance(each, ast.AST))
    return found
