"""Loading, overriding, checking: every mistake gives one line that names the key, the value and the mend."""

import json
import pickle

import jsonschema
import numpy as np
import pytest

import tiswarm
from tiswarm.scenario import presets as module
from tiswarm.scenario.model import Scenario

pytestmark = pytest.mark.quick


def _complaint(overrides, preset="delft/pronav-10"):
    with pytest.raises(tiswarm.ScenarioError) as caught:
        tiswarm.load(preset, overrides)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("name", sorted(module.presets()))
def test_every_preset_loads_and_has_a_title_and_a_source(name):
    scenario = tiswarm.load(name)
    assert scenario.title
    assert scenario.source


def test_a_preset_takes_from_its_base_what_it_does_not_state():
    scenario = tiswarm.load("delft/centre-0")
    assert (scenario.predators.strategy, scenario.predators.count, scenario.obstacles.count) == ("centre", 15, 0)
    assert (scenario.world.ticks, scenario.prey.perception, scenario.prey.avoidance) == (250, 30, "kitchen-sink")


def test_a_scenario_knows_what_it_was_loaded_from(tmp_path):
    (tmp_path / "own.toml").write_text('base = "delft/centre-10"\n')
    assert tiswarm.load(tmp_path / "own.toml").preset == "own.toml"
    assert tiswarm.load("chase", {"prey.count": 3}).preset == "demo/chase"


def test_a_plain_name_finds_a_demo():
    assert tiswarm.load("chase") == tiswarm.load("demo/chase")


@pytest.mark.parametrize(
    ("overrides", "parts"),
    [
        ({"prey.count": 0}, ("prey.count", "0", "1 or more")),
        ({"prey.count": -3}, ("prey.count", "-3", "1 or more")),
        ({"predators.count": -1}, ("predators.count", "-1", "0 or more")),
        ({"prey.count": 2.5}, ("prey.count", "2.5", "whole number")),
        ({"prey.count": "six"}, ("prey.count", "'six'", "whole number")),
        ({"prey.count": True}, ("prey.count", "True", "whole number")),
        ({"prey.radius": float("nan")}, ("prey.radius", "nan", "finite")),
        ({"prey.max_speed": float("inf")}, ("prey.max_speed", "inf", "finite")),
        ({"prey.max_speed": 0}, ("prey.max_speed", "0", "1e-06 or more")),
        ({"prey.cohesion": "much"}, ("prey.cohesion", "'much'", "number")),
        ({"prey.goal": 1e9}, ("prey.goal", "1000000000", "1e+06 or less")),
        ({"prey.coheson": 1}, ("prey.coheson", "unknown key", "'cohesion'")),
        ({"pray.count": 6}, ("pray", "unknown key", "'prey'")),
        ({"prey.strategy": "explod"}, ("prey.strategy", "'explod'", "did you mean 'explode'?")),
        ({"prey.strategy": 7}, ("prey.strategy", "7", "text")),
        ({"prey.avoidance": "spirall"}, ("prey.avoidance", "'spirall'", "did you mean 'spiral'?")),
        ({"predators.strategy": "pronaf"}, ("predators.strategy", "'pronaf'", "did you mean 'pronav'?")),
        ({"prey.strategy": "evasive", "prey.weights.evad": 1}, ("prey.weights.evad", "did you mean 'evade'?")),
        ({"prey.weights.push": "x"}, ("prey.weights.push", "'x'", "number")),
        ({"prey.weights": 3}, ("prey.weights", "3", "table")),
        ({"prey.spawn.region": [[88, 30], [80, 38]]}, ("prey.spawn.region", "lower to an upper corner")),
        ({"prey.spawn.region": [[80, 30]]}, ("prey.spawn.region", "two corners")),
        ({"prey.spawn.region.0.7": 1}, ("prey.spawn.region.0.7", "0 to 1")),
        ({"obstacles.radius": [2, 1]}, ("obstacles", "[smallest, largest]")),
        ({"obstacles.region": "everywhere"}, ("obstacles.region", "'everywhere'")),
        ({"world.boundary": "closed"}, ("world.boundary", "'closed'", "'open'")),
        ({"world.ticks": 0}, ("world.ticks", "0", "1 or more")),
        ({"world.dt": -1.0}, ("world.dt", "-1.0")),
        ({"target.radius": -4}, ("target.radius", "-4")),
        ({"world.dt": 1e6, "prey.max_speed": 1e6}, ("prey.max_speed", "1e+12 m in a tick", "world.dt")),
        ({"world.dt": 1e3, "predators.max_speed": 1e4}, ("predators.max_speed", "1e+07 m in a tick")),
        ({"world.dt": 1e6, "prey.spawn.velocity": [[-5, 0], [0, 0]]}, ("prey.spawn.velocity", "5e+06 m in a tick")),
        ({"title": 5}, ("title", "5", "text")),
        ({"title.x": 5}, ("title.x", "not a table")),
    ],
)
def test_a_mistake_gives_one_line_with_key_value_and_mend(overrides, parts):
    message = _complaint(overrides)
    for part in parts:
        assert part in message


def test_a_target_inside_the_obstacle_region_is_allowed():
    assert tiswarm.load("delft/pronav-10", {"target.position": [40, 20]}).target.position == (40, 20)


