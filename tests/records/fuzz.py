"""Damage files of one format in 10 000 ways, under 1 GiB of memory: python fuzz.py FORMAT RECORDING FOLDER.

Bytes are flipped, cut, doubled and overwritten; with `arrays` inside the arrays of a recording, whose checksums are made anew.
"""

import functools
import io
import json
import random
import resource
import sys
import zipfile
from pathlib import Path

import numpy as np

import tiswarm
from tiswarm.records.recording import Recording
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.start import Start
from tiswarm.studies.store import read_manifest

TRIES = 10_000
GIB = 1 << 30
PRESET = """
title = "Small"
base = "delft/pronav-10"
[world]
size = [100, 50]
[prey]
count = 3
spawn = { region = [[80, 30], [88, 38]], velocity = [[0, 0], [1, 1]] }
"""


def damaged(content: bytes, rng: random.Random) -> bytes:
    """Change one byte, or a few, or cut or double a piece."""
    out = bytearray(content)
    place = rng.randrange(len(out))
    kind = rng.random()
    if kind < 0.5:
        out[place] = rng.randrange(256)
    elif kind < 0.7:
        for _ in range(rng.randrange(2, 12)):
            out[rng.randrange(len(out))] ^= 1 << rng.randrange(8)
    elif kind < 0.8:
        del out[place : place + rng.randrange(1, 40)]
    elif kind < 0.9:
        out[place:place] = out[place : place + rng.randrange(1, 40)]
    else:
        out[place : place + 8] = rng.choice((b"\xff" * 8, b"\0" * 8, b"\x7f\xf0" * 4, b"99999999", b"nan inf "))
    return bytes(out)


def repacked(arrays: dict[str, bytes], rng: random.Random) -> bytes:
    """Damage one array of an archive, and give it the right checksum."""
    name = rng.choice(sorted(arrays))
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for each, content in arrays.items():
            archive.writestr(each, damaged(content, rng) if each == name else content)
    return file.getvalue()


def main(form: str, sample: Path, folder: Path) -> None:
    """Try one format."""
    saved, recording = sample.read_bytes(), Recording.load(sample)
    with zipfile.ZipFile(io.BytesIO(saved)) as archive:
        arrays = {name: archive.read(name) for name in archive.namelist()}
    scenario = json.loads(recording.scenario.to_json())
    cell = {"cell": 0, "row": "a", "seed": 0, "scenario_hash": recording.scenario.hash(), "scenario": scenario}
    told = {"study": "s", "seed": 0, "trials": 3, "precision": "f32", "code": "0", "measures": ["success"], "cells": [cell]}
    start = {name: getattr(recording.prey, name[5:])[0].tolist() for name in ("prey_position", "prey_velocity")}
    start |= {name: [] for name in ("predator_position", "predator_velocity", "obstacle_position", "obstacle_radius")}
    Scenario.from_json = functools.cache(Scenario.from_json)  # type: ignore[method-assign]

    def load_start(file: Path) -> Start:
        return Start(**json.loads(file.read_text(encoding="utf-8")))

    whole, load = {
        "recording": (saved, Recording.load),
        "arrays": (saved, Recording.load),
        "preset": (PRESET.encode(), tiswarm.load),
        "manifest": (json.dumps(told).encode(), read_manifest),
        "start": (json.dumps(start).encode(), load_start),
    }[form]
    rng, file = random.Random(18), folder / f"x.{'toml' if form == 'preset' else 'npz'}"
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + GIB, used + GIB))
    loaded = 0
    for _ in range(TRIES):
        content = repacked(arrays, rng) if form == "arrays" else damaged(whole, rng)
        file.write_bytes(content)
        try:
            found = load(file)
        except ValueError as error:
            if "\n" in str(error):
                raise
            continue
        except TypeError:
            if form != "start":  # where it is a key or a list in the user's own JSON
                raise
            continue
        loaded += 1
        if form == "recording":  # the file's own checksums see to it
            np.testing.assert_array_equal(found.prey.position, recording.prey.position)
        if form in ("recording", "arrays"):
            found.check()
            assert found.scenario.hash()
    sys.stdout.write(f"{TRIES} tried, {loaded} loaded\n")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))
