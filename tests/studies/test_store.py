"""Cells on disk are those of their study, or are computed anew; a folder has one owner at a time; changed code is seen."""

import io
import json
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

import tiswarm
from tiswarm.records.archive import digest
from tiswarm.studies import store
from tiswarm.studies.design import MEASURES, cells, load_study
from tiswarm.studies.run import columns_of, run_study
from tiswarm.system.owner import Owner, locked

STUDY = """
title = "Two goals"
base = "delft/avoidance-10"
trials = 3
set = { "world.ticks" = 60, "prey.count" = 2 }
[[axes]]
key = "prey.goal"
values = [0.1, 0.2]
"""


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A study that ran: its file, its folder, its report."""
    tiswarm.init("f32")
    place = tmp_path_factory.mktemp("store")
    (place / "s.toml").write_text(STUDY)
    return place / "s.toml", place / "o", run_study(str(place / "s.toml"), folder=place / "o")


@pytest.fixture
def copied(ran, tmp_path):
    tiswarm.init("f32")
    shutil.copytree(ran[1], tmp_path / "o")
    return tmp_path / "o"


def _read(folder, number=0):
    return store.read_cell(folder, store.read_manifest(folder / "manifest.json"), number, columns_of(MEASURES))


def test_every_flipped_byte_of_a_cell_is_refused_or_changes_nothing(copied):
    file = store.cell_file(copied, 0)
    about, columns, whole = store.read_manifest(copied / "manifest.json"), columns_of(MEASURES), _read(copied)
    content, equal = file.read_bytes(), 0
    for place in range(len(content)):
        damaged = bytearray(content)
        damaged[place] ^= 1 << place % 8
        file.write_bytes(damaged)
        found = store.read_cell(copied, about, 0, columns)
        if found is not None:
            equal += 1
            assert list(found) == columns
            assert all(found[name].tobytes() == whole[name].tobytes() for name in columns), place
    assert 0 < equal < len(content) // 3  # such as the time of day in the archive's table


def _stored(arrays):
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()


def _identity(arrays, **other):
    told = json.loads(str(arrays["identity"])) | other
    outcomes = {name: each for name, each in arrays.items() if name != "identity"}
    return {"identity": np.array(json.dumps(told | {"digest": digest(outcomes)})), **outcomes}


WRONG = {
    "other outcomes": lambda a: a | {"success": a["success"] + 0.25},
    "NaN": lambda a: a | {"success": a["success"] * np.nan},
    "no captured": lambda a: _identity({name: each for name, each in a.items() if name != "captured"}),
    "one more": lambda a: _identity(a | {"more": a["time"]}),
    "fewer trials": lambda a: _identity({name: each if name == "identity" else each[:2] for name, each in a.items()}),
    "of another study": lambda a: _identity(a, study="t"),
    "of another scenario": lambda a: _identity(a, scenario_hash="0" * 16),
    "of another seed": lambda a: _identity(a, seed=1),
    "of another cell": lambda a: _identity(a, cell=1),
    "of other code": lambda a: _identity(a, code="0" * 16),
    "columns renamed": lambda a: _identity(a, columns=["arrived"]),
    "no identity": lambda a: {name: each for name, each in a.items() if name != "identity"},
    "an identity of another kind": lambda a: a | {"identity": np.arange(3)},
    "an identity that is no table": lambda a: a | {"identity": np.array("[" * 9000)},
    "words": lambda a: a | {"success": np.array(["a", "b", "c"])},
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_cell_that_is_not_this_ones_does_not_count(copied, wrong):
    file = store.cell_file(copied, 0)
    with np.load(file) as stored:
        arrays = dict(stored)
    file.write_bytes(_stored(arrays))
    assert _read(copied) is not None
    file.write_bytes(_stored(WRONG[wrong](arrays)))
    assert _read(copied) is None


def test_what_does_not_fit_is_computed_anew_with_one_note(ran, copied):
    cell = [store.cell_file(copied, number) for number in (0, 1)]
    bomb = io.BytesIO()
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("identity.npy", b"\x93NUMPY\x01\x00v\x00" + bytes(50_000_000))
    for content in (cell[0].read_bytes(), b"", b"half", bomb.getvalue()):
        cell[1].write_bytes(content)
        with pytest.warns(UserWarning, match="1 of 2 cells were damaged or not of this run") as told:
            again = run_study(str(ran[0]), folder=copied)
        assert len(told) == 1
        assert again.ran == 1
        assert again.cells() == ran[2].cells()
    shutil.copytree(copied / "cells", copied / "spare")
    for file in cell:
        file.unlink()
        file.mkdir()
    with pytest.raises(IsADirectoryError, match="is a folder"):
        run_study(str(ran[0]), folder=copied)


MANIFESTS = [
    {"cells": {}},
    {"cells": [3]},
    {"seed": "0"},
    {"trials": 0},
    {"measures": [1]},
    {"precision": None},
    {"code": 5},
    {"study": []},
]


@pytest.mark.parametrize("change", MANIFESTS)
def test_a_damaged_manifest_gets_one_line_that_names_the_mend(ran, copied, change):
    place = copied / "manifest.json"
    told = json.loads(place.read_text())
    place.write_text(json.dumps(told | change))
    with pytest.raises(ValueError, match="--fresh") as caught:
        run_study(str(ran[0]), folder=copied)
    assert "\n" not in str(caught.value)
    assert run_study(str(ran[0]), folder=copied, fresh=True).cells() == ran[2].cells()


@pytest.mark.parametrize("time", ["x", None, [], {}])
def test_a_wall_time_that_is_none_is_forgotten(ran, copied, time):
    place = copied / "manifest.json"
    place.write_text(json.dumps(json.loads(place.read_text()) | {"wall_time_s": time}))
    assert run_study(str(ran[0]), folder=copied).ran == 0
    assert isinstance(json.loads(place.read_text())["wall_time_s"], float)


def test_a_manifest_whose_scenario_was_edited_films_nothing_else(copied):
    from tiswarm.cli.options import WrongInput
    from tiswarm.cli.rerun import Rebuilt

    place = copied / "manifest.json"
    told = json.loads(place.read_text())
    told["cells"][0]["scenario"]["prey"]["goal"] = 0.15
    place.write_text(json.dumps(told))
    with pytest.raises(WrongInput, match="cell 0 is damaged"):
        Rebuilt(place).record(0, 1)


HOLDER = """
import sys, time
from pathlib import Path
from tiswarm.system.owner import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def holder(copied):
    running = subprocess.Popen([sys.executable, "-c", HOLDER, copied], stdout=subprocess.PIPE, text=True)
    assert running.stdout.readline() == "held\n"
    yield running
    running.kill()
    running.wait()


