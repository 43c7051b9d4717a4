"""Tracing: how Taichi reads the source of a kernel, without the work that it does twice or for nobody.

Taichi 1.7.4 walks the syntax tree of a kernel, and of every func at each of its calls, in Python; also when the compiled
kernel lies in the cache, since only the walk tells which kernel it is. Half of that time went into a drawing for each node, its
line with carets below, that is only shown when an error comes; a tenth each into reading the same files again, and into
laying out the same lines again. And each decorator looked, through all modules that there are, for the line of source at which
its caller stands, only to find out whether that is a class: a twentieth of a whole run of a second.
"""

import functools
import importlib.abc
import importlib.util
import inspect
import sys
import textwrap
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from types import CodeType, ModuleType, SimpleNamespace
from typing import Any

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
    """Let Taichi name a place by file, line and func, read each func's source once, and see a class without its source."""
    from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext

    if ASTTransformerContext.get_pos_info is _spot:
        return
    ASTTransformerContext.get_pos_info = _spot
    kernel_impl._inside_class = _inside_class
    for name in ("getsourcelines", "getsourcefile"):
        if hasattr(kernel_impl, name):
            setattr(kernel_impl, name, _once(getattr(kernel_impl, name)))
    if getattr(kernel_impl, "textwrap", None) is textwrap:
        kernel_impl.textwrap = SimpleNamespace(fill=functools.cache(textwrap.fill), dedent=textwrap.dedent)


def _spot(context: Any, node: Any) -> str:
    """Name the place of a node in the source, with its first line."""
    line = context.src[node.lineno - 1].strip()
    return f'File "{context.file}", line {node.lineno + context.lineno_offset}, in {context.func.func.__name__}:\n{line}\n'


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
