"""Lane rules: what a strategy may not write, since Taichi ends the process where a vector of lanes cannot do it."""

import ast
from pathlib import Path
from typing import Any

_NO_LANES = ("abs", "acos", "asin", "atan2", "cos", "exp", "log", "rsqrt", "sin", "tan", "tanh")
"""What Taichi 1.7.4 cannot do with a vector of lanes: it does not complain, it ends the process."""


def check_lanes(file: Path) -> None:
    """Refuse what would end the process when its kernel is compiled. Errors: ValueError that names the line and the mend."""
    try:
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except SyntaxError as error:
        raise ValueError(f"{file}:{error.lineno}: not valid Python: {error.msg}") from None
    for func in ast.walk(tree):
        if not isinstance(func, ast.FunctionDef) or not any(_is_ti(each, ("func",)) for each in func.decorator_list):
            continue
        node: Any
        for node in ast.walk(func):
            mend = None
            if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub) and not isinstance(node.operand, ast.Constant):
                mend = "lanes cannot be negated: write 0.0 - x"
            elif isinstance(node, ast.AugAssign) and isinstance(node.op, ast.Sub):
                mend = "lanes cannot be decremented in place: write x = x - y"
            elif isinstance(node, ast.Call) and _ends_in(node.func, _NO_LANES):
                mend = f"lanes have no {ast.unparse(node.func)}: see CONTRIBUTING, 'Write a term in lanes'"
            if mend:
                raise ValueError(f"{file}:{node.lineno}: {mend}")


def _ends_in(node: ast.expr, names: tuple[str, ...]) -> bool:
    """Tell whether a function is called by one of these names, as in abs, ti.abs or ti.math.abs."""
    return (isinstance(node, ast.Name) and node.id in names) or (isinstance(node, ast.Attribute) and node.attr in names)


def _is_ti(node: ast.expr, names: tuple[str, ...]) -> bool:
    return isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "ti" and node.attr in names
