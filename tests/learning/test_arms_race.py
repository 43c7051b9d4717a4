"""The arms race: answers that gain are taken in, what is on disk is gone on with, and wrong rules are refused."""

import json
from itertools import pairwise

import numpy as np
import pytest

import tiswarm
from tiswarm.learning.arms_race import Race
from tiswarm.learning.race_rules import rules_of
from tiswarm.studies import zero_sum

RULES = """
title = "Small"
base = "delft/pronav-10"
trials = 300
rounds = 2
budget = 1280
candidates = 8
search_trials = 20
checks = 100
[prey]
policies = [{ "prey.strategy" = "evasive", "prey.avoidance" = "kitchen-sink" }]
[prey.over]
"prey.goal" = [0.01, 1.0, "log"]
[predators]
policies = [
    { "predators.strategy" = "centre", "predators.goal" = 0.0 },
    { "predators.strategy" = "centre", "predators.goal" = 0.001 },
]
[predators.over]
"predators.goal" = [0.0001, 1.0, "log"]
"""


@pytest.fixture(scope="module")
def rules(tmp_path_factory):
    file = tmp_path_factory.mktemp("rules") / "r.toml"
    file.write_text(RULES)
    return rules_of(str(file))


def run_whole(rules, tmp_path_factory):
    """Run a race that tests may look at and not change: its folder and rounds."""
    tiswarm.init("f32")
    folder = tmp_path_factory.mktemp("race") / "whole"
    return folder, Race(rules, folder).run()


@pytest.fixture(scope="module")
def whole(rules, tmp_path_factory):
    return run_whole(rules, tmp_path_factory)


def test_predators_that_do_not_hunt_learn_to(whole):
    _, rounds = whole
    first = rounds[0]
    hunting = next(each for each in first.answers if each.side == "predators")
    assert hunting.accepted
    assert hunting.policy.changes["predators.goal"] > 0.001
    assert len(rounds[1].predators) == 3
    assert zero_sum.solve(rounds[1].payoff[:1]).value < first.solution.value  # had the prey learned nothing meanwhile
    assert first.exploitability > 0


def test_the_matrix_is_what_trials_give_and_gains_are_told_on_it(rules, whole, f32):
    _, rounds = whole
    base = tiswarm.load(rules.base)
    last = rounds[-1]
    for i, prey in enumerate(last.prey):
        for j, predators in enumerate(last.predators):
            alone = tiswarm.simulate(base.replaced({**prey.changes, **predators.changes}), 300, 0)
            assert last.payoff[i, j] == alone.success.mean()
    for before, after in pairwise(rounds):
        for answer in before.answers:
            if answer.accepted and answer.side == "predators":
                column = [each.name for each in after.predators].index(answer.policy.name)
                met = before.solution.rows @ after.payoff[: len(before.prey), column]
                assert answer.gain.mean == pytest.approx(before.solution.value - met, abs=1e-9)


def cut_short(rules, folder):
    """Begin a race, and press Ctrl-C after its first round."""

    def stop(_round):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Race(rules, folder).run(finished=stop)


def test_a_race_that_was_cut_short_goes_on_to_the_same_end(rules, whole, tmp_path, f32):
    cut = tmp_path / "cut"
    cut_short(rules, cut)
    Race(rules, cut).run()
    assert (cut / "race.json").read_bytes() == (whole[0] / "race.json").read_bytes()
    with pytest.raises(ValueError, match="holds another race: seed 0, not 3"):
        Race(rules, cut, seed=3).run()


LED = """[predators.network]
begin = { "predators.strategy" = "neural", "predators.weights.network" = "networks/thesis-gains.npz" }
budget = 2560
candidates = 8
search_trials = 20
"""


@pytest.fixture(scope="module")
def led(tmp_path_factory):
    """Rules by which predators find no better numbers, so that a network is trained."""
    text = RULES.replace('"predators.goal" = 0.001', '"predators.goal" = 0.1').replace(
        '[0.0001, 1.0, "log"]', "[0.0001, 0.0002]"
    )
    file = tmp_path_factory.mktemp("rules") / "led.toml"
    file.write_text(text + LED)
    return rules_of(str(file))


@pytest.fixture(scope="module")
def whole_led(led, tmp_path_factory):
    return run_whole(led, tmp_path_factory)


