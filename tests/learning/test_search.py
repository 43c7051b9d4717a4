"""The search: the usual functions are minimised as the library's papers say, noise and whole numbers included."""

from itertools import pairwise

import numpy as np
import pytest

from tiswarm.learning.race import rounds
from tiswarm.learning.search import Search
from tiswarm.scenario.errors import ScenarioError


def _found(function, start, generations, candidates=16, steps=None, seed=0):
    search = Search(np.array(start), candidates, (seed,), np.zeros(len(start)) if steps is None else steps)
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


def test_what_is_asked_depends_on_seed_and_scores_alone():
    def path(seed):
        search, asked = Search(np.full(3, 0.5), 8, (seed,), np.zeros(3)), []
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
