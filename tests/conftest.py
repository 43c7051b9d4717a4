"""Fixtures: the precision that a test runs in. Starting Taichi anew drops its kernels, so switches are few."""

import pytest

import tiswarm


@pytest.fixture
def f32():
    tiswarm.init("f32")


@pytest.fixture
def f64():
    tiswarm.init("f64")


@pytest.fixture(params=["f32", "f64"], scope="module")
def precision(request):
    tiswarm.init(request.param)
    return request.param
