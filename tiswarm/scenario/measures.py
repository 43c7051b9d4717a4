"""Measures: the names of all that a run counts and measures, what they need, and what they are in words."""

from typing import Literal, get_args

COUNTED = ("success", "time", "impact_spread", "arrived", "captured", "crashed", "alive", "ticks")
"""What every trial tells of its end."""

Measure = Literal[
    "polarisation", "milling", "nearest", "groups", "speed", "kinetic", "potential", "hits", "coverage", "visit-variation",
    "time-to-50", "time-to-90", "time-to-95", "time-to-99", "trapped", "trapped-time", "trapped-milling",
    "settling-time", "overshoot",
    "least-distance", "stalled", "corrected",
]  # fmt: skip
"""What is measured on request (`measures.names`); measures/recorded.py and measures/deadlocks.py define each."""

PEAKS = ("settling-time", "overshoot")
"""Measures against the greatest that there was so far."""

SETTLED = 0.05
"""Who moves no faster than this share of the greatest mean speed has settled: the five per cent of control engineering."""

MEASURED: tuple[str, ...] = get_args(Measure)

Shown = Literal["nearest", "polarisation", "milling", "speed", "groups", "kinetic", "potential"]
"""What a film's caption may say of every moment (`film.measures`)."""

COVERED = {"time-to-50": 0.50, "time-to-90": 0.90, "time-to-95": 0.95, "time-to-99": 0.99}
"""Measures of when so large a share of the ground was swept."""

SWEPT = ("coverage", "visit-variation", *COVERED)
"""Measures of the coverage grid."""

TRAPS = ("trapped", "trapped-time", "trapped-milling")
"""Measures of who moves without getting anywhere."""

STILL = 0.01
"""Who is slower than this, in speed limits, stands still (measure "stalled")."""

CHANGED = 1e-6
"""A command is corrected if it is changed by more than this, in speed limits (measure "corrected")."""
