"""Command line: one file a verb, and the only package that knows both tiswarm and render. Heavy imports wait for a verb."""

from tiswarm.cli.entry import main

__all__ = ["main"]
