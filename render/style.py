"""Style: what a film shows, and how; every choice is checked here, before anything is drawn."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, get_args

from render.language import Language, language_named
from render.theme import Theme, theme_named
from tiswarm.scenario.measures import Shown

if TYPE_CHECKING:
    from render.captions.among import Among  # which builds on what is chosen here

OVERLAYS = ("perception", "velocity", "links", "density", "coverage", "pursuit")
"""Perception circles, velocity lines, lines between neighbours, a heat map of agents, cleaned ground, whom predators chase."""


CHARTS = ("alive", *get_args(Shown))
"""Who lives, and what captions may tell."""


@dataclass(frozen=True)
class Use:
    """What a film is for: its frame [px], its theme, and how long it lasts at most [s], whatever its trial's length."""

    size: tuple[int, int]
    theme: str
    seconds: float


USES = {
    "slide": Use((1920, 1080), "dark", 40.0),
    "square": Use((1080, 1080), "dark", 30.0),
    "phone": Use((1080, 1920), "dark", 20.0),
    "paper": Use((1800, 1200), "print", 20.0),
}
"""Name -> frame, theme and length that suit a use."""

Corners = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class Look:
    """How a recording is shown.

    theme: "dark", "light", "print", or a Theme.
    speed: ticks per second of film.
    trail: how long trails last [s of film]; 0 draws none.
    camera: "fit" (the world and all that moves; it goes with prey that leave an open world for good), "follow" (the prey's
        centre), "follow:3" (agent 3, prey first), "orbit" (around the world; what 3-D recordings have for "fit"), or a box
        ((x0, y0), (x1, y1)) [m].
    overlay: any of OVERLAYS.
    label: numbers of agents, prey first, that are written beside them.
    slow: slow motion around captures.
    cards: begin with a card of what is shown and what marks mean, and end with one of how it ended.
    loop: let the end run into the beginning, for films that are shown again and again; such a film has no cards.
    story: tell what happens in a line at the stage's foot, and slow down around captures; for one recording.
    chart: what to chart beside or below the picture of one recording, any of CHARTS; None for what its preset is about, where
        space is left; () for nothing.
    among: outcomes of other trials (render.Among), drawn with the charts, for one recording.
    language: what captions are written in: "en", "de" or "ar" (render/languages/).
    transparent: leave out the ground, that is backdrop, floor, grid, sky and shadows, so that the picture can be laid over
        another one: .webm, .webp and PNG keep opacity. Such a film has no cards, for they would hide what it is laid over.

    Errors: ValueError for a choice that is not possible.
    """

    theme: Theme | str = "dark"
    speed: float = 10.0
    trail: float = 2.5
    camera: str | Corners = "fit"
    overlay: tuple[str, ...] = ()
    label: tuple[int, ...] = ()
    slow: bool = False
    story: bool = False
    cards: bool = False
    loop: bool = False
    chart: tuple[str, ...] | None = None
    among: "Among | None" = None
    language: str = "en"
    transparent: bool = False

    def __post_init__(self) -> None:
        theme_named(self.theme)
        language_named(self.language)
        if not 0 < self.speed < 1e6:
            raise ValueError(f"speed: {self.speed} is not possible; use ticks per second above 0")
        if not 0 <= self.trail < 1e6:
            raise ValueError(f"trail: {self.trail} is not possible; use seconds, 0 or more")
        for name in self.overlay:
            if name not in OVERLAYS:
                raise ValueError(f"overlay: unknown {name!r}; use any of {', '.join(OVERLAYS)}")
        if any(number < 0 for number in self.label):
            raise ValueError(f"label: {self.label} is not possible; use agents' numbers, from 0 on, prey first")
        if self.loop and self.cards:
            raise ValueError("loop: a loop has no beginning for a card; leave out the cards")
        if self.transparent and self.cards:
            raise ValueError("transparent: a card would hide what the film is laid over; leave out the cards")
        for name in self.chart or ():
            if name not in CHARTS:
                raise ValueError(f"chart: unknown {name!r}; use any of {', '.join(CHARTS)}")
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
    def slowed(self) -> bool:
        """Tell whether there is slow motion."""
        return self.slow or self.story

    @property
    def followed(self) -> int | None:
        """Number the one agent that the camera follows, if it does."""
        agent = self.camera.partition(":")[2] if isinstance(self.camera, str) else ""
        return int(agent) if agent else None

    @property
    def colours(self) -> Theme:
        """Give the theme itself; without its ground for transparent pictures."""
        theme = theme_named(self.theme)
        return theme.without_ground() if self.transparent else theme

    @property
    def wording(self) -> Language:
        """Give what captions are worded by."""
        return language_named(self.language)


def look_of(choices: dict[str, Any]) -> Look:
    """Build a look from keyword arguments; a misspelt one is a TypeError that lists what there is."""
    known = Look.__dataclass_fields__
    for name in choices:
        if name not in known:
            raise TypeError(f"unknown choice {name!r}; a look has {', '.join(known)}")
    return Look(**choices)
