"""The command line: the only package that knows both tiswarm and render. Heavy imports wait until a verb needs them."""

from tiswarm.cli.entry import main

__all__ = ["main"]
