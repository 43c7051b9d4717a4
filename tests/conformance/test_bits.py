"""Bits: SHA-256 over what trials and films give, pinned, so that moving or rewriting code is seen to change nothing.

`python tests/conformance/test_bits.py` writes bits.json anew: do that only with a commit that means to change results, and why.
"""

import json
import platform
from hashlib import sha256
from pathlib import Path

import numpy as np
import PIL
import pytest

import render
import tiswarm
from tiswarm.engine.run import simulate_many

PINNED = Path(__file__).with_name("bits.json")
MEASURES = ["polarisation", "milling", "nearest", "groups", "speed", "kinetic", "trapped-time"]
BRIEF = {"world.ticks": 50, "measures.names": MEASURES}
CLOSE = {"predators.spawn.region": [[60, 25], [75, 35]], "obstacles.region": [[40, 10], [80, 45]], "prey.perception": 12}
HUNT = {**BRIEF, **CLOSE}

# One batch, one kernel: each scenario's bits are those it has on its own. Measures sum over all positions and velocities.
BATCHES = {
    "prey": (
        "delft/pronav-10",
        HUNT,
        [
            {"prey.strategy": name}
            for name in ("baseline", "evasive", "explode", "explode-evasive", "split", "split-evasive", "lookout", "swallow")
        ],
    ),
    "avoidance": (
        "delft/centre-10",
        HUNT,
        [
            {"prey.avoidance": name, "predators.avoidance": name}
            for name in ("none", "outward", "spiral", "directed-spiral", "steer-away", "kitchen-sink", "repel")
        ],
    ),
    "predators": ("delft/centre-10", HUNT, [{"predators.strategy": name} for name in ("centre", "pronav", "hawk")]),
}
ALONE = {
    "pronav": ("delft/pronav-10", {"prey.strategy": "evasive", **CLOSE}),
    "cluster": ("delft/cluster-10", {**CLOSE, "predators.weights.labels": "kept"}),
    "redrawn": ("delft/cluster-10", CLOSE),
    "hawk": ("m20/hawk", {"world.contact": "eaten", "prey.radius": 0.3}),
    "bounce": ("m20/hawk", {"world.contact": "bounce", "prey.radius": 0.3}),
}
SWARMS = {
    "chase": ("delft/crowd", {"prey.strategy": "explode-evasive"}),
    "centre": ("delft/crowd", {"predators.strategy": "centre", "prey.strategy": "split"}),
    "periodic": ("demo/murmuration", {"prey.count": 3000}),
    "space": ("demo/school", {"prey.count": 2000}),
    "plain": ("demo/million", {"prey.count": 3000}),
}
SINGLE_PRECISION_ONLY = ("batch:", "film:", "swarm:plain", "swarm:space", "trial:bounce")
# What calls the C library (angles, logarithms) or draws letters, whose last bits differ from one version to the next.
MACHINES = {
    "trial:jump": ("delft/pronav-10", {"prey.strategy": "jump", **CLOSE}),
    "trial:potential": ("sanitation/potential", {}),
    "trial:unicycle": ("sanitation/arena", {}),
    "trial:spheres": ("lookout/aquarium", {}),
}
FILMS = {
    "film:chase": ("delft/pronav-10", {"prey.strategy": "explode", "world.ticks": 40, **CLOSE}, {}),
    "film:hawk": ("m20/hawk", {"world.ticks": 20}, {"theme": "light"}),
    "film:aquarium": ("lookout/aquarium", {"world.ticks": 20}, {}),
}


def digest(*arrays):
    """Name arrays by their kinds, shapes and bits; every NaN is the same NaN."""
    name = sha256()
    for array in arrays:
        whole = np.ascontiguousarray(array)
        if whole.dtype.kind == "f":
            whole = np.where(np.isnan(whole), np.nan, whole)
        if whole.dtype.kind == "U":
            whole = np.char.encode(whole, "utf-8")
            whole = np.frombuffer(b"\0".join(whole.ravel().tolist()), np.uint8)
        name.update(f"{whole.dtype.kind}{whole.dtype.itemsize}{whole.shape}".encode() + whole.tobytes())
    return name.hexdigest()[:32]


def of_results(results):
    outcomes = [results.captured, results.crashed, results.arrived, results.alive, results.ticks, results.time]
    return digest(*outcomes, results.impact_spread, *(results.measures[name] for name in sorted(results.measures)))


def of_recording(recording):
    both = (recording.prey, recording.predators)
    arrays = [array for each in both for array in (each.position, each.velocity, each.fate, each.state, each.group)]
    return digest(*arrays, recording.obstacle_position, recording.obstacle_radius)


def of_batch(preset, changes, many):
    base = tiswarm.load(preset, changes)
    return [of_results(each) for each in simulate_many([base.replaced(own) for own in many], 32, seed=5)]


def of_trial(preset, changes):
    return of_recording(tiswarm.record(tiswarm.load(preset, {"world.ticks": 50} | changes), trial=3, seed=5))


def of_film(preset, changes, style):
    recording = tiswarm.record(tiswarm.load(preset, changes), trial=3, seed=5)
    return digest(*(frame for frame in render.frames(recording, size=(320, 180), fps=15, **style)))


CASES = {
    **{f"batch:{name}": (of_batch, case) for name, case in BATCHES.items()},
    **{f"trial:{name}": (of_trial, case) for name, case in ALONE.items()},
    **{f"swarm:{name}": (of_trial, (preset, {"world.ticks": 20} | changes)) for name, (preset, changes) in SWARMS.items()},
    **{name: (of_trial, case) for name, case in MACHINES.items()},
    **{name: (of_film, case) for name, case in FILMS.items()},
}


def libraries():
    """Name what the cases of MACHINES and FILMS depend on beside our code."""
    return {"libc": " ".join(platform.libc_ver()), "processor": platform.machine(), "pillow": PIL.__version__}


def pairs():
    return [
        (precision, name)
        for precision in ("f32", "f64")
        for name in CASES
        if precision == "f32" or not name.startswith(SINGLE_PRECISION_ONLY)
    ]


@pytest.mark.parametrize(("precision", "name"), pairs())
def test_the_bits_are_those_that_were_pinned(precision, name):
    pinned = json.loads(PINNED.read_text())
    if name in MACHINES or name in FILMS:
        for library, version in libraries().items():
            if pinned["libraries"][library] != version:
                pytest.skip(f"pinned with {library} {pinned['libraries'][library]}, not {version}")
    tiswarm.init(precision)
    of, case = CASES[name]
    assert of(*case) == pinned[precision][name]


def write():
    """Pin what the code gives now."""
    pinned = {"libraries": libraries(), "f32": {}, "f64": {}}
    for precision, name in pairs():
        tiswarm.init(precision)
        of, case = CASES[name]
        pinned[precision][name] = of(*case)
    PINNED.write_text(json.dumps(pinned, indent=1) + "\n")


if __name__ == "__main__":
    write()
