"""Speed beside README's figures: what it says of this machine, and that it compares with what README tells."""

import json
import re
from pathlib import Path

import pytest

from tiswarm.engine import throughput
from tiswarm.system.machine import processor, vector_bits

pytestmark = pytest.mark.quick

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


@pytest.fixture
def measured(monkeypatch):
    """Let every work run at half of what README tells, without running it."""
    timings = {work: throughput.Timing(work.published / 2, 1.5) for work in throughput.WORK}
    monkeypatch.setattr(throughput, "measure", lambda work, seed: timings[work])


def test_json_names_the_machine_and_the_share_of_each_figure(measured, command, tmp_path, f32):
    told = json.loads(command("speed", "--json", "--quiet", cwd=tmp_path).stdout)
    assert told["machine"]["processor"] == processor()
    assert told["machine"]["vector_bits"] == vector_bits()
    assert told["machine"].keys() == told["published_on"].keys()
    assert [each["work"] for each in told["figures"]] == [work.title for work in throughput.WORK]
    assert all(each["share"] == 0.5 and each["rate"] == round(each["published"] / 2) for each in told["figures"])


def test_the_table_says_the_same_in_words(measured, command, tmp_path, f32):
    said = command("speed", "--quiet", cwd=tmp_path).stdout
    assert f"vectors of {vector_bits()} bits" in said
    assert "README: AMD EPYC, 2 threads, vectors of 512 bits, f32" in said
    assert said.count("0.50") == len(throughput.WORK)


def test_what_it_compares_with_is_what_readme_tells():
    told = re.findall(r"\(figure (\d+)\) \| ([\d ]+) to ([\d ]+) trials/s", README)
    assert len(told) == len(throughput.WORK)
    for work, (figure, low, high) in zip(throughput.WORK, told, strict=True):
        assert work.title.startswith(f"figure {figure}:")
        assert int(low.replace(" ", "")) <= work.published <= int(high.replace(" ", ""))


@pytest.mark.parametrize(
    ("found", "bits"),
    [
        (["SSE42", "AVX2"], 256),
        (["X86_V3"], 256),
        (["AVX2", "AVX512F"], 512),
        (["X86_V3", "X86_V4"], 512),
        (["NEON", "ASIMD"], 128),
        ([], 128),
    ],
)
def test_vectors_are_as_wide_as_numpy_finds_them(found, bits, monkeypatch):
    monkeypatch.setattr("numpy.show_config", lambda mode: {"SIMD Extensions": {"baseline": ["SSE2"], "found": found}})
    assert vector_bits() == bits
