"""Studies: many scenarios in one design: axes, cells kept on disk, statistics, tables."""
