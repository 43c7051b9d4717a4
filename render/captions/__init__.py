"""Captions: words beside the action."""
