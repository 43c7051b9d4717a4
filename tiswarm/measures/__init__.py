"""Measures: what is measured, in the kernel while trials run, and of a recording in NumPy."""
