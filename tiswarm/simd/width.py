"""Width: how many trials (or agents) one thread carries in lock-step, which is the machine's matter: no bit depends on it."""

from tiswarm.system.machine import processor, vector_bits

WIDE, USUAL = 16, 8


def lanes() -> int:
    """Give 16 where kernels are compiled to vectors of 512 bits, each of which holds 16 reals of f32, else 8.

    Those are Intel's with AVX-512. LLVM 15, which Taichi 1.7.4 has, takes AMD's with AVX-512 for older ones and writes AVX2
    for them: 16 lanes are pairs of vectors there, of which half of the registers are too few, and slower than 8.
    """
    return WIDE if vector_bits() == 512 and "Intel" in processor() else USUAL
