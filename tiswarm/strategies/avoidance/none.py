"""None: obstacles are not seen."""

from tiswarm.strategies.avoidance import Avoidance


class Strategy(Avoidance):
    """Lupau 2022, section 6.1, the baseline of figures 6 and 7."""

    dimensions = (2, 3)
