"""Raster: shapes in, bytes out."""
