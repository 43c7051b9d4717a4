"""Lane rules: what a strategy may not write, since Taichi ends the process where a vector of lanes cannot do it."""

import ast
from pathlib import Path

_NO_LANES = ("abs", "acos", "asin", "atan2", "cos", "exp", "log", "pow", "raw_mod", "rsqrt", "sin", "tan", "tanh")
"""What Taichi 1.7.4 cannot do with a vector of lanes: it does not complain, it ends the process."""

_NO_LANES_OF_TAICHI = ("isinf", "isnan", "log2", "sign", "step")
"""More of these, whose names functions of a strategy's own may have."""

_CASTS = ("cast", "bit_cast", "int", "bool")
"""These can do one lane, x[0], and not all of them."""

_FIRST_LANE = ("any", "all")
"""Taichi's own look at lane 0 only."""


def check_lanes(file: Path) -> None:
    """Refuse what would end the process when its kernel is compiled. Errors: ValueError that names the line and the mend."""
    try:
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except SyntaxError as error:
        raise ValueError(f"{file}:{error.lineno}: not valid Python: {error.msg}") from None
    for func in ast.walk(tree):
        if not isinstance(func, ast.FunctionDef) or not any(_is_ti(each, ("func",)) for each in func.decorator_list):
            continue
        hook = any(ast.unparse(each) == "staticmethod" for each in func.decorator_list)
        counters = _counters(func) if hook else None  # what else a strategy builds may be given numbers that are no lanes
        for node in ast.walk(func):
            mend = _mend(node, counters)
            if mend:
                raise ValueError(f"{file}:{getattr(node, 'lineno', func.lineno)}: {mend}")


def _mend(node: ast.AST, counters: set[str] | None) -> str | None:
    """Say what to write instead of what lanes cannot do."""
    match node:
        case ast.UnaryOp(op=ast.USub()) if not isinstance(node.operand, ast.Constant):
            return "lanes cannot be negated: write 0.0 - x"
        case ast.AugAssign(op=ast.Sub()):
            return "lanes cannot be decremented in place: write x = x - y"
        case ast.AugAssign(op=ast.BitAnd() | ast.BitOr() | ast.BitXor()):
            return "lanes cannot be combined in place: write mask = mask & other"
        case ast.BinOp(op=ast.Pow(), right=power) | ast.AugAssign(op=ast.Pow(), value=power) if not _whole(power):
            return "lanes have no power but whole ones, x ** 2: write products and ti.sqrt"
        case ast.Call():
            return _mend_of_call(node, counters)
    return None


def _mend_of_call(call: ast.Call, counters: set[str] | None) -> str | None:
    name = ast.unparse(call.func)
    taichis = isinstance(call.func, ast.Attribute) and name.startswith(("ti.", "tm."))
    if _ends_in(call.func, _NO_LANES) or (taichis and _ends_in(call.func, _NO_LANES_OF_TAICHI)):
        return f"lanes have no {name}: see CONTRIBUTING, 'Write a term in lanes'"
    if counters is not None and _ends_in(call.func, _CASTS) and call.args and not _one_number(call.args[0], counters):
        return f"lanes have no {name}: convert one lane after the other, see CONTRIBUTING, 'Write a term in lanes'"
    if isinstance(call.func, ast.Attribute) and call.func.attr in _FIRST_LANE and not call.args:
        return f"{name}() looks at the first lane only: write anywhere(mask)"
    if isinstance(call.func, ast.Attribute) and call.func.attr == "sum" and isinstance(call.func.value, ast.Compare):
        return f"{name}() does not count a mask: write ti.select(mask, 1, 0).sum()"
    if name == "ti.random":
        return "ti.random() gives other numbers at every number of threads: use the dice that `kick` is given"
    return None


def _counters(func: ast.FunctionDef) -> set[str]:
    """Name what loops count by: one number each, not lanes."""
    targets = [node.target for node in ast.walk(func) if isinstance(node, ast.For | ast.comprehension)]
    return {name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)}


def _one_number(argument: ast.expr, counters: set[str]) -> bool:
    """Tell whether an expression is one number as far as one can see: a lane of lanes, or made of counters alone."""
    inside = list(ast.walk(argument))
    return (
        any(isinstance(each, ast.Subscript) for each in inside)
        or {each.id for each in inside if isinstance(each, ast.Name)} <= counters
    )


def _whole(number: ast.expr) -> bool:
    """Tell whether an exponent is a whole number as it is written."""
    inner = number.operand if isinstance(number, ast.UnaryOp) else number
    return isinstance(inner, ast.Constant) and type(inner.value) is int


def _ends_in(node: ast.expr, names: tuple[str, ...]) -> bool:
    """Tell whether a function is called by one of these names, as in abs, ti.abs or ti.math.abs."""
    return (isinstance(node, ast.Name) and node.id in names) or (isinstance(node, ast.Attribute) and node.attr in names)


def _is_ti(node: ast.expr, names: tuple[str, ...]) -> bool:
    return isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "ti" and node.attr in names
