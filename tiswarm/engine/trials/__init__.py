"""Trials: many small trials, one in each lane of a thread, all pairs."""
