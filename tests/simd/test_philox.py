"""Philox against the published vectors, and what streams must be."""

import numpy as np
import pytest
import taichi as ti

from tiswarm.simd import philox, runtime

pytestmark = pytest.mark.quick

# Random123's kat_vectors, philox 4x32 with 10 rounds: counter, key, result.
KNOWN_ANSWERS = [
    ((0, 0, 0, 0), (0, 0), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
    ((0xFFFFFFFF,) * 4, (0xFFFFFFFF,) * 2, (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD)),
    (
        (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
        (0xA4093822, 0x299F31D0),
        (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
    ),
]


@pytest.mark.parametrize(("counter", "key", "expected"), KNOWN_ANSWERS)
def test_philox_gives_the_published_answers_in_every_lane(counter, key, expected):
    words = ti.types.ndarray(dtype=runtime.types().integer_lanes, ndim=1)

    @ti.kernel
    def scramble(w: words, low: ti.u32, high: ti.u32):
        for _ in range(1):
            a, b, c, d = philox.philox(w[0], w[1], w[2], w[3], low, high)
            w[0] = a
            w[1] = b
            w[2] = c
            w[3] = d

    lanes = runtime.aligned((4, runtime.LANES), np.uint32)
    lanes[:] = np.array(counter, np.uint32)[:, None]
    scramble(lanes, *key)
    np.testing.assert_array_equal(lanes, np.array(expected, np.uint32)[:, None].repeat(runtime.LANES, axis=1))


def _draw(seed, purpose, ticks=64):
    types = runtime.types()
    uniform = philox.build(types).uniform
    lanes, integers = types.lane_array(2), ti.types.ndarray(dtype=types.integer_lanes, ndim=1)

    @ti.kernel
    def draw(out: lanes, numbers: integers, low: ti.u32, high: ti.u32, count: ti.i32):
        for _ in range(1):
            for index in range(count):
                a, b, c, d = uniform(low, high, numbers[0], purpose, types.integer_lanes(ti.cast(index, ti.u32)), numbers[1])
                out[index, 0] = a
                out[index, 1] = b
                out[index, 2] = c
                out[index, 3] = d

    out = runtime.aligned((ticks, 4, runtime.LANES), types.dtype)
    numbers = runtime.aligned((2, runtime.LANES), np.uint32)
    numbers[0] = np.arange(runtime.LANES)
    draw(out, numbers, *philox.seed_words(seed), ticks)
    return out


def test_numbers_are_uniform_and_below_one():
    drawn = _draw(5, philox.PREY, 4000)
    assert drawn.min() >= 0
    assert drawn.max() < 1
    counts, _ = np.histogram(drawn, bins=64, range=(0, 1))
    expected = drawn.size / 64
    assert ((counts - expected) ** 2 / expected).sum() < 63 + 4 * np.sqrt(2 * 63)


def test_streams_differ_by_seed_purpose_and_trial():
    first = _draw(5, philox.PREY)
    assert not np.array_equal(first, _draw(6, philox.PREY))
    assert not np.array_equal(first, _draw(5 + (1 << 32), philox.PREY))
    assert not np.array_equal(first, _draw(5, philox.OBSTACLES))
    assert len(np.unique(first)) > 0.99 * first.size


@pytest.mark.parametrize("seed", [-1, 1 << 64])
def test_a_seed_outside_64_bits_is_refused(seed):
    with pytest.raises(ValueError, match="seed"):
        philox.seed_words(seed)
