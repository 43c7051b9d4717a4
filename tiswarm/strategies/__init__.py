"""Strategies: behaviours, one file each, found by name, and the terms they share. No array, no loop over agents."""
