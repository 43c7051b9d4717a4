"""Ranges: loops of kernels whose stride LLVM cannot see, so that it does not unroll them.

LLVM 15 takes Zen 3 and later for machines with a buffer of 4 096 operations, and unrolls each loop of a kernel by as many
turns, up to eight, as fit: the kernel of clustering predators took 7.2 instead of 3.1 s to compile, and 3.4 instead of 1.4 s
to load from the cache, to the same rates. Elsewhere it unrolls less, but looks long for proofs that a counter does not wrap
around. Neither can be switched off from Python. Both need to know how often a loop runs, which nobody does whose stride may
be anything.
"""

import ast
import threading
from collections.abc import Callable
from numbers import Integral
from typing import Any

OURS = ("tiswarm", "render")
"""Packages whose kernels are built so: a user's own may want what a range of Taichi's alone can, gradients for one."""

FEW = 16
"""Turns, known beforehand, that are worth unrolling: as many as lanes at most. A table's columns, some 70, are not."""


def opaque(original: Callable[[Any, ast.For], None]) -> Callable[[Any, ast.For], None]:
    """Let loops within a parallel one of our kernels go by 1 | (index >> 31), which is 1, unless they have FEW turns at most.

    original: what builds a range of Taichi's, and all others.
    """
    from taichi.lang import impl, ops
    from taichi.lang.ast.ast_transformer import build_stmt, build_stmts
    from taichi.lang.expr import Expr
    from taichi.types import primitive_types

    here = threading.local()  # parallel: the loop that a thread is building, and its context

    def stepping(context: Any, node: Any, begin: Any, end: Any) -> None:
        outside, loop = here.parallel
        builder = context.ast_builder
        where = impl._ti_core.DebugInfo(context.get_pos_info(node))
        step = impl.expr_init(Expr(1) | (outside.get_var_by_name(loop.target.id) >> 31))
        last = impl.expr_init(ops.cast(end, primitive_types.i32))
        at = impl.expr_init(ops.cast(begin, primitive_types.i32) - step)
        builder.begin_frontend_while(Expr(1, dtype=primitive_types.i32).ptr, where)
        at._assign(at + step)  # before all else, since `continue` leads here
        impl.begin_frontend_if(builder, at < last, where)
        builder.begin_frontend_if_true()
        builder.pop_scope()
        builder.begin_frontend_if_false()
        builder.insert_break_stmt(where)
        builder.pop_scope()
        context.create_variable(node.target.id, at)
        build_stmts(context, node.body)
        builder.pop_scope()

    def build(context: Any, node: Any) -> None:
        if context.is_kernel and len(context.loop_scopes) == 1:
            from_zero = len(node.iter.args) == 1  # so that no index is below it
            here.parallel = (context, node) if from_zero and _ours(context) else None
            try:
                original(context, node)
            finally:
                here.parallel = None
            return
        inside = getattr(here, "parallel", None) is not None and len(node.iter.args) in (1, 2)
        bounds = [build_stmt(context, each) for each in node.iter.args] if inside else []
        if not inside or (not any(isinstance(bound, Expr) for bound in bounds) and not _many(bounds)):
            original(context, node)
            return
        with context.variable_scope_guard():
            context.check_loop_var(node.target.id)
            begin, end = [Expr(0), *map(Expr, bounds)][-2:]
            stepping(context, node, begin, end)

    return build


def _many(bounds: list[Any]) -> bool:
    """Tell whether a range between constants has more turns than are worth unrolling."""
    return all(isinstance(bound, Integral) for bound in bounds) and len(range(*bounds)) > FEW


def _ours(context: Any) -> bool:
    """Tell whether a kernel is one of our packages'."""
    return context.func.func.__module__.partition(".")[0] in OURS
