"""What a strategy may write: every operator and function is refused with its mend, complains, or works in lanes."""

import inspect
import subprocess
import sys
from pathlib import Path

import pytest
import taichi as ti

from tiswarm.strategies import registry
from tiswarm.strategies.lane_rules import check_lanes

PREAMBLE = "import taichi as ti\n\nfrom tiswarm.strategies import anywhere\n\n"

# What ends the process (found by a child process for each), or gives a wrong number, or one that depends on threads.
REFUSED = (
    "return -x", "z = 1.0 * x; z -= y; return z", "return x ** y", "return x ** 2.0", "return 2.0 ** x",
    "z = 1.0 * x; z **= y; return z", "z = 1.0 * x; z &= y; return z", "z = 1.0 * x; z |= y; return z",
    "z = 1.0 * x; z ^= y; return z", "return pow(x, y)", "return abs(x)", "return x * int(x)", "return x * bool(x)",
    "return ti.abs(x)", "return ti.acos(x)", "return ti.asin(x)", "return ti.cos(x)", "return ti.exp(x)", "return ti.log(x)",
    "return ti.rsqrt(x)", "return ti.sin(x)", "return ti.tan(x)", "return ti.tanh(x)", "return ti.atan2(x, y)",
    "return ti.pow(x, y)", "return ti.raw_mod(x, y)", "return 1.0 * ti.cast(x, ti.i32)", "return ti.bit_cast(x, ti.i32)",
    "return ti.math.acos(x)", "return ti.math.asin(x)", "return ti.math.cos(x)", "return ti.math.exp(x)",
    "return ti.math.log(x)", "return ti.math.log2(x)", "return ti.math.sign(x)", "return ti.math.sin(x)",
    "return ti.math.tan(x)", "return ti.math.tanh(x)", "return ti.select(ti.math.isnan(x), x, y)",
    "return ti.select(ti.math.isinf(x), x, y)", "return ti.math.atan2(x, y)", "return ti.math.pow(x, y)",
    "return ti.math.step(x, y)", "return x * (x < y).any()", "return x * (x < y).all()", "return x * (x < y).sum()",
    "return x + ti.random()",
)  # fmt: skip

# What works, with what it gives in each lane.
ALLOWED = {
    "x + y": "x + y", "x - y": "x - y", "x * y": "x * y", "x / y": "x / y", "x // y": "x // y", "x % y": "x % y",
    "+x": "x", "x ** 2": "x * x", "x ** -1": "1 / x", "x ** 3": "x * x * x", "0.0 - x": "-x",
    "ti.select(x < y, x, y)": "np.minimum(x, y)", "ti.select(x >= y, x, y)": "np.maximum(x, y)",
    "ti.select(x == y, x, y)": "y", "ti.select(x != y, x, y)": "x",
    "ti.select((x < y) & (y < 0.5), x, y)": "np.where((x < y) & (y < 0.5), x, y)",
    "ti.select((x < y) | (y < 0.5), x, y)": "np.where((x < y) | (y < 0.5), x, y)",
    "ti.select((x < y) ^ (y < 0.5), x, y)": "np.where((x < y) ^ (y < 0.5), x, y)",
    "ti.select((x < y) and (y < 0.5), x, y)": "np.where((x < y) & (y < 0.5), x, y)",
    "ti.select((x < y) or (y < 0.5), x, y)": "np.where((x < y) | (y < 0.5), x, y)",
    "ti.select(~(x < y), x, y)": "np.maximum(x, y)", "ti.select(not (x < y), x, y)": "np.maximum(x, y)",
    "1.0 * (x < y)": "1.0 * (x < y)", "x + y[0]": "x + y[0]",
    "x * ti.cast(10.0 * x[3], ti.i32)": "x * int(10 * x[3])",
    "ti.ceil(x)": "np.ceil(x)", "ti.floor(x)": "np.floor(x)", "ti.round(x)": "np.round(x)", "ti.sqrt(x)": "np.sqrt(x)",
    "ti.max(x, y)": "np.maximum(x, y)", "ti.min(x, y)": "np.minimum(x, y)", "ti.raw_div(x, y)": "x / y",
    "max(x, 0.3)": "np.maximum(x, 0.3)", "min(x, y)": "np.minimum(x, y)", "ti.math.ceil(x)": "np.ceil(x)",
    "ti.math.floor(x)": "np.floor(x)", "ti.math.fract(x)": "x - np.floor(x)", "ti.math.mod(x, y)": "x % y",
    "ti.math.sqrt(x)": "np.sqrt(x)", "ti.math.clamp(x, 0.2, 0.5)": "np.clip(x, 0.2, 0.5)",
    "ti.math.mix(x, y, 0.25)": "0.75 * x + 0.25 * y", "ti.math.degrees(x)": "np.degrees(x)",
    "ti.math.radians(x)": "np.radians(x)", "x * x.max()": "x * x.max()", "x * x.min()": "x * x.min()",
    "x * x.sum()": "x * x.sum()", "x * x.dot(y)": "x * x.dot(y)", "x * ti.select(x < y, 1, 0).sum()": "x * (x < y).sum()",
    "x * ti.select(anywhere(x < 0.05), 1.0, 2.0)": "2 * x",
}  # fmt: skip

