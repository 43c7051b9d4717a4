"""Dynamics: one agent, one tick: sees, steers, moves, touches. Each rule once, for both engines."""
