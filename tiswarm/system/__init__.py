"""System: what the process does for everybody: whole files, progress, Ctrl-C, words."""
