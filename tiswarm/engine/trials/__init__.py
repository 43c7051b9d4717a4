"""Trials: many small trials, eight of them in the lanes of a thread, all pairs."""
