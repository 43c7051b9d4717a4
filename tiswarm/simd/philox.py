"""Random numbers by counter: Philox 4x32-10, so that any number of any trial can be drawn at any time in any order."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.simd.runtime import LANES, Func, Types

# Streams are keyed by purpose: two strategies under the same seed meet the same obstacles and starts.
PREY, PREDATORS, OBSTACLES, STRATEGY, DEFLECTION, PREDATOR_DEFLECTION, CLUSTERS, CENTRES = 1, 2, 3, 4, 5, 6, 7, 8
PREDATOR_STRATEGY = 9

_ROUNDS = 10


@ti.func
def _high_product(a, multiplier: ti.template()):
    return ti.cast((ti.cast(a, ti.u64) * ti.u64(multiplier)) >> ti.u64(32), ti.u32)


@ti.func
def philox(a, b, c, d, key_low, key_high):
    """Scramble a counter of four 32-bit words under a key of two.

    Source: Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11; Random123 has the test vectors.
    """
    for _ in range(_ROUNDS):
        high_a = _high_product(a, 0xD2511F53)
        low_a = a * ti.u32(0xD2511F53)
        high_c = _high_product(c, 0xCD9E8D57)
        low_c = c * ti.u32(0xCD9E8D57)
        a = high_c ^ b ^ key_low
        b = low_c
        c = high_a ^ d ^ key_high
        d = low_a
        key_low = key_low + ti.u32(0x9E3779B9)
        key_high = key_high + ti.u32(0xBB67AE85)
    return a, b, c, d


def seed_words(seed: int) -> tuple[int, int]:
    """Split a seed of 64 bits into the two words of a Philox key. Errors: ValueError for a seed outside 0..2⁶⁴-1."""
    if not 0 <= seed < 1 << 64:
        raise ValueError(f"seed: {seed} is not possible; use 0 to 2⁶⁴ - 1")
    return seed & 0xFFFFFFFF, seed >> 32


@dataclass(frozen=True)
class Draws:
    """Random numbers in lanes."""

    uniform: Func  # draw four numbers in [0, 1) a lane. trial, index, tick: integer lanes


def build(types: Types) -> Draws:
    """Build `uniform` for the running precision."""
    real, lanes, integers = types.real, types.lanes, types.integer_lanes

    @ti.func
    def fraction(word):
        # 24 bits, exact in both precisions: f32 and f64 runs start from the same state. No vector cast: LLVM lacks it here.
        return lanes(
            [ti.cast(word[lane] >> ti.u32(8), real) * ti.cast(1.0 / 16777216.0, real) for lane in ti.static(range(LANES))]
        )

    @ti.func
    def uniform(key_low, key_high, trial, purpose: ti.template(), index, tick):
        """Draw four numbers in [0, 1) a lane. trial, index, tick: integer lanes."""
        a, b, c, d = philox(index, trial, integers(ti.u32(purpose)), tick, key_low, key_high)
        return fraction(a), fraction(b), fraction(c), fraction(d)

    return Draws(uniform=uniform)
