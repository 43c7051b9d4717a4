"""Swarms: few large trials, eight agents in the lanes, cell lists."""
