"""Style: what a film shows, and how; every choice is checked here, before anything is drawn."""

from dataclasses import dataclass
from typing import Any

from render.theme import Theme, theme_named

OVERLAYS = ("perception", "velocity", "links", "density", "coverage")
"""Perception circles, velocity lines, lines between neighbours, a heat map of agents, cleaned ground."""

Corners = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class Look:
    """How a recording is shown.

    theme: "dark", "light", "print", or a Theme.
    speed: ticks per second of film.
    trail: how long trails last [s of film]; 0 draws none.
    camera: "fit" (the world and all that moves), "follow" (the prey's centre), "follow:3" (agent 3, prey first),
        "orbit" (around the world; what 3-D recordings have for "fit"), or a box ((x0, y0), (x1, y1)) [m].
    overlay: any of OVERLAYS.
    slow: slow motion around captures.

    Errors: ValueError for a choice that is not possible.
    """

    theme: Theme | str = "dark"
    speed: float = 10.0
    trail: float = 2.5
    camera: str | Corners = "fit"
    overlay: tuple[str, ...] = ()
    slow: bool = False

    def __post_init__(self) -> None:
        theme_named(self.theme)
        if not 0 < self.speed < 1e6:
            raise ValueError(f"speed: {self.speed} is not possible; use ticks per second above 0")
        if not 0 <= self.trail < 1e6:
            raise ValueError(f"trail: {self.trail} is not possible; use seconds, 0 or more")
        for name in self.overlay:
            if name not in OVERLAYS:
                raise ValueError(f"overlay: unknown {name!r}; use any of {', '.join(OVERLAYS)}")
        if isinstance(self.camera, str):
            kind, _, agent = self.camera.partition(":")
            if kind not in ("fit", "follow", "orbit") or (agent and not (kind == "follow" and agent.isdigit())):
                raise ValueError(
                    f"camera: unknown {self.camera!r}; use fit, follow, follow:AGENT, orbit or a box ((x0, y0), (x1, y1))"
                )
        else:
            (x0, y0), (x1, y1) = self.camera
            if not (x0 < x1 and y0 < y1):
                raise ValueError(f"camera: the box {self.camera} must run from its lower to its upper corner")

    @property
    def colours(self) -> Theme:
        """Give the theme itself."""
        return theme_named(self.theme)


def look_of(choices: dict[str, Any]) -> Look:
    """Build a look from keyword arguments; a misspelt one is a TypeError that lists what there is."""
    known = Look.__dataclass_fields__
    for name in choices:
        if name not in known:
            raise TypeError(f"unknown choice {name!r}; a look has {', '.join(known)}")
    return Look(**choices)
