"""Shown: the names of what agents that obey are shown, and where its numbers stand."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from tiswarm.system.words import did_you_mean

DEFAULT = ("own", "target", "nearest-prey:3", "nearest-predators:3", "nearest-obstacles:2", "means")

MOST_NEAREST = 8
"""Most agents or obstacles of a kind that are shown one by one: a kernel has a place for each."""

NEAREST = ("nearest-prey", "nearest-predators", "nearest-obstacles")


@dataclass(frozen=True)
class Shown:
    """What is shown, in the order in which it was asked for: (name, how many, first number); width: numbers in all."""

    parts: tuple[tuple[str, int, int], ...]
    width: int

    @classmethod
    def of(cls, names: Sequence[str], dim: int) -> "Shown":
        """Read names such as "own" and "nearest-prey:3". Errors: ValueError."""
        sizes = {"own": 2 * dim, "target": dim, "means": 4 * dim + 2}
        sizes |= {"nearest-prey": 2 * dim + 1, "nearest-predators": 2 * dim + 1, "nearest-obstacles": dim + 2}
        parts: list[tuple[str, int, int]] = []
        first = 0
        for asked in names:
            found = re.fullmatch(r"([a-z-]+)(?::(\d+))?", asked)
            name, count = (found[1], int(found[2] or 1)) if found else (asked, 1)
            if name not in sizes:
                raise ValueError(f"observe: {asked!r} is unknown; {did_you_mean(name, list(sizes))}")
            if not 1 <= count <= MOST_NEAREST or (found and found[2] and name not in NEAREST):
                raise ValueError(
                    f"observe: {asked!r} is not possible; use {name}" + f":1 to :{MOST_NEAREST}" * (name in NEAREST)
                )
            if name in (each for each, *_ in parts):
                raise ValueError(f"observe: {name} stands there twice; name it once")
            parts.append((name, count, first))
            first += count * sizes[name]
        if not parts:
            raise ValueError("observe: nothing is shown; name something, such as 'own'")
        return cls(tuple(parts), first)

    def place(self, name: str) -> tuple[int, int]:
        """Give the first number of what a name shows, and how many agents it shows; (-1, 0) where it was not asked for."""
        return next(((first, count) for each, count, first in self.parts if each == name), (-1, 0))