def test_an_unknown_preset_names_the_nearest():
    with pytest.raises(tiswarm.ScenarioError, match=r"unknown 'delft/pronav-11'; did you mean 'delft/pronav-10'\?"):
        tiswarm.load("delft/pronav-11")


def test_files_that_cannot_be_used_are_named(tmp_path):
    with pytest.raises(tiswarm.ScenarioError, match=r"nowhere\.toml: cannot be read"):
        tiswarm.load(str(tmp_path / "nowhere.toml"))
    broken = tmp_path / "broken.toml"
    broken.write_text("[prey\n")
    with pytest.raises(tiswarm.ScenarioError, match="not valid TOML"):
        tiswarm.load(str(broken))
    broken.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(tiswarm.ScenarioError, match="cannot be read"):
        tiswarm.load(str(broken))


def test_bases_in_a_circle_are_named(tmp_path):
    a, b = tmp_path / "a.toml", tmp_path / "b.toml"
    a.write_text(f'base = "{b}"\n')
    b.write_text(f'base = "{a}"\n')
    with pytest.raises(tiswarm.ScenarioError, match="circle"):
        tiswarm.load(str(a))


def test_toml_and_json_round_trips_change_nothing(tmp_path):
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "explode-evasive", "prey.weights": {"blast": 7}})
    file = tmp_path / "again.toml"
    file.write_text(scenario.to_toml())
    assert tiswarm.load(str(file)) == scenario.replaced({"preset": "again.toml"})
    assert Scenario.from_json(scenario.to_json()) == scenario
    assert scenario.prey.weights["blast"] == 7
    assert scenario.prey.weights["evade"] == 0.01


def test_the_hash_names_what_is_computed():
    plain = tiswarm.load("delft/pronav-10")
    assert plain.replaced({"title": "Other"}).hash() == plain.hash()
    assert plain.replaced({"prey.cohesion": 0.006}).hash() != plain.hash()


def test_scenarios_are_frozen():
    scenario = tiswarm.load("delft/pronav-10")
    with pytest.raises(ValueError, match="frozen"):
        scenario.title = "x"


def test_numbers_lists_every_numeric_key():
    numbers = tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive"}).numbers()
    assert numbers["prey.weights.evade"] == 0.01
    assert numbers["target.position.1"] == 25
    assert numbers["prey.spawn.region.1.0"] == 88
    assert all(np.isfinite(list(numbers.values())))


def test_the_schema_takes_every_preset_and_refuses_what_the_loader_refuses():
    schema = json.loads(json.dumps(Scenario.model_json_schema()))
    checker = jsonschema.Draft202012Validator(schema)
    for name, file in module.presets().items():
        assert checker.is_valid(module.read_toml(file)), name
    for wrong in (
        {"prey": {"coheson": 1}},
        {"prey": {"strategy": "explod"}},
        {"prey": {"count": 0}},
        {"prey": {"spawn": {"region": 3}}},
    ):
        assert not checker.is_valid(wrong), wrong


def test_the_schema_says_what_every_key_is():
    schema = Scenario.model_json_schema()
    tables = {**schema["$defs"], "Scenario": schema}
    for name, table in tables.items():
        for key, about in table.get("properties", {}).items():
            refers = "$ref" in about or "allOf" in about  # a table of its own, or a region
            assert about.get("description") or refers or key == "preset", f"{name}.{key} has no comment beside it"
    assert "centre" in schema["$defs"]["Prey"]["properties"]["cohesion"]["description"]  # of a table that it extends


def test_another_strategy_drops_the_weights_that_it_does_not_know():
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive", "prey.weights.evade": 0.5})
    assert scenario.replaced({"prey.avoidance": "none"}).prey.weights == {"evade": 0.5}
    assert scenario.replaced({"prey.strategy": "split-evasive"}).prey.weights["evade"] == 0.5
    with pytest.raises(tiswarm.ScenarioError, match="no weight of strategy 'split'"):
        scenario.replaced({"prey.strategy": "split", "prey.weights.evade": 1})


def test_a_relative_base_lies_beside_the_file_that_names_it(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a.toml").write_text('base = "delft/centre-10"\n')
    (tmp_path / "sub" / "b.toml").write_text('base = "a.toml"\n[prey]\ncount = 3\n')
    assert tiswarm.load(tmp_path / "sub" / "b.toml").predators.strategy == "centre"


def test_numbers_of_numpy_are_numbers():
    scenario = tiswarm.load("delft/pronav-10", {"prey.count": np.int64(4), "target.position": np.array([20.0, 25.0])})
    assert (scenario.prey.count, scenario.target.position) == (4, (20, 25))


def test_weights_cannot_be_changed_behind_the_checks_back():
    scenario = tiswarm.load("delft/pronav-10")
    with pytest.raises(TypeError, match="frozen"):
        scenario.prey.weights["push"] = float("nan")
    assert hash(scenario) == hash(tiswarm.load("delft/pronav-10"))
    assert pickle.loads(pickle.dumps(scenario)) == scenario


def test_defaults_that_a_preset_leaves_out_can_be_overridden_in_part():
    assert tiswarm.load("delft/avoidance-10", {"predators.spawn.region.0.0": 5}).predators.spawn.region.low == (5, -7.5)
