"""Kitchen sink: directed spiral and steer away together."""

from tiswarm.strategies.avoidance import Avoidance


class Strategy(Avoidance):
    """Lupau 2022, section 6.1, the avoidance of figures 8 to 11."""

    parts = ("directed-spiral", "steer-away")
