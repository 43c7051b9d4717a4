"""Plots: matplotlib, for papers."""
