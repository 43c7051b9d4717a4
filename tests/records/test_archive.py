"""Files from outside: every flipped byte, and thousands of damaged ones, end in one clean line or in an equal object."""

import functools
import io
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

import tiswarm
from tiswarm.records.archive import Archive, DamagedArchive
from tiswarm.records.recording import Recording
from tiswarm.scenario.model import Scenario

SMALL = {"prey.count": 1, "predators.count": 1, "obstacles.count": 1, "world.ticks": 2}


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A small recording, and its file."""
    recording = tiswarm.record(tiswarm.load("delft/pronav-10", SMALL))
    return recording, recording.save(tmp_path_factory.mktemp("archive") / "small.npz")


def _bytes(recording):
    arrays = [recording.obstacle_position, recording.obstacle_radius]
    for kind in (recording.prey, recording.predators):
        arrays += [kind.position, kind.velocity, kind.fate, kind.state, kind.group]
    held = [(each.dtype.str, each.shape, each.tobytes()) for each in arrays]
    return held, recording.scenario, recording.seed, recording.trial


def _loaded(file):
    """Load a recording, or give the complaint."""
    try:
        return Recording.load(file), ""
    except ValueError as error:
        return None, str(error)


def test_every_flipped_byte_of_a_recording_is_refused_or_changes_nothing(small, tmp_path, monkeypatch):
    monkeypatch.setattr(Scenario, "from_json", functools.cache(Scenario.from_json))  # checking it takes nearly all the time
    recording, file = small
    content, whole, equal = file.read_bytes(), _bytes(recording), 0
    damaged = tmp_path / "x.npz"
    for place in range(len(content)):
        flipped = bytearray(content)
        flipped[place] ^= 1 << place % 8
        damaged.write_bytes(flipped)
        found, complaint = _loaded(damaged)
        if found is None:
            assert "not a recording of tiswarm" in complaint
            assert "\n" not in complaint
        else:
            equal += 1
            assert _bytes(found) == whole, place
    assert 0 < equal < len(content) // 3


def _packed(arrays, method=zipfile.ZIP_DEFLATED):
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as archive:
        for name, content in arrays.items():
            archive.writestr(f"{name}.npy", content)
    return file.getvalue()


def _npy(descr="<f8", shape="(3,)", content=bytes(24), order="False"):
    head = f"{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head.encode() + content


BAD = {
    "objects": _npy("|O"),
    "a structure": _npy("[('a', '<f8')]"),
    "code": _npy(shape="(__import__('os').abort(),)"),
    "deep": _npy(shape="(" * 90),
    "too large": _npy(shape="(100000000000,)"),
    "too small": _npy(shape="(2,)"),
    "of no size": _npy("<U0", "(0,)", b""),
    "many axes": _npy(shape="(1, 1, 1, 1, 3)"),
    "a bomb": _npy(shape=f"({1 << 24},)", content=bytes(1 << 27)),
    "a bomb that announces nothing": _npy(content=bytes(1 << 26)),
    "no array": b"hello",
    "no characters": _npy("<U1", "(1,)", b"\xff" * 4),
    "another type": _npy("<f3"),
}


@pytest.mark.parametrize("bad", BAD)
def test_what_is_no_array_is_refused_before_it_is_inflated(bad, tmp_path):
    file = tmp_path / "x.npz"
    file.write_bytes(_packed({"a": BAD[bad]}))
    with pytest.raises(DamagedArchive), Archive(file, most=1 << 26) as archive:
        archive.read("a")


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_other_compressions_are_refused(method, tmp_path):
    file = tmp_path / "x.npz"
    file.write_bytes(_packed({"a": _npy()}, method))
    with pytest.raises(DamagedArchive, match="compressed"):
        Archive(file)


def test_arrays_are_what_numpy_reads(tmp_path):
    rng = np.random.default_rng(1)
    arrays = {
        "f": rng.random((4, 3)),
        "fortran": np.asfortranarray(rng.random((4, 3))),
        "none": np.zeros((0, 2)),
        "words": np.array([["calm", "alarmed"]]),
        "bool": rng.random(5) > 0.5,
        "number": np.array(7),
        "text": np.array("äö"),
        "small": np.arange(3, dtype=np.int8),
    }
    for save in (np.savez, np.savez_compressed):
        save(tmp_path / "x.npz", **arrays)
        with Archive(tmp_path / "x.npz") as archive:
            assert set(archive.headers) == set(arrays)
            for name, array in arrays.items():
                found = archive.read(name)
                np.testing.assert_array_equal(found, array)
                assert found.dtype == array.dtype
                assert found.flags.writeable
            assert (archive.text("text", 9), archive.number("number")) == ("äö", 7)


FUZZ = Path(__file__).with_name("fuzz.py")


@pytest.mark.parametrize("form", ["recording", "arrays", "preset", "start", "manifest"])
def test_ten_thousand_damaged_files_end_in_one_line_or_an_equal_object(form, small, tmp_path):
    done = subprocess.run(
        [sys.executable, FUZZ, form, small[1], tmp_path],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        cwd=FUZZ.parents[2],
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "10000 tried" in done.stdout
