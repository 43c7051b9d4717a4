"""Split-evasive: split and evasive together."""

from tiswarm.strategies.prey import Prey


class Strategy(Prey):
    """Lupau 2022, section 6.2."""

    parts = ("split", "evasive")
