"""Learning: numbers of a scenario found by search, and held against trials that no search saw."""
