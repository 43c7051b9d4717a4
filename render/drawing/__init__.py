"""Drawing: a moment as vectors: shapes as paths, words as text."""
