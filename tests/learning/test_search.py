"""The search: the usual functions are minimised as the library's papers say, noise and whole numbers included."""

from itertools import pairwise

import numpy as np
import pytest

from tiswarm.learning import halving
from tiswarm.learning.evolution import PairedStrategy
from tiswarm.learning.race import rounds
from tiswarm.learning.search import Search, check_method, suited
from tiswarm.scenario.errors import ScenarioError


def _found(function, start, generations, candidates=16, steps=None, seed=0, method="cma-es"):
    search = Search(np.array(start), candidates, (seed,), np.zeros(len(start)) if steps is None else steps, method)
    for _ in range(generations):
        search.tell(-function(search.ask()))
    return search.centre


@pytest.mark.parametrize("seed", range(3))
def test_sphere(seed):
    optimum = np.array([0.3, 0.7, 0.5, 0.42, 0.61])
    found = _found(lambda x: ((x - optimum) ** 2).sum(axis=1), np.full(5, 0.1), 120, seed=seed)
    np.testing.assert_allclose(found, optimum, atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_rosenbrock(seed):
    def rosenbrock(x):
        y = 4 * x - 2  # the optimum, all ones, is at 0.75 of the unit cube
        return (100 * (y[:, 1:] - y[:, :-1] ** 2) ** 2 + (1 - y[:, :-1]) ** 2).sum(axis=1)

    found = _found(rosenbrock, np.full(4, 0.4), 400, seed=seed)
    np.testing.assert_allclose(found, 0.75, atol=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_noisy_sphere(seed):
    noise = np.random.default_rng(seed)
    optimum = np.array([0.3, 0.7, 0.5])

    def noisy(x):
        return ((x - optimum) ** 2).sum(axis=1) + noise.normal(0, 0.003, len(x))

    found = _found(noisy, np.full(3, 0.1), 150, candidates=32, seed=seed)
    np.testing.assert_allclose(found, optimum, atol=0.04)


def test_whole_numbers_and_real_ones_together():
    steps = np.array([0.1, 0.0])  # eleven whole numbers

    def function(x):
        assert np.allclose(x[:, 0] * 10, np.round(x[:, 0] * 10))
        return (x[:, 0] - 0.7) ** 2 + (x[:, 1] - 0.25) ** 2

    found = _found(function, [0.1, 0.9], 80, steps=steps)
    assert round(found[0] * 10) == 7
    assert found[1] == pytest.approx(0.25, abs=1e-3)


def test_an_optimum_at_an_end_is_found():
    found = _found(lambda x: (x**2).sum(axis=1), [0.5, 0.5], 60)
    np.testing.assert_allclose(found, 0.0, atol=1e-3)


@pytest.mark.parametrize("method", ["cma-es", "openai-es"])
def test_what_is_asked_depends_on_seed_and_scores_alone(method):
    def path(seed):
        search, asked = Search(np.full(3, 0.5), 8, (seed,), np.zeros(3), method), []
        for _ in range(5):
            asked.append(search.ask())
            search.tell(-asked[-1].sum(axis=1))
        return np.stack(asked)

    np.testing.assert_array_equal(path(3), path(3))
    assert not np.array_equal(path(3), path(4))


@pytest.mark.parametrize(("arms", "generations"), [(1, 50), (2, 50), (3, 60), (8, 200), (5, 33)])
def test_a_race_spends_its_generations_and_ends_with_one(arms, generations):
    shares = rounds(arms, generations)
    assert sum(each.runners * each.generations for each in shares) == generations
    assert [each.runners for each in shares][-1] == 1
    assert all(after.runners == -(-before.runners // 2) for before, after in pairwise(shares))


def test_a_race_without_generations_is_refused():
    with pytest.raises(ScenarioError, match="use 32 or more"):
        rounds(8, 31)


@pytest.mark.parametrize("seed", range(3))
def test_pairs_climb_the_sphere_in_many_dimensions(seed):
    optimum = np.random.default_rng(9).normal(0, 1, 200)
    search = PairedStrategy(np.zeros(200), 0.25, np.tile([-np.inf, np.inf], (200, 1)), seed, 64)
    for _ in range(150):
        asked = [search.ask() for _ in range(64)]
        search.tell([(each, float(((each - optimum) ** 2).sum())) for each in asked])
    assert ((search.mean - optimum) ** 2).sum() < 0.05 * (optimum**2).sum()


def test_pairs_lie_opposite_each_other_and_only_ranks_count():
    paths = []
    for scale in (1.0, 1000.0):
        search = PairedStrategy(np.zeros(5), 0.25, np.tile([-np.inf, np.inf], (5, 1)), 3, 8)
        for _ in range(4):
            asked = np.stack([search.ask() for _ in range(8)])
            np.testing.assert_allclose(asked[0::2] + asked[1::2], 2 * np.tile(search.mean, (4, 1)), atol=1e-12)
            search.tell([(each, scale * float((each**3).sum())) for each in asked])
        paths.append(search.mean)
    np.testing.assert_array_equal(*paths)


def test_pairs_stay_inside_bounds():
    found = _found(lambda x: (x**2).sum(axis=1), [0.5, 0.5], 60, method="openai-es")
    assert (found >= 0).all()
    np.testing.assert_allclose(found, 0.0, atol=0.1)


def test_hopeless_candidates_leave_and_whoever_runs_on_meets_the_same_trials():
    truth, asked = np.array([0.1, 0.9, 0.5, 0.7, 0.2, 0.8, 0.3, 0.6]), []

    def outcomes(values, trials):
        asked.append((len(values), trials.tolist()))
        return np.tile(values, (1, len(trials)))[None] + 0.0 * trials

    trials = np.arange(100, 120)
    scores, met = halving.run(outcomes, lambda seen: seen.mean(axis=(0, 2)), truth[:, None], trials, halving.rungs(20))
    assert asked == [(8, trials[:5].tolist()), (4, trials[5:10].tolist()), (2, trials[10:].tolist())]
    assert met.tolist() == [5, 20, 5, 10, 5, 20, 5, 10]
    np.testing.assert_allclose(scores, truth)
    assert met.sum() == halving.cost(8, halving.rungs(20))
    assert np.argsort(-halving.standing(scores, met)).tolist() == [1, 5, 3, 7, 2, 6, 4, 0]


def test_whoever_left_early_is_ranked_behind_by_luck_or_not():
    order = np.argsort(-halving.standing(np.array([0.9, 0.2, 0.9, 0.1]), np.array([5, 20, 5, 20])), kind="stable")
    assert order.tolist() == [1, 3, 0, 2]
    scores = np.array([0.3, 0.1, 0.3])
    assert halving.standing(scores, np.array([7, 7, 7])) is scores


def test_networks_are_searched_in_pairs_unless_candidates_leave():
    assert [suited("prey", False), suited("prey", True), suited("", False)] == ["openai-es", "cma-es", "cma-es"]
    check_method(suited("prey", True), 8, True)


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        (("nes", 8, False), "use 'cma-es'"),
        (("openai-es", 7, False), "7 is odd; use 8"),
        (("openai-es", 8, True), "same trials"),
    ],
)
def test_what_a_method_cannot_do_is_refused(asked, told):
    with pytest.raises(ScenarioError, match=told):
        check_method(*asked)
    with pytest.raises(ScenarioError, match="whole numbers"):
        Search(np.full(2, 0.5), 8, (0,), np.array([0.1, 0.0]), "openai-es")