def test_where_numbers_gain_nothing_a_network_is_trained(led, whole_led, f32):
    folder, rounds = whole_led
    numbers, network = (each for each in rounds[0].answers if each.side == "predators")
    assert not numbers.accepted
    assert (network.policy.changes["predators.strategy"], network.start) == ("neural", "neural")
    assert rounds[0].best("predators") is max((numbers, network), key=lambda each: each.gain.mean)
    trained = "round-0/predators-network/network.npz"
    assert network.moved == {"predators.weights.network": ("networks/thesis-gains.npz", trained)}
    assert (folder / trained).is_file()
    race = Race(led, folder)
    against = [race.scenario(prey, network.policy) for prey in rounds[0].prey]
    assert against[0].network("predators").digest != tiswarm.load("delft/neural").network("prey").digest
    won = rounds[0].solution.rows @ [tiswarm.simulate(each, 300, 0).success.mean() for each in against]
    assert network.gain.mean == pytest.approx(rounds[0].solution.value - won, abs=1e-9)


def test_where_numbers_gain_little_a_network_is_trained_too_and_the_better_one_joins(tmp_path, f32):
    (tmp_path / "led.toml").write_text(RULES + LED + "under = 1.0\n")
    rounds = Race(rules_of(str(tmp_path / "led.toml")), tmp_path / "whole").run()
    numbers, network = (each for each in rounds[0].answers if each.side == "predators")
    assert numbers.accepted
    best = max((numbers, network), key=lambda each: each.gain.mean)
    assert rounds[1].predators == (*rounds[0].predators, best.policy)


def test_a_race_with_networks_goes_on_to_the_same_end_in_another_folder(led, whole_led, tmp_path, f32):
    cut_short(led, tmp_path / "cut")
    (tmp_path / "cut").rename(tmp_path / "moved")
    Race(led, tmp_path / "moved").run()
    assert (tmp_path / "moved" / "race.json").read_bytes() == (whole_led[0] / "race.json").read_bytes()


def test_the_command_prints_rounds_and_writes_them(tmp_path, command, small_films, f32):
    (tmp_path / "r.toml").write_text(RULES.replace("rounds = 2", "rounds = 1"))
    run = command("bench", "r.toml", "-o", "out", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert "predators gain" in run.stdout
    assert (tmp_path / "out" / "payoff.png").is_file()
    assert (tmp_path / "out" / "film.mp4").is_file()
    told = json.loads((tmp_path / "out" / "race.json").read_text())
    assert {"value", "payoff", "answers", "prey", "predators"} <= told[0].keys()
    refused = command("bench", "r.toml", "-o", "out", "--set", "prey.goal=1", cwd=tmp_path)
    assert refused.returncode == 2
    assert "drop --set" in refused.stderr


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("rounds = 2", "rounds = 0", "rounds"),
        ("candidates = 8", "candidates = 2", "candidates"),
        ('"prey.goal" = [0.01, 1.0, "log"]', '"prey.goal" = 3', "prey.over"),
        ('title = "Small"', 'title = "Small"\nround = 3', "round"),
        ("[prey.over]", "[prey.network]\nunder = 2\nbegin = {}\n[prey.over]", "prey.network.under"),
        ("[prey.over]", '[prey.network]\nbegin = { "prey.strategy" = "neural" }\n[prey.over]', "add 'prey.weights.network'"),
    ],
)
def test_wrong_rules_are_refused_in_one_line(old, new, told, tmp_path):
    (tmp_path / "r.toml").write_text(RULES.replace(old, new))
    with pytest.raises(tiswarm.ScenarioError) as error:
        rules_of(str(tmp_path / "r.toml"))
    assert told in str(error.value)
    assert "\n" not in str(error.value)


def test_the_shipped_race_is_one_and_the_thesis_s_game_is_none(f32):
    rules = rules_of("delft-race")
    assert rules is not None
    assert rules_of("delft-game") is None
    for side in ("prey", "predators"):
        for changes in getattr(rules, side).policies:
            known = tiswarm.load(rules.base, changes).numbers()
            assert set(getattr(rules, side).over) <= known.keys()


@pytest.mark.parametrize("seed", range(5))
def test_the_solver_s_mixtures_cannot_be_exploited(seed):
    payoff = np.random.default_rng(seed).normal(size=(4, 6))
    found = zero_sum.solve(payoff)
    assert (payoff @ found.columns).max() - (found.rows @ payoff).min() == pytest.approx(0.0, abs=1e-9)
