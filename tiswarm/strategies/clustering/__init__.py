"""Clustering: K-means and its knee in lanes."""