def test_a_folder_that_another_run_writes_into_is_left_alone(ran, copied, holder):
    own = copied / "cells" / f".00001.{Owner.this().mark}.abcdefgh.part.npz"
    theirs = Owner(Owner.this().machine, holder.pid, "")
    live = copied / "cells" / f".00001.{theirs.mark}.abcdefgh.part.npz"
    own.write_text("")
    live.write_text("")
    for fresh in (False, True):
        with pytest.raises(ValueError, match=rf"process {holder.pid} is writing into this folder.*-o"):
            run_study(str(ran[0]), folder=copied, seed=1, fresh=fresh)
    assert own.exists()
    assert live.exists()
    assert len(list((copied / "cells").glob("[0-9]*.npz"))) == 2
    holder.kill()
    holder.wait()
    assert run_study(str(ran[0]), folder=copied).ran == 0  # the lock of the dead is taken over
    assert not live.exists()
    assert not (copied / ".lock").exists()


@pytest.mark.parametrize("content", ["", "{", "[]", '{"pid": 1}', '{"machine": "", "pid": -1, "started": ""}', "\0" * 500])
def test_a_lock_that_says_nothing_is_taken_over(tmp_path, content):
    (tmp_path / ".lock").write_text(content)
    with locked(tmp_path):
        assert json.loads((tmp_path / ".lock").read_text())["started"] == Owner.this().started
    assert list(tmp_path.iterdir()) == []


def test_a_number_that_was_given_out_again_holds_nothing(tmp_path):
    """As when another program got the dead run's process id."""
    me = Owner.this()
    assert me.lives
    assert me.started
    (tmp_path / ".lock").write_text(json.dumps({"machine": me.machine, "pid": me.pid, "started": me.started + "0"}))
    with locked(tmp_path):
        pass
    (tmp_path / ".lock").write_text(json.dumps({"machine": "elsewhere", "pid": 1, "started": "0"}))
    with pytest.raises(ValueError, match=r"another machine.*delete"), locked(tmp_path):
        pass


def test_a_lock_makes_no_folder_that_stays_empty_and_may_be_taken_once_more(tmp_path):
    with locked(tmp_path / "a" / "b"), locked(tmp_path / "a" / "b"):
        assert (tmp_path / "a" / "b" / ".lock").exists()
    assert list(tmp_path.iterdir()) == []


def test_one_changed_byte_of_a_kernel_changes_the_codes_hash(ran, tmp_path, monkeypatch):
    study = load_study(str(ran[0]))
    found = [cell.scenario for cell in cells(str(ran[0]), study, 0)]
    root = Path(store.__file__).parents[1]
    copy = tmp_path / "tiswarm"
    shutil.copytree(root, copy, ignore=shutil.ignore_patterns("__pycache__"))
    original = store.code_hash(found)
    monkeypatch.setattr(store, "__file__", str(copy / "studies" / "store.py"))
    monkeypatch.setattr(store, "_file", lambda kind, name: copy / "strategies" / kind / f"{name.replace('-', '_')}.py")
    assert store.code_hash(found) == original  # what counts is what files hold
    kernels = [
        "engine/trials/kernel.py",
        "engine/swarms/kernels.py",
        "dynamics/contact.py",
        "space/cell_list.py",
        "simd/philox.py",
        "measures/running.py",
        "scenario/model.py",
        "strategies/flocking.py",
        "strategies/avoidance/steer_away.py",
    ]
    for name in kernels:
        file = copy / name
        before = file.read_bytes()
        file.write_bytes(before + b"\n")
        assert store.code_hash(found) != original, name
        file.write_bytes(before)
    for name in ("studies/report.py", "cli/bench.py", "records/results.py", "system/files.py", "strategies/prey/jump.py"):
        (copy / name).write_bytes((copy / name).read_bytes() + b"\n")
    assert store.code_hash(found) == original
