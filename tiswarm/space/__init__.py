"""Space: the box and its edges, and who is near whom. Knows no agent's rules."""
