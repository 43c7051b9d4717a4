"""Scene: what is seen at a time."""
