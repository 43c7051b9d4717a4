"""Tracing: how Taichi reads the source of a kernel, without the work that it does twice or for nobody.

Taichi 1.7.4 walks the syntax tree of a kernel, and of every func at each of its calls, in Python; also when the compiled
kernel lies in the cache, since only the walk tells which kernel it is. Half of that time went into a drawing for each node, its
line with carets below, that is only shown when an error comes; a tenth each into reading the same files again, into laying
out the same lines again, and into parsing them. And each decorator looked, through all modules that there are, for the line of
source at which its caller stands, only to find out whether that is a class: a twentieth of a whole run of a second.

What the walk leaves is compiled in a time that grows with the square of its assignments: each is looked for in all statements
around it. Taichi makes two of every one, since `a = b = c` is allowed.
"""

import ast
import functools
import importlib.abc
import importlib.util
import inspect
import sys
import textwrap
from collections import defaultdict
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from types import CodeType, ModuleType, SimpleNamespace
from typing import Any

from tiswarm.simd import ranges

READER = "taichi.lang.kernel_impl"
"""The module that decorates funcs and reads their source."""


def watch() -> None:
    """Lighten Taichi as soon as somebody imports it, before anything is decorated."""
    if READER in sys.modules:
        _lighten(sys.modules[READER])
    elif not any(isinstance(each, _Watch) for each in sys.meta_path):
        sys.meta_path.insert(0, _Watch())


class _Watch(importlib.abc.MetaPathFinder):
    """Waits for READER."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,  # noqa: ARG002 - as Python calls it
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        """Let READER be lightened when it has run; all else is for others."""
        if fullname != READER:
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(fullname)
        if spec is not None and spec.loader is not None:
            run = spec.loader.exec_module

            def running(module: ModuleType) -> None:
                run(module)
                _lighten(module)

            spec.loader.exec_module = running  # type: ignore[method-assign]
        return spec


def _lighten(kernel_impl: Any) -> None:
    """Let Taichi name a place by file, line and func, read and parse each func's source once, and copy a value once.

    And let it see a class without its source, and step through ranges as ranges.py does. Twice does nothing more.
    """
    from taichi.lang.ast.ast_transformer import ASTTransformer
    from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext

    if ASTTransformerContext.get_pos_info is _spot:
        return
    ASTTransformerContext.get_pos_info = _spot
    kernel_impl._inside_class = _inside_class
    for name in ("getsourcelines", "getsourcefile"):
        if hasattr(kernel_impl, name):
            setattr(kernel_impl, name, _once(getattr(kernel_impl, name)))
    if getattr(kernel_impl, "textwrap", None) is textwrap:
        kernel_impl.textwrap = SimpleNamespace(fill=functools.cache(textwrap.fill), dedent=functools.cache(textwrap.dedent))
    if getattr(kernel_impl, "ast", None) is ast and hasattr(kernel_impl, "transform_tree"):
        trees = Trees()
        kernel_impl.ast = SimpleNamespace(parse=trees.take)
        kernel_impl.transform_tree = trees.returned_by(kernel_impl.transform_tree)
    ASTTransformer.build_Assign = staticmethod(_assigning(ASTTransformer.build_Assign))
    ASTTransformer.build_range_for = staticmethod(ranges.opaque(ASTTransformer.build_range_for))


def _spot(context: Any, node: Any) -> str:
    """Name the place of a node in the source, with its first line."""
    spots = context.__dict__.setdefault("_spots", {})
    spot = spots.get(node.lineno)
    if spot is None:
        line = context.src[node.lineno - 1].strip()
        where = f'File "{context.file}", line {node.lineno + context.lineno_offset}'
        spot = spots[node.lineno] = f"{where}, in {context.func.func.__name__}:\n{line}\n"
    return spot


def _inside_class(level_of_class_stackframe: int) -> bool:
    """Tell whether a decorator is at work in a class. level_of_class_stackframe: of the frame in which the class stands."""
    body = sys._getframe(level_of_class_stackframe - 1)
    return "__qualname__" in body.f_locals and not body.f_code.co_flags & inspect.CO_NEWLOCALS


def _once(read: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Read the source of a func's code once, however many funcs are built of it."""
    known: dict[tuple[str, CodeType], Any] = {}

    @functools.wraps(read)
    def reading(func: Any) -> Any:
        code = inspect.unwrap(func).__code__
        key = code.co_filename, code  # codes of two files may be equal
        if key not in known:
            known[key] = read(func)
        return known[key]

    return reading


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
        self._clean[tree] = source, [(vars(node), dict(vars(node))) for node in ast.walk(tree)]
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


def _assigning(original: Callable[[Any, Any], None]) -> Callable[[Any, Any], None]:
    """Copy what is assigned once, where one name, or a place that no call has to find, is assigned to."""
    from taichi.lang import impl
    from taichi.lang.ast.ast_transformer import ASTTransformer, build_stmt

    def assign(context: Any, node: ast.Assign) -> None:
        target = node.targets[0]
        if len(node.targets) > 1 or not _plain(target):
            original(context, node)
            return
        build_stmt(context, node.value)
        static = isinstance(node.value, ast.Call) and node.value.func.ptr is impl.static  # type: ignore[attr-defined]
        ASTTransformer.build_assign_basic(context, target, node.value.ptr, static)  # type: ignore[attr-defined]

    return assign


def _plain(target: ast.expr) -> bool:
    """Tell whether to find a place changes nothing: a value is worked out after it then."""
    if isinstance(target, ast.Name):
        return True
    calls = any(isinstance(each, ast.Call) for each in ast.walk(target))
    return isinstance(target, ast.Subscript | ast.Attribute) and not calls
