"""cluster: the trials of a study in slices, run by workers on many machines, to the same bits."""