# Complain by errors of their own when they are given lanes.
ELSEWHERE = {"bit_shr", "frexp"}


def source(body):
    """Write a strategy's function that gives what a body returns."""
    lines = "".join(f"    {line.strip()}\n" for line in body.split(";"))
    return f"{PREAMBLE}\n@staticmethod\n@ti.func\ndef steer(x, y):\n{lines}"


@pytest.mark.parametrize("body", REFUSED)
def test_what_ends_the_process_is_refused_with_its_mend(body, tmp_path):
    file = tmp_path / "bad.py"
    file.write_text(source(body))
    with pytest.raises(ValueError, match=r"bad\.py:\d+: .*(write|see|use|convert)"):
        check_lanes(file)


def test_what_is_allowed_works_in_lanes(tmp_path):
    (tmp_path / "terms.py").write_text(
        PREAMBLE + "".join(f"\n@ti.func\ndef term_{n}(x, y):\n    return {term}\n\n" for n, term in enumerate(ALLOWED))
    )
    check_lanes(tmp_path / "terms.py")
    own = {file for kind in registry.KINDS for file in registry._files(kind).values() if isinstance(file, Path)}
    for file in own:
        check_lanes(file)
    code = f"""
import numpy as np, taichi as ti
from tiswarm.simd import runtime
runtime.init("f64", 1)
import terms
types = runtime.types()
flat = types.lane_array(1)
def kernel_of(term):
    @ti.kernel
    def run(given: flat, out: flat):
        for _ in range(1):
            out[0] = term(given[0], given[1])
    return run
wide = runtime.LANES
given, out = runtime.aligned((2, wide), types.dtype), runtime.aligned((1, wide), types.dtype)
given[0], given[1] = x, y = np.linspace(0.1, 0.9, wide), np.linspace(0.8, 0.2, wide)
for n, (term, right) in enumerate({ALLOWED!r}.items()):
    print(term, flush=True)
    kernel_of(getattr(terms, f"term_{{n}}"))(given, out)
    np.testing.assert_allclose(out[0], eval(right), rtol=1e-12, atol=1e-15, err_msg=term)
"""
    (tmp_path / "tries.py").write_text(code)  # a file, whose source Taichi can read
    done = subprocess.run([sys.executable, tmp_path / "tries.py"], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, (done.stdout.splitlines()[-1:], done.stderr.splitlines()[-8:])


def test_every_function_of_taichi_on_numbers_was_tried():
    tried = " ".join((*REFUSED, *ALLOWED))
    named = {name for name in ti.lang.ops.__all__ if inspect.isfunction(getattr(ti, name, None)) and "atomic" not in name}
    assert {name for name in named if f"ti.{name}(" not in tried} <= ELSEWHERE
