"""SIMD: Taichi on a CPU: one runtime, vectors of eight or sixteen lanes, random numbers by counter, prepared launches."""
