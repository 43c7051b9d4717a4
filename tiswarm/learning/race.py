"""Race: how generations are shared out among combinations of choices, of which the worse half leaves after each round."""

import math
from dataclasses import dataclass

from tiswarm.scenario.errors import ScenarioError


@dataclass(frozen=True)
class Round:
    """runners: how many arms run; generations: of each of them."""

    runners: int
    generations: int


def rounds(arms: int, generations: int) -> list[Round]:
    """Share generations out by successive halving (Karnin, Koren, Somekh 2013): each round as much, the last takes the rest.

    Errors: ScenarioError when there are too few.
    """
    runners = [arms]
    while runners[-1] > 1:
        runners.append(math.ceil(runners[-1] / 2))
    each = generations // len(runners)
    if each < runners[0]:
        least = runners[0] * len(runners)
        raise ScenarioError(f"budget: {generations} generations for {arms} choices; use {least} or more, or fewer choices")
    found = [Round(count, each // count) for count in runners]
    left = generations - sum(one.runners * one.generations for one in found)
    return [*found[:-1], Round(1, found[-1].generations + left)] if runners[-1] == 1 else found
