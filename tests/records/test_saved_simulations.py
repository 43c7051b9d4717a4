"""Simulations saved by the thesis's simulator."""

import copy
import json
import random
from pathlib import Path

import numpy as np
import pytest

import render
from tiswarm.records.saved import is_saved, load_saved

pytestmark = pytest.mark.quick

FOLDER = Path(__file__).parent / "saved"


@pytest.fixture
def told() -> dict:
    return json.loads((FOLDER / "png_baseline.json").read_text())


def written(folder: Path, document) -> Path:
    path = folder / "saved.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    return path


def test_paths_are_those_of_the_file(told):
    recording = load_saved(FOLDER / "png_baseline.json")
    assert recording.ticks == len(told["environments"]) - 1
    assert (recording.prey.count, recording.predators.count) == (6, 15)
    for tick, environment in enumerate(told["environments"]):
        for swarm, name in ((recording.prey, "swarm_agents"), (recording.predators, "projectiles")):
            agents = environment["structure"][name]
            there = swarm.alive[tick]
            assert there.sum() == len(agents)
            assert swarm.position[tick, there].tolist() == [each["position"] for each in agents]
            assert swarm.velocity[tick, there].tolist() == [each["velocity"] for each in agents]


def test_what_the_file_tells_of_its_scenario_is_kept():
    recording = load_saved(FOLDER / "avoidance_spiral.json")
    scenario = recording.scenario
    assert scenario.world.size == (100.0, 50.0)
    assert scenario.world.ticks == 150
    assert scenario.target.position == (10.0, 25.0)
    assert [area.label for area in scenario.world.areas] == ["danger area", "safe area"]
    assert scenario.prey.avoidance == "spiral"
    assert scenario.prey.perception == 5
    assert len(recording.obstacle_radius) == 10
    assert load_saved(FOLDER / "png_baseline.json").scenario.predators.strategy == "pronav"


def test_whoever_is_missing_met_what_was_nearest():
    assert (load_saved(FOLDER / "avoidance_spiral.json").prey.fate == "arrived").all()
    hunted = load_saved(FOLDER / "png_baseline.json")
    assert (hunted.prey.fate == "captured").all()
    assert (hunted.predators.fate == "captured").sum() == 7  # two took the same prey
    assert (hunted.predators.fate == "alive").sum() == 8


def test_a_saved_simulation_plays(tmp_path):
    assert render.replay(load_saved(FOLDER / "png_baseline.json"), tmp_path / "page.html").stat().st_size < 250_000


@pytest.mark.parametrize(
    ("path", "value", "told_of"),
    [
        (["environments"], {}, "environments is no list"),
        (["environments"], [], "environments has no entry"),
        (["environments", 0, "structure", "swarm_agents"], [], "agent_1 appears at tick 1"),
        (["environments", 0, "structure", "swarm_agents", 0, "position"], [1, None], "None is no number"),
        (["environments", 0, "structure", "swarm_agents", 0, "position"], [1, 2, 3], "no point of two numbers"),
        (["environments", 1, "structure", "swarm_agents", 0, "velocity"], "fast", "no point of two numbers"),
        (["environments", 1, "structure", "projectiles", 0, "id"], "projectile_99", "appears at tick 1"),
        (["environments", 1, "structure", "projectiles", 0, "id"], "projectile_2", "has an id twice at tick 1"),
        (["environments", 0, "structure", "map_structure", "map_height"], -50, "size"),
        (["environments", 0, "structure", "map_structure"], None, "map_structure is no object"),
        (["environments", 0, "header", "delta_time"], 0, "dt"),
        (["environments", 0, "header", "max_ticks"], 10**400, "too large"),
    ],
)
def test_a_wrong_file_gets_one_clear_line(told, tmp_path, path, value, told_of):
    place = told
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    with pytest.raises(ValueError, match="not a simulation saved by the thesis's simulator") as error:
        load_saved(written(tmp_path, told))
    assert told_of in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "text", ["", "[]", "null", "{", '"environments"', "[" * 100_000, '{"environments": NaN}', "\ufeff{}", "7"]
)
def test_other_text_gets_one_clear_line(tmp_path, text):
    with pytest.raises(ValueError, match="not a simulation saved") as error:
        load_saved(written(tmp_path, text))
    assert "\n" not in str(error.value)


def test_bytes_that_are_no_text_get_one_clear_line(tmp_path):
    path = tmp_path / "saved.json"
    path.write_bytes(b"\xff\xfe\x00environments")
    with pytest.raises(ValueError, match="not a simulation saved"):
        load_saved(path)


def _places(value, path=()):
    yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, each in items:
        yield from _places(each, (*path, key))


def test_damage_anywhere_is_told_or_harmless(told, tmp_path):
    """A file with any one value lost or replaced is read as something sound or refused in one line."""
    told["environments"] = told["environments"][:2] + told["environments"][-2:]
    places = [each for each in _places(told) if each]
    chance, told_in_lines = random.Random(3), []
    for _ in range(300):
        broken = copy.deepcopy(told)
        *above, last = chance.choice(places)
        place = broken
        for key in above:
            place = place[key]
        value = chance.choice([None, -1, 1e308, "", "x", [], {}, True, float("nan"), "drop"])
        if value == "drop":
            del place[last]
        else:
            place[last] = value
        try:
            recording = load_saved(written(tmp_path, broken))
        except ValueError as refused:
            told_in_lines.append(str(refused).count("\n"))
            continue
        recording.check()
        assert np.isfinite(recording.prey.position[0]).all()
    assert set(told_in_lines) == {0}


def test_a_manifest_is_not_taken_for_one(tmp_path):
    path = tmp_path / "manifest.json"
    path.write_text('{"study": "delft", "cells": []}')
    assert not is_saved(path)
    assert is_saved(FOLDER / "png_baseline.json")
