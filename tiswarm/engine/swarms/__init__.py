"""Swarms: few large trials, agents in the lanes, cell lists."""
