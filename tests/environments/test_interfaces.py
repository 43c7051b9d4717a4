"""Interfaces: what PettingZoo and Gymnasium check of environments, frames, and what is said where they are missing."""

import sys

import numpy as np
import pytest

import tiswarm

gymnasium = pytest.importorskip("gymnasium", reason="needs the extra rl")
pytest.importorskip("pettingzoo", reason="needs the extra rl")

SMALL = {"world.ticks": 30}


def _scenario():
    return tiswarm.load("delft/pronav-10", SMALL)


@pytest.mark.filterwarnings("ignore")
def test_pettingzoo_accepts_it():
    from pettingzoo.test import parallel_api_test, parallel_seed_test

    parallel_api_test(tiswarm.parallel_env(_scenario(), control="both"), num_cycles=70)
    parallel_seed_test(lambda: tiswarm.parallel_env(_scenario(), control="both"))


@pytest.mark.filterwarnings("ignore")
def test_gymnasium_accepts_it():
    from gymnasium.utils.env_checker import check_env

    check_env(tiswarm.gym_env(_scenario(), control="predators"), skip_render_check=True)


def test_trials_of_a_vector_are_those_of_the_environment():
    vector = tiswarm.vector_env(_scenario(), 4, opponent=lambda shown: np.zeros((*shown.shape[:2], 2)))
    plain = tiswarm.env(_scenario(), 4, control="both")
    shown, _ = vector.reset(seed=3)
    np.testing.assert_array_equal(shown, plain.reset(seed=3)[:, :6])
    assert vector.observation_space.contains(shown)
    vector.action_space.seed(0)
    ended = 0
    for _ in range(65):
        actions = vector.action_space.sample()
        told = np.zeros((4, 21, 2))
        told[:, :6] = actions
        shown, rewards, terminated, truncated, info = vector.step(actions)
        other, paid, *ends = plain.step(told)
        np.testing.assert_array_equal(shown, other[:, :6])
        np.testing.assert_allclose(rewards, paid[:, :6].sum(axis=1))
        np.testing.assert_array_equal([terminated, truncated], ends)
        if info:
            assert info["final_obs"].shape == shown.shape
            ended += info["_final_obs"].sum()
    assert ended >= 4


def test_a_frame_is_one_of_our_films():
    single = tiswarm.gym_env(_scenario(), control="predators", render_mode="rgb_array")
    single.reset(seed=0)
    first = single.render()
    for _ in range(5):
        single.step(np.zeros(single.action_space.shape))
    frame = single.render()
    assert frame.shape == first.shape == (360, 640, 3)
    assert frame.dtype == np.uint8
    assert frame.std() > 1
    assert not np.array_equal(first, frame)


@pytest.mark.quick
def test_a_missing_library_is_named(monkeypatch):
    for name in ("gymnasium", "pettingzoo"):
        monkeypatch.setitem(sys.modules, name, None)
    for make in (tiswarm.parallel_env, tiswarm.gym_env, tiswarm.vector_env):
        with pytest.raises(ImportError, match=r"pip install 'tiswarm\[rl\]'"):
            make("delft/pronav-10")
