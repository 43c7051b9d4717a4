"""Width: eight lanes or sixteen, the bits are the same."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tiswarm.simd import runtime, width

CONFORMANCE = Path(__file__).parents[1] / "conformance"
CASES = ("trial:pronav", "swarm:chase", "swarm:periodic")
OTHERWISE = """
import json, sys
from tiswarm.simd import runtime
runtime.LANES = int(sys.argv[1])
import test_bits
tell = {name: of(*case) for name in sys.argv[2:] for of, case in [test_bits.CASES[name]]}
print(json.dumps(tell))
"""


def test_no_bit_depends_on_the_number_of_lanes():
    """Sums over agents are the places where it could: a swarm's means and measures."""
    other = width.WIDE + width.USUAL - runtime.LANES
    line = [sys.executable, "-c", OTHERWISE, str(other), *CASES]
    places = os.pathsep.join([str(CONFORMANCE), *sys.path])
    told = subprocess.run(line, env={**os.environ, "PYTHONPATH": places}, capture_output=True, text=True, check=True)
    pinned = json.loads((CONFORMANCE / "bits.json").read_text())["f32"]
    assert json.loads(told.stdout) == {name: pinned[name] for name in CASES}


@pytest.mark.parametrize(
    ("processor", "bits", "lanes"),
    [
        ("Intel(R) Xeon(R) Gold 6338", 512, 16),
        ("Intel64 Family 6 Model 106 Stepping 6, GenuineIntel", 512, 16),
        ("AMD EPYC 9654", 512, 8),
        ("12th Gen Intel(R) Core(TM) i7-1260P", 256, 8),
        ("arm64", 128, 8),
    ],
)
def test_lanes_are_as_many_as_fit_into_the_vectors_that_kernels_are_compiled_to(processor, bits, lanes, monkeypatch):
    monkeypatch.setattr(width, "processor", lambda: processor)
    monkeypatch.setattr(width, "vector_bits", lambda: bits)
    assert width.lanes() == lanes
