"""The box: places come back, ways are the shortest, and lanes do what NumPy does."""

import numpy as np
import pytest
import taichi as ti

from tiswarm.simd import runtime
from tiswarm.space import box, box_lanes

pytestmark = pytest.mark.quick

SIZE = (10.0, 4.0, 7.0)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_way_is_the_shortest_of_its_images(dim):
    way = np.random.default_rng(1).uniform(-40, 40, (500, dim))
    size = np.array(SIZE[:dim])
    short = box.displacement(way, box.period(size, "periodic"))
    turns = (way - short) / size
    assert np.allclose(turns, turns.round(), atol=1e-12)
    assert (np.abs(short) <= size / 2 + 1e-12).all()
    assert (box.displacement(way, box.period(size, "open")) == way).all()


def test_places_come_back_and_never_lie_on_the_far_edge():
    for dtype in (np.float32, np.float64):
        size = np.array(SIZE[:2], dtype)
        edges = np.array([[-1e-30, 4.0], [10.0, -4.0]])
        place = np.concatenate([np.random.default_rng(2).uniform(-40, 40, (500, 2)), edges]).astype(dtype)
        back = box.wrap(place, size)
        assert back.dtype == dtype
        assert ((back >= 0) & (back < size)).all()
        assert np.allclose(box.displacement(back - place, size), 0, atol=1e-5)
        assert (box.wrap(back, size) == back).all()
        assert (box.wrap(place, np.zeros_like(size)) == place).all()


@pytest.mark.parametrize("boundary", ["open", "periodic", "walls"])
def test_lanes_confine_as_numpy_does(boundary, f64):
    rng = np.random.default_rng(3)
    place, rate = rng.uniform(-30, 30, (2, 200))
    out = np.zeros((4, 200))

    @ti.kernel
    def run(place: ti.types.ndarray(), rate: ti.types.ndarray(), out: ti.types.ndarray()):
        for i in range(200):
            to = [place[i]]
            going = [rate[i]]
            size = [ti.cast(SIZE[0], ti.f64)]
            box_lanes.confine(boundary, to, going, size, 0.5)
            out[0, i] = to[0]
            out[1, i] = going[0]
            out[2, i] = box_lanes.displacement(place[i], size[0])
            out[3, i] = box_lanes.adjacent(place[i], size[0])

    runtime.start()
    run(place, rate, out)
    period = np.array(SIZE[0])
    expected = {"open": place, "periodic": box.wrap(place, period), "walls": np.clip(place, 0.5, SIZE[0] - 0.5)}[boundary]
    assert (out[0] == expected).all()
    assert (out[2] == box.displacement(place, period)).all()
    once = np.abs(place) < SIZE[0]
    assert np.allclose(out[3, once], out[2, once], atol=1e-12)
    assert (np.abs(out[3]) >= np.abs(place) - SIZE[0]).all()  # who is far away is brought near by `displacement` only
    stopped = (place < expected) & (rate < 0) | (place > expected) & (rate > 0) if boundary == "walls" else np.zeros(200, bool)
    assert (out[1] == np.where(stopped, 0, rate)).all()
    assert box.inside(expected[:, None], SIZE[:1]).all() == box.bounded(boundary)
