"""Tracing: how Taichi reads the source of a kernel, without the work that it does twice or for nobody.

Taichi 1.7.4 walks the syntax tree of a kernel, and of every func at each of its calls, in Python; also when the compiled
kernel lies in the cache, since only the walk tells which kernel it is. Half of that time went into a drawing for each node, its
line with carets below, that is only shown when an error comes; a tenth each into reading the same files again, and into
laying out the same lines again.
"""

import functools
import inspect
import textwrap
from collections.abc import Callable
from types import CodeType, SimpleNamespace
from typing import Any

from tiswarm.simd import backend


def lighten() -> None:
    """Let Taichi name a place by file, line and func, and read each func's source once. Twice does nothing more.

    Quadrants draws no lines until it needs them.
    """
    if backend.name() != "taichi":
        return
    from taichi.lang import kernel_impl
    from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext

    if ASTTransformerContext.get_pos_info is _spot:
        return
    ASTTransformerContext.get_pos_info = _spot
    for name in ("getsourcelines", "getsourcefile"):
        if hasattr(kernel_impl, name):
            setattr(kernel_impl, name, _once(getattr(kernel_impl, name)))
    if getattr(kernel_impl, "textwrap", None) is textwrap:
        kernel_impl.textwrap = SimpleNamespace(fill=functools.cache(textwrap.fill), dedent=textwrap.dedent)


def _spot(context: Any, node: Any) -> str:
    """Name the place of a node in the source, with its first line."""
    line = context.src[node.lineno - 1].strip()
    return f'File "{context.file}", line {node.lineno + context.lineno_offset}, in {context.func.func.__name__}:\n{line}\n'


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
