"""Engine: the loops, and which of them runs a scenario."""
