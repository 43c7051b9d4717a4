"""Clock: where the numbers stand that change from tick to tick, in the array that kernels of large swarms get them in."""

AGE, FIRST, KEY_LOW, KEY_HIGH, MOVED, CLOCK = range(6)
"""Ticks run, the number of the first trial, the two words of the seed, whether anybody has moved; and how many these are."""
