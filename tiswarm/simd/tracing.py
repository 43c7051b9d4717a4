"""Tracing: how Taichi reads the source of a kernel, without the work that it does twice or for nobody.

Taichi 1.7.4 walks the syntax tree of a kernel, and of every func at each of its calls, in Python; also when the compiled
kernel lies in the cache, since only the walk tells which kernel it is. Half of that time went into a drawing for each node, its
line with carets below, that is only shown when an error comes; a tenth each into reading the same files again, into laying
out the same lines again, and into parsing them. And each decorator looked, through all modules that there are, for the line of
source at which its caller stands, only to find out whether that is a class: a twentieth of a whole run of a second.
What was left of the walk went, by an eighth each, into looking for garbage and into finding what builds which kind of node.

What the walk leaves is compiled in a time that grows with the square of its assignments: each is looked for in all statements
around it. Taichi makes two of every one, since `a = b = c` is allowed.
"""

import ast
import functools
import gc
import importlib.abc
import importlib.util
import inspect
import sys
import textwrap
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType, SimpleNamespace
from typing import Any

from tiswarm.simd import ranges, sources

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
    from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext, Builder

    if ASTTransformerContext.get_pos_info is _spot:
        return
    ASTTransformerContext.get_pos_info = _spot
    kernel_impl._inside_class = _inside_class
    for name in ("getsourcelines", "getsourcefile"):
        if hasattr(kernel_impl, name):
            read = getattr(kernel_impl, name)
            setattr(kernel_impl, name, sources.once(sources.lines_of(read) if name == "getsourcelines" else read))
    if getattr(kernel_impl, "textwrap", None) is textwrap:
        kernel_impl.textwrap = SimpleNamespace(fill=functools.cache(textwrap.fill), dedent=functools.cache(textwrap.dedent))
    if getattr(kernel_impl, "ast", None) is ast and hasattr(kernel_impl, "transform_tree"):
        trees = sources.Trees()
        kernel_impl.ast = SimpleNamespace(parse=trees.take)
        kernel_impl.transform_tree = trees.returned_by(kernel_impl.transform_tree)
    if hasattr(kernel_impl, "Kernel"):
        kernel_impl.Kernel.materialize = _uncollected(kernel_impl.Kernel.materialize)
    Builder.__call__ = _calling(Builder.__call__, ASTTransformer)
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


def _calling(original: Callable[[Any, Any, Any], Any], builders: type) -> Callable[[Any, Any, Any], Any]:
    """Build a node with what Taichi needs and no more: its builder looked up once, and its place on the stack of places.

    original: builds what is no statement or expression, and tells of what went wrong.
    builders: has a builder for each kind of node.
    """
    from taichi.lang import impl

    known: dict[type, Any] = {}

    def call(self: Any, context: Any, node: Any) -> Any:
        kind = node.__class__
        builder = known.get(kind)
        if builder is None:
            builder = getattr(builders, f"build_{kind.__name__}", None)
            if builder is None or not issubclass(kind, ast.stmt | ast.expr):
                return original(self, context, node)
            known[kind] = builder
        places = impl.get_runtime().src_info_stack
        places.append(context.get_pos_info(node))
        try:
            return builder(context, node)
        except Exception as error:
            failed = error
        finally:
            places.pop()
        return original(_Failing(failed), context, node)

    return call


class _Failing:
    """Has builders that fail as another did."""

    def __init__(self, error: Exception) -> None:
        self._error = error

    def __getattr__(self, name: str) -> Any:
        def fail(*_: Any) -> None:
            raise self._error

        return fail


def _uncollected(walk: Callable[..., Any]) -> Callable[..., Any]:
    """Let Python look for no garbage while a walk makes its tens of thousands of objects, few of which outlive it."""

    @functools.wraps(walk)
    def walking(*given: Any, **named: Any) -> Any:
        collects = gc.isenabled()
        gc.disable()
        try:
            return walk(*given, **named)
        finally:
            if collects:
                gc.enable()

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
