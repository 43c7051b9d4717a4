"""SIMD: Taichi on a CPU: one runtime, vectors of eight lanes, random numbers by counter, prepared launches."""
